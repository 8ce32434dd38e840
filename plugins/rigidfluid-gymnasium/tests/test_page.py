"""The page about control and learning, and what is kept of the example's run."""

from __future__ import annotations

from pathlib import Path

from page_code import run_page

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "howto" / "learning.md"


def test_the_page_runs(tmp_path: Path) -> None:
    folder = tmp_path / "session"
    folder.mkdir()
    run_page(PAGE, folder)
