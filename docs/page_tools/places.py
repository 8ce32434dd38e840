"""Where things lie in this repository."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES, STUDIES = ROOT / "scenes", ROOT / "studies"
GENERATORS = ROOT / "docs" / "pages"
PAGES = ROOT / "docs" / "validation"
INPUTS = PAGES / "inputs"
RUNS = ROOT / "out" / "validation"


def generators() -> dict[str, Path]:
    """The module of each page, by the page's name; what several share begins with an underscore."""
    return {path.stem: path for path in sorted(GENERATORS.glob("[!_]*.py"))}
