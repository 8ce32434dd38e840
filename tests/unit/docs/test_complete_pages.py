"""The pages are complete, and their links lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from page_sections import section, text
from paths import ROOT, SCENES

import rigidfluid
from rigidfluid.core.output.records import columns
from rigidfluid.registry import KINDS, Registry

PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("table", columns(2))
def test_every_column_is_explained(table: str, dimension: int) -> None:
    named = section(text("docs/results.md"), f"{table}.csv")
    assert [name for name in columns(dimension, periodic=True)[table] if f"`{name}`" not in named] == []


def test_every_figure_of_the_summary_is_explained() -> None:
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=2e-5"])
    named = section(text("docs/results.md"), "summary.json")
    assert [key for key in rigidfluid.run(scene).summary if f"`{key}`" not in named] == []


def test_every_hook_is_explained() -> None:
    page = text("docs/plugins.md")
    for kind in KINDS:
        for word in (kind.hook, kind.interface.__name__, kind.field):
            assert f"`{word}`" in page


def test_every_built_in_part_is_among_the_features() -> None:
    page = text("docs/features.md")
    built_in = [entry.name for entry in Registry.load().entries if entry.origin.startswith("rigidfluid ")]
    assert [name for name in built_in if f"`{name}`" not in page] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files(page: Path) -> None:
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_the_picture_is_small() -> None:
    assert (ROOT / "docs" / "falling_disk.png").stat().st_size < 300 * 1024
