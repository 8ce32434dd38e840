"""Count what makes the source hard to read: python tools/measure_source.py [SRC]

None tests are those on what may be absent in a system: motions, mechanisms, kinematics, joints, linkage and mesh.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "support"))

from prose import docstrings, has_subject, names, subjectless_sentences  # noqa: E402

_ABSENT = r"mechanisms?|motions?|kinematics|carried|carrier|free|linkage|links?|joints?|mesh"
_NONE_TEST = re.compile(rf"\b\w*(?:{_ABSENT})\b(?:\(\))? is (?:not )?None")
_NEEDS_MESH = re.compile(r"\bneeds_mesh\b")


def main(source: Path) -> None:
    """Print one count a line."""
    paths = sorted(source.rglob("*.py"))
    texts = [path.read_text(encoding="utf-8") for path in paths]
    functions = [function for text in texts for function in _functions(text)]
    rooms = _room_sizes(source)
    largest = max(rooms, key=lambda room: rooms[room])
    counts = {
        "None tests on motions, links, mesh": sum(len(_NONE_TEST.findall(text)) for text in texts),
        "modules that import Scene": sum(_imports_scene(text) for text in texts),
        "files that name needs_mesh": sum(bool(_NEEDS_MESH.search(text)) for text in texts),
        "functions with 6 parameters or more": sum(_parameters(function) >= 6 for function in functions),
        "functions of more than 50 lines": sum(_length(function) > 50 for function in functions),
        "names without a subject": sum(not has_subject(name) for path in paths for name in names(path)),
        "sentences without a subject": sum(
            len(subjectless_sentences(text)) for path in paths for _, text in docstrings(path)
        ),
        "lines": sum(text.count("\n") for text in texts),
        f"per cent of them in the largest room, {largest}": round(100 * rooms[largest]),
    }
    for name, count in counts.items():
        print(f"{count:7d}  {name}")


def _functions(text: str) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node


def _parameters(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Number of parameters without self and cls."""
    given = function.args
    parameters = [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return len([name for name in parameters if name not in ("self", "cls")])


def _length(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines of a function without its docstring."""
    first, *rest = function.body
    documented = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and rest
    start = rest[0].lineno if documented else function.lineno
    return (function.end_lineno or start) - start + 1


def _imports_scene(text: str) -> bool:
    return any(
        isinstance(node, ast.ImportFrom) and any(name.name == "Scene" for name in node.names)
        for node in ast.walk(ast.parse(text))
    )


def _room_sizes(source: Path) -> dict[str, float]:
    """Share of all lines in each folder of a depth of one or two, by its name."""
    total, rooms = 0, dict[str, int]()
    for path in source.rglob("*.py"):
        lines = path.read_text(encoding="utf-8").count("\n")
        total += lines
        folders = path.relative_to(source).parts[:-1]
        room = ".".join(folders[:2]) if folders[:1] == ("core",) else ".".join(folders[:1])
        rooms[room] = rooms.get(room, 0) + lines
    return {room: lines / total for room, lines in rooms.items()}


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "src" / "rigidfluid")
