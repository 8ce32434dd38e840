"""Code of the tutorial and of the how-to pages: each file is one that loads, each command and program runs."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from page_code import RUN, SHOWN, Block, is_missing, page_blocks, run_page
from paths import ROOT

from rigidfluid.api import scene_from_dict

TUTORIAL = sorted((ROOT / "docs" / "tutorial").glob("[1-9]*.md"))
HOW_TO = sorted((ROOT / "docs" / "howto").glob("*.md"))
FILES = [(page.stem, block) for page in [*TUTORIAL, *HOW_TO] for block in page_blocks(page) if block.file]


@pytest.mark.parametrize("page", [*TUTORIAL, *HOW_TO], ids=lambda page: page.stem)
def test_each_block_is_a_file_or_of_a_known_language(page: Path) -> None:
    unknown = {block.language for block in page_blocks(page) if not block.file} - RUN - SHOWN
    assert not unknown, f"found {unknown}; blocks that are not run are `console`"


@pytest.mark.parametrize(("page", "block"), FILES, ids=[f"{page}: {block.file}" for page, block in FILES])
def test_files_on_pages_are_scenes_or_programs(page: str, block: Block) -> None:
    if block.language == "python":
        compile(block.text, block.file or page, "exec")
        return
    table = tomllib.loads(block.text)
    if "scene" in table and not needs_other_files(table):
        scene_from_dict(table)


def needs_other_files(table: dict[str, Any]) -> bool:
    """Whether a scene names a drawing or a law that other blocks of its page make."""
    return "file" in table.get("domain", {}) or table.get("contact", {}).get("law") == "screened"


@pytest.mark.long
def test_the_tutorial_runs(tmp_path: Path) -> None:
    """Its pages are one session, in one folder; that of Gmsh is left out where Gmsh is missing."""
    pytest.importorskip("hatchling", reason="the package of the tutorial is built by hatchling")
    folder = tmp_path / "session"
    folder.mkdir()
    absent = frozenset(filter(is_missing, ["gmsh"]))
    for page in TUTORIAL:
        run_page(page, folder, absent)
    assert (folder / "out" / "box" / "report.html").exists()
    assert (folder / "out" / "resolution" / "study.html").exists()


@pytest.mark.long
@pytest.mark.nightly  # and by `make test-plugins`, where nothing is missing
@pytest.mark.parametrize("page", HOW_TO, ids=lambda page: page.stem)
def test_how_to_pages_run(page: Path, tmp_path: Path) -> None:
    """What needs a plug-in, PyVista or pandas is left out where they are missing."""
    folder = tmp_path / "session"
    folder.mkdir()
    run_page(page, folder, frozenset(filter(is_missing, ["rigidfluid_gymnasium", "pyvista", "pandas"])))
