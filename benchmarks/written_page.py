"""A page that a benchmark writes, with the hashes of what it was measured with."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1] / "docs"


def write_page(path: Path, text: str, files: Iterable[Path] = ()) -> None:
    """Write a page; for one of docs/validation the hashes of the scene ``files`` that it has read, and of all sources,
    as processes of its own may load any."""
    path.write_text(text, encoding="utf-8")
    if path.resolve().parent == DOCS / "validation":
        sys.path.append(str(DOCS))
        from page_tools.inputs import all_sources, hashes
        from page_tools.page import write_inputs

        write_inputs(path.stem, all_sources() | hashes(files))
