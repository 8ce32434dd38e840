"""Docstrings as the API reference shows them: their formulas are no markup."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

_CODE = re.compile(r"(``.+?``|`[^`]+`)")


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to the reading of docstrings, and show names of types by themselves."""
    from sphinx.util.inspect import TypeAliasForwardRef

    app.connect("autodoc-process-docstring", escape, priority=400)
    # A name that stands for a type, as FloatArray, within another type: Sphinx shows the object that keeps it.
    TypeAliasForwardRef.__repr__ = lambda alias: alias.name
    return {"parallel_read_safe": True}


def escape(_app: Sphinx | None, _what: str, _name: str, _thing: object, _options: object, lines: list[str]) -> None:
    """Escape what reStructuredText would take for markup in |r|², u* and x_ outside of code."""
    for number, line in enumerate(lines):
        parts = _CODE.split(line)
        parts[::2] = [re.sub(r"([|*]|_(?!\w))", r"\\\1", part) for part in parts[::2]]
        lines[number] = "".join(parts)
