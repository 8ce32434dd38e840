"""Pages of the site that a script writes are up to date, and the gallery has a picture of each scene."""

from __future__ import annotations

from pathlib import Path

import pytest
from make_gallery import PAGES
from make_pictures import PICTURES
from site_tools.gallery import SCENES, picture


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_made_by_a_script_are_up_to_date(page: Path) -> None:
    assert page.read_text(encoding="utf-8") == PAGES[page](), "run python docs/make_gallery.py"


def test_each_shipped_scene_and_no_other_has_a_picture() -> None:
    shipped = {scene.stem for scene in SCENES.glob("*.toml")}
    drawn = {path.stem for path in picture("any").parent.iterdir()}
    assert shipped == set(PICTURES) == drawn


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_of_the_gallery_are_small(name: str) -> None:
    assert picture(name).read_bytes().startswith(b"\x89PNG")
    assert picture(name).stat().st_size < 100_000
