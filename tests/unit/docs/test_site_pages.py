"""Pages of the site that a script writes are up to date."""

from __future__ import annotations

from pathlib import Path

import pytest
from make_gallery import PAGES


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_made_by_a_script_are_up_to_date(page: Path) -> None:
    assert page.read_text(encoding="utf-8") == PAGES[page](), "run python docs/make_gallery.py"
