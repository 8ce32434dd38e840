"""Count what makes a tree of sources hard to read and to change.

    python tools/structure.py [SRC] [--list]

One line for each measure; with --list the places follow it. None tests are those on what may be absent in a system:
motions, joints, links and mesh. Parameters are counted without self and cls, the lines of a function without its
docstring; compiled kernels take arrays, and are counted apart. Sentences without a subject are those that the rule of
tests/support/prose.py finds. Rooms are folders, `core` as a whole and each of its own.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "support"))

from prose import docstrings, has_subject, names, subjectless_sentences  # noqa: E402

MANY, LONG = 6, 50
"""Parameters from which on a function has many; lines beyond which it is long."""

NONE_TEST = re.compile(r"(motions?|kinematics|free|links?|linkage|joints|mechanisms?|mesh)\w* is (not )?None")
NEEDS_MESH = re.compile(r"\bneeds_mesh\b")

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Module:
    """A source file; ``name`` is its path within the tree."""

    path: Path
    name: Path

    @cached_property
    def text(self) -> str:
        return self.path.read_text(encoding="utf-8")

    @cached_property
    def nodes(self) -> list[ast.AST]:
        return list(ast.walk(ast.parse(self.text)))

    @property
    def functions(self) -> Iterator[Function]:
        return (node for node in self.nodes if isinstance(node, Function))

    @cached_property
    def compilers(self) -> set[str]:
        """Names that stand for a decorator of numba in this module."""
        given = [node for node in self.nodes if isinstance(node, ast.Assign) and "njit" in ast.unparse(node.value)]
        return {ast.unparse(target) for node in given for target in node.targets}

    def is_kernel(self, function: Function) -> bool:
        """Whether numba compiles it."""
        decorators = [ast.unparse(each) for each in function.decorator_list]
        return any("njit" in each or each in self.compilers for each in decorators)

    def matches(self, pattern: re.Pattern[str]) -> Iterator[str]:
        """Place and text of each match, line by line."""
        for number, line in enumerate(self.text.splitlines(), 1):
            yield from (f"{self.name}:{number}: {found[0]}" for found in pattern.finditer(line))

    def with_many_parameters(self, compiled: bool) -> Iterator[str]:
        for function in self.functions:
            if self.is_kernel(function) == compiled and len(given := parameters(function)) >= MANY:
                yield f"{self.name}:{function.lineno}: {len(given)} {function.name}({', '.join(given)})"

    def long_functions(self) -> Iterator[str]:
        for function in self.functions:
            if (lines := length(function)) > LONG:
                yield f"{self.name}:{function.lineno}: {lines} {function.name}"

    def scene_imports(self) -> Iterator[str]:
        """The module's own name, if it imports Scene."""
        imported = (alias.name for node in self.nodes if isinstance(node, ast.ImportFrom) for alias in node.names)
        yield from [str(self.name)] * ("Scene" in imported)

    def subjectless(self) -> Iterator[str]:
        """Names and beginnings of sentences without a subject."""
        yield from (f"{self.name}: {name}" for name in names(self.path) if not has_subject(name))
        for where, text in docstrings(self.path):
            yield from (f"{self.name}: {where}: {sentence}" for sentence in subjectless_sentences(text))


def parameters(function: Function) -> list[str]:
    """Names of the parameters, without self and cls."""
    given = function.args
    found = [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return [name for name in found if name not in ("self", "cls")]


def length(function: Function) -> int:
    """Lines from the definition to the end, without those of the docstring."""
    first, *rest = function.body
    documented = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and rest
    inside = (first.end_lineno or first.lineno) - first.lineno + 1 if documented else 0
    return (function.end_lineno or function.lineno) - function.lineno + 1 - inside


def measures(modules: list[Module]) -> dict[str, list[str]]:
    """Places found for each measure, by its name."""
    return {
        "None tests on motions, joints, links and mesh": [at for one in modules for at in one.matches(NONE_TEST)],
        "modules that import Scene": [at for one in modules for at in one.scene_imports()],
        "occurrences of needs_mesh": [at for one in modules for at in one.matches(NEEDS_MESH)],
        f"functions with {MANY} parameters or more": [at for one in modules for at in one.with_many_parameters(False)],
        f"compiled kernels with {MANY} or more": [at for one in modules for at in one.with_many_parameters(True)],
        f"functions longer than {LONG} lines": [at for one in modules for at in one.long_functions()],
        "names and sentences without a subject": [at for one in modules for at in one.subjectless()],
    }


def room_lines(modules: list[Module]) -> Counter[str]:
    """Lines of all files in each room, the greatest first; a file beside the rooms is none."""
    lines: Counter[str] = Counter()
    for module in modules:
        first, *more = (*module.name.parts[:-1], "")
        rooms = [first, f"{first}/{more[0]}"] if first == "core" and more[0] else [first]
        lines.update({room: module.text.count("\n") for room in rooms if room})
    return lines


def main() -> None:
    """Print all measures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, nargs="?", default=ROOT / "src" / "rigidfluid")
    parser.add_argument("--list", action="store_true", help="the places as well")
    given = parser.parse_args()
    modules = [Module(path, path.relative_to(given.source)) for path in sorted(given.source.rglob("*.py"))]
    for name, places in measures(modules).items():
        print(f"{len(places):7d}  {name}")
        for place in places if given.list else ():
            print(f"         {place}")
    total = sum(module.text.count("\n") for module in modules)
    print(f"{total:7d}  lines")
    for room, lines in room_lines(modules).most_common():
        print(f"{100.0 * lines / total:6.1f}%  {room}")


if __name__ == "__main__":
    main()
