"""Files that a scene names."""

from __future__ import annotations

from pathlib import Path

import pytest

from rigidfluid.core.scene.toml_file import read_toml
from rigidfluid.errors import SceneError


def test_files_that_a_scene_names_are_sought_beside_it(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(
        '[domain]\ntype = "mesh"\nfile = "artery.msh"\nfaces = { file = 3 }\n[[body]]\nfile = "/elsewhere/star.stl"\n'
    )
    tables = read_toml(tmp_path / "scene.toml")
    assert tables["domain"] == {"type": "mesh", "file": str(tmp_path / "artery.msh"), "faces": {"file": 3}}
    assert tables["body"] == [{"file": "/elsewhere/star.stl"}]


@pytest.mark.parametrize(
    ("text", "kind", "told"),
    [
        ('[study]\nname = "a"\n', "scene", r"found a study file.*allowed is a scene file. `rigidfluid study .*` takes"),
        ('[scene]\nname = "a"\n', "study", r"found a scene file.*allowed is a study file. `rigidfluid run .*` takes"),
    ],
    ids=["study", "scene"],
)
def test_a_file_of_the_other_kind_is_told_as_one(tmp_path: Path, text: str, kind: str, told: str) -> None:
    (tmp_path / "file.toml").write_text(text)
    with pytest.raises(SceneError, match=told):
        read_toml(tmp_path / "file.toml", kind)
