"""Files that a scene names."""

from __future__ import annotations

from pathlib import Path

from rigidfluid.core.scene.toml_file import read_toml


def test_files_that_a_scene_names_are_sought_beside_it(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(
        '[domain]\ntype = "mesh"\nfile = "artery.msh"\nfaces = { file = 3 }\n[[body]]\nfile = "/elsewhere/star.stl"\n'
    )
    tables = read_toml(tmp_path / "scene.toml")
    assert tables["domain"] == {"type": "mesh", "file": str(tmp_path / "artery.msh"), "faces": {"file": 3}}
    assert tables["body"] == [{"file": "/elsewhere/star.stl"}]
