"""What the site changes of pages and docstrings: links out of docs/, and formulas that would be markup."""

from __future__ import annotations

import pytest
from paths import ROOT
from site_tools.docstrings import escape
from site_tools.gallery import SCENES, first_sentence
from site_tools.outside import OUTSIDE, relinked

DOCS = ROOT / "docs"


@pytest.mark.parametrize(
    ("link", "file", "page", "path"),
    [
        ("results.md", "docs/scene.md", "scene", "results.md"),
        ("../numerics.md", "docs/validation/walls.md", "validation/walls", "../numerics.md"),
        ("../scenes/slider.toml", "docs/joints.md", "joints", "../scenes/slider.toml"),
        ("../plugins/rigidfluid-coal/README.md", "docs/plugins.md", "plugins", "packages/rigidfluid-coal.md"),
        ("docs/units.md", "CHANGELOG.md", "project/changes", "../units.md"),
        ("../../README.md", "plugins/rigidfluid-coal/README.md", "packages/rigidfluid-coal", "../index.md"),
        ("ARCHITECTURE.md", "CONTRIBUTING.md", "project/contributing", "architecture.md"),
        ("notebook.ipynb", "docs/howto/results-in-python.md", "howto/results-in-python", "notebook.md"),
    ],
)
def test_a_link_leads_to_where_the_site_has_its_target(link: str, file: str, page: str, path: str) -> None:
    assert relinked(link, ROOT / file, page) == path


@pytest.mark.parametrize("page", OUTSIDE)
def test_a_page_that_shows_a_file_names_it(page: str) -> None:
    assert OUTSIDE[page] in (DOCS / f"{page}.md").read_text(encoding="utf-8")
    assert (ROOT / OUTSIDE[page]).exists()


def test_readme_files_of_all_plug_ins_are_pages() -> None:
    folders = {f"packages/{project.parent.name}" for project in ROOT.glob("plugins/*/pyproject.toml")}
    assert folders <= set(OUTSIDE)


def test_formulas_are_escaped_and_code_is_not() -> None:
    lines = ["(|r|² I - r rᵀ) of u* in `a|b` and ``c*d``", "name_ of"]
    escape(None, "", "", None, None, lines)
    assert lines == [r"(\|r\|² I - r rᵀ) of u\* in `a|b` and ``c*d``", r"name\_ of"]


def test_the_gallery_takes_one_sentence_of_a_scene() -> None:
    assert first_sentence(SCENES / "falling_disk.toml") == "A disk falls through a channel onto its floor."
    assert first_sentence(SCENES / "insertion_2d.toml").endswith("`rigidfluid insert` meshes it.")
