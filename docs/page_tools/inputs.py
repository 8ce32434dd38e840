"""What results were made from: a hash of each file, so that it can be said which of them have changed since."""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import rigidfluid
from page_tools.places import ROOT

Inputs = dict[str, str]
"""A hash by path, as seen from the root of the repository."""

SOURCES = ("src", "plugins", "docs", "tests/support", "benchmarks")
NOT_COMPUTING = (
    *(f"src/rigidfluid/{file}" for file in ("__main__.py", "cli/*.py", "commands.py", "plugin_commands.py")),
    *(f"src/rigidfluid/{room}" for room in ("checks", "post/movies", "post/reports", "testing")),
    "plugins/rigidfluid-lammps/src/rigidfluid_lammps/command.py",
    "docs/page_tools",
)
"""What no figure depends on."""

SEVERAL = "several"
"""In place of a hash where runs were made by several versions of a file."""


def sources() -> Inputs:
    """The modules of this repository that are loaded and may compute.

    A file that has been edited since it was loaded counts as it was when it was first asked for.

    Raises
    ------
    SystemExit
        If rigidfluid is loaded from elsewhere, since then nothing would be known of it.
    """
    if not Path(rigidfluid.__file__).is_relative_to(ROOT / "src"):
        raise SystemExit(f"rigidfluid is loaded from {rigidfluid.__file__}; put {ROOT / 'src'} on PYTHONPATH")
    files = (getattr(module, "__file__", None) for module in list(sys.modules.values()))
    loaded = {path for path in map(Path, filter(None, files)) if _computes(path)}
    LOADED.update(hashes(path for path in loaded if str(path.relative_to(ROOT)) not in LOADED))
    return dict(LOADED)


LOADED: Inputs = {}
"""What has been asked for of this process."""


def all_sources() -> Inputs:
    """Of rigidfluid and the benchmarks, whatever is loaded, all that may compute."""
    places = (ROOT / "src", ROOT / "benchmarks")
    return hashes(path for place in places for path in place.rglob("*.py") if _computes(path))


def hashes(paths: Iterable[Path]) -> Inputs:
    """The hash of each file of the repository."""
    return {str(path.relative_to(ROOT)): file_hash(path) for path in sorted(set(paths))}


def file_hash(path: Path) -> str:
    """Hash of a file, of a module without its prose; empty if the file is missing."""
    if not path.is_file():
        return ""
    file = path.stat()
    return _hash(path, file.st_mtime_ns, file.st_size)


@cache
def _hash(path: Path, changed: int, size: int) -> str:
    """Hash of a file as it is since it was ``changed`` [ns], with a ``size`` [byte]: each run of a page asks for it."""
    content = _code(path.read_text(encoding="utf-8")).encode() if path.suffix == ".py" else path.read_bytes()
    return hashlib.sha256(content).hexdigest()[:16]


def _code(source: str) -> str:
    """Syntax tree of a module without docstrings, comments and layout, as text: no figure depends on those."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(body := getattr(node, "body", None), list):
            node.body = [line for line in body if not _is_text(line)]
    return ast.dump(tree)


def _is_text(line: ast.stmt) -> bool:
    return isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) and isinstance(line.value.value, str)


def merged(one: Inputs, other: Inputs) -> Inputs:
    """The inputs of both; where they had different versions of a file it counts as changed, whatever it is now."""
    differ = {name for name in one.keys() & other.keys() if one[name] != other[name]}
    return one | other | dict.fromkeys(differ, SEVERAL)


def changed(inputs: Inputs) -> list[str]:
    """The files that are not what they were."""
    return sorted(name for name, known in inputs.items() if file_hash(ROOT / name) != known)


def _computes(path: Path) -> bool:
    def within(places: Iterable[str]) -> bool:
        return any(path.is_relative_to(ROOT / place) for place in places)

    return within(SOURCES) and not within(NOT_COMPUTING)
