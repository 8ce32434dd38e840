"""Where things lie in this repository."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES, STUDIES = ROOT / "scenes", ROOT / "studies"
GENERATORS = ROOT / "docs" / "pages"
PAGES = ROOT / "docs" / "validation"
RECORDS, MEASURED = PAGES / "records", PAGES / "measured"
RUNS, CHECKS = ROOT / "out" / "validation", ROOT / "out" / "pages"
"""Where runs are kept, and where quick pages are made to be compared."""


def generators() -> dict[str, Path]:
    """The module of each page, by the page's name; what several share begins with an underscore."""
    return {path.stem: path for path in sorted(GENERATORS.glob("[!_]*.py"))}
