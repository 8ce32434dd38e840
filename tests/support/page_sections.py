"""Text of the pages, their sections, and the blocks of code in them."""

from __future__ import annotations

import re

from paths import ROOT


def text(name: str) -> str:
    """Text of a page, named from the repository's folder."""
    return (ROOT / name).read_text(encoding="utf-8")


def section(page: str, title: str) -> str:
    """Text of one section of a page, without its title."""
    return page.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def blocks(page: str, language: str) -> list[str]:
    """Blocks of code in one language, in order."""
    return re.findall(rf"```{language}\n(.*?)```", page, flags=re.DOTALL)
