"""Where results come from: the commit, a digest of the sources that compute, the versions of what they use."""

from __future__ import annotations

import ast
import hashlib
import os
import subprocess
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import rigidfluid
from page_tools.places import ROOT

COMPUTING = ("src", "plugins", "scenes", "studies", "tests/support", "benchmarks")
"""Where changes that are not committed count."""


COMMIT = "RIGIDFLUID_COMMIT"
"""Tells the commit to processes that have no git."""


@cache
def commit() -> str:
    """The commit of this working copy, with ``+`` where what computes has changes that are not in it."""
    if told := os.environ.get(COMMIT):
        return told
    head = _git("rev-parse", "--short=8", "HEAD")
    return head + "+" * bool(_git("status", "--porcelain", "--untracked-files=no", "--", *COMPUTING))


@cache
def source_digest() -> str:
    """Digest of the code of rigidfluid and its plug-ins, prose and layout left out; as it is when first asked for.

    Raises
    ------
    SystemExit
        If rigidfluid is loaded from elsewhere, since then nothing would be known of it.
    """
    if not Path(rigidfluid.__file__).is_relative_to(ROOT / "src"):
        raise SystemExit(f"rigidfluid is loaded from {rigidfluid.__file__}; put {ROOT / 'src'} on PYTHONPATH")
    files = sorted([*(ROOT / "src").rglob("*.py"), *(ROOT / "plugins").glob("*/src/**/*.py")])
    return _digest(ast.dump(_code(path)) for path in files)


def texts() -> dict[str, str]:
    """By path, the digest of what the loaded modules of docs/pages say."""
    loaded = (getattr(module, "__file__", None) for module in list(sys.modules.values()))
    pages = sorted(path for path in map(Path, filter(None, loaded)) if path.is_relative_to(ROOT / "docs" / "pages"))
    return {str(path.relative_to(ROOT)): text_digest(path) for path in pages}


def text_digest(path: Path) -> str:
    """Digest of a module's words and numbers, in their order; names, also of columns, change nothing that it says."""
    if not path.is_file():
        return ""
    constants = (node.value for node in ast.walk(_code(path)) if isinstance(node, ast.Constant))
    return _digest(repr(value) for value in constants if not (isinstance(value, str) and value.isidentifier()))


def file_digest(path: Path) -> str:
    """Digest of a file; empty if it is missing."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16] if path.is_file() else ""


def _code(path: Path) -> ast.Module:
    """Syntax tree of a module without docstrings."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(body := getattr(node, "body", None), list):
            node.body = [line for line in body if not _is_text(line)]
    return tree


def _is_text(line: ast.stmt) -> bool:
    return isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) and isinstance(line.value.value, str)


def _digest(parts: Iterable[str]) -> str:
    whole = hashlib.sha256()
    for part in parts:
        whole.update(part.encode() + b"\n")
    return whole.hexdigest()[:16]


def _git(*words: str) -> str:
    """What git says; nothing where this is no working copy."""
    done = subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False)
    return done.stdout.strip() if not done.returncode else ""
