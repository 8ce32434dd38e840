"""Files that pages name are there: those in code spans, and those that links lead to."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from paths import ROOT

PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *ROOT.glob("plugins/*/*.md")]
ROOMS = "tests|docs|scenes|studies|benchmarks|tools|plugins|src"
NAMED = re.compile(rf"`((?:{ROOMS})/[\w./-]+)`")
PLACEHOLDER = "NAME"
LINKED = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_files_that_a_page_names_are_there(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    lost = [name for name in NAMED.findall(text) if not (ROOT / name).exists() and PLACEHOLDER not in name]
    lost += [name for name in LINKED.findall(text) if not (page.parent / name).exists()]
    assert not lost
