"""Quick pages, made anew beside those of docs/validation and compared with them."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from page_tools.make import make
from page_tools.places import CHECKS, PAGES
from page_tools.same_page import differences

CORES = 2


def check(names: list[str], folder: Path = CHECKS, pages: Path = PAGES) -> Iterator[tuple[str, list[str]]]:
    """What each page says else when it is made anew in a ``folder``."""
    with ThreadPoolExecutor(CORES) as pool:
        made = pool.map(partial(make, fresh=True, folder=folder), names)
        for name, well in zip(names, made, strict=True):
            yield name, _compared(pages / f"{name}.md", folder / f"{name}.md") if well else ["could not be made"]


def _compared(before: Path, after: Path) -> list[str]:
    return list(differences(before.read_text(encoding="utf-8"), after.read_text(encoding="utf-8")))
