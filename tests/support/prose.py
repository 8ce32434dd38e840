"""Rule for names and docstrings, read from the syntax tree of each module."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

SUBJECTLESS = frozenset({"of", "by", "as", "at", "what", "where", "that", "those"})
"""Words with which no name and no sentence begins: its subject is missing."""

_SENTENCE = re.compile(r"(?:^|(?<=[.!?])\s+|\n\s*\n)\W*(\w+)")
_SECTION = re.compile(r"^\s*(Parameters|Returns|Yields|Raises|Attributes)\n\s*-{3,}", re.MULTILINE)
Named = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def docstrings(path: Path) -> Iterator[tuple[str, str]]:
    """Qualified name and text of each docstring of a module, those of constants and fields among them."""
    module = ast.parse(path.read_text(encoding="utf-8"))
    yield from _docstrings(module, path.stem)


def names(path: Path) -> Iterator[str]:
    """Name of the module, and of each function and class in it."""
    yield path.stem
    module = ast.parse(path.read_text(encoding="utf-8"))
    yield from (node.name for node in ast.walk(module) if isinstance(node, Named))


def has_subject(name: str) -> bool:
    """Whether the first word of a name may begin one."""
    return name.strip("_").split("_")[0].lower() not in SUBJECTLESS


def subjectless_sentences(text: str) -> list[str]:
    """Beginnings of the sentences of a docstring that have no subject."""
    return [text[found.start(1) : found.start(1) + 60] for found in _SENTENCE.finditer(text) if _is_bare(found[1])]


def has_sections(text: str) -> bool:
    """Whether a docstring has sections of numpydoc."""
    return _SECTION.search(text) is not None


def _is_bare(word: str) -> bool:
    return word[0].isupper() and word.lower() in SUBJECTLESS


def _docstrings(node: ast.Module | Named, name: str) -> Iterator[tuple[str, str]]:
    if text := ast.get_docstring(node):
        yield name, text
    for before, child in zip([None, *node.body], node.body, strict=False):
        if isinstance(child, Named):
            yield from _docstrings(child, f"{name}.{child.name}")
        elif isinstance(before, ast.Assign | ast.AnnAssign) and _is_text(child):
            target = before.target if isinstance(before, ast.AnnAssign) else before.targets[0]
            yield f"{name}.{ast.unparse(target)}", str(ast.literal_eval(child.value)).strip()


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
