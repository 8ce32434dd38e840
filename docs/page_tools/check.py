"""Quick pages, made anew beside those of docs/validation and compared with them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from page_tools.make import make_several
from page_tools.places import CHECKS, PAGES
from page_tools.same_page import differences


def check(names: list[str], folder: Path = CHECKS, pages: Path = PAGES) -> Iterator[tuple[str, list[str]]]:
    """What each page says else when it is made anew in a ``folder``."""
    for name, well in make_several(names, fresh=True, folder=folder).items():
        yield name, _compared(pages / f"{name}.md", folder / f"{name}.md") if well else ["could not be made"]


def _compared(before: Path, after: Path) -> list[str]:
    return list(differences(before.read_text(encoding="utf-8"), after.read_text(encoding="utf-8")))
