"""Figures that the README and docs/figures.md quote, made again by the present sources, to the last digit given."""

from pathlib import Path

import pytest
from page_tools.make import make
from page_tools.places import ROOT
from page_tools.quotes import disagreements, quotes

pytestmark = pytest.mark.validation

TEXTS = [(ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "docs/figures.md")]
QUOTED = sorted({quote.page for text in TEXTS for quote in quotes(text)})


@pytest.mark.timeout(0)
@pytest.mark.parametrize("page", QUOTED)
def test_figures_are_those_of_the_page_made_again(page: str, tmp_path: Path) -> None:
    assert make(page, present=True, folder=tmp_path, kept=True)
    told = [line for text in TEXTS for line in disagreements(text, tmp_path)]
    assert [line for line in told if f" {page}: " in line] == []
