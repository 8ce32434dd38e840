"""What `rigidfluid check` tells of the domain."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from channels import CHANNEL, PIN, THROAT, scene
from mesh_files import CUBE, TRIANGLES, write_stl
from typer.testing import CliRunner

from rigidfluid import load_scene
from rigidfluid.checks import check
from rigidfluid.cli import app
from rigidfluid.core.case.load import scene_from_dict

IN_A_CUBE = """
[scene]
name = "cube"
dimension = 3
[fluid]
density = 1.0
viscosity = 1.0
[domain]
type = "mesh"
file = "cube.stl"
scale = 3.0
faces = {{ shell = 1 }}
[[body]]
type = "sphere"
radius = {radius}
density = 2.0
position = [1.5, 1.5, 1.5]
[mesh]
size = 1.0
size_body = 0.2
[time]
end = 1.0
step = 0.1
[output]
every = 1.0
"""


def test_surfaces_are_told_with_shape_size_and_condition() -> None:
    inlet = {"on": "left", "type": "velocity", "velocity": [1.0, 0.0]}
    outlet = {"on": "right", "type": "pressure", "pressure": 0.0}
    body = {"type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.0, 0.0]}
    domain = check(scene_from_dict(scene(THROAT, boundary=[inlet, outlet], body=[body]))).domain
    assert (domain.type, domain.file, domain.lower, domain.upper) == ("stenosis", None, (-16.0, -4.0), (16.0, 4.0))
    told = [(surface.name, surface.shape, surface.condition) for surface in domain.surfaces]
    assert told[0] == ("left", "flat", "velocity")
    assert told[2] == ("bottom", "flat", "wall")
    assert told[4] == ("bottom_bump", "round, of radius 3.12", "wall")
    np.testing.assert_allclose([surface.area for surface in domain.surfaces[2:5:2]], [25.75, np.pi * 3.125])


def test_a_leaf_is_told_to_be_curved() -> None:
    leaf = {"type": "ellipsoid", "semi_axes": [0.2, 0.1], "position": [2.0, 0.5]}
    obstacles = [leaf, PIN | {"position": [3.0, 0.5]}]
    surface = check(scene_from_dict(scene(CHANNEL | {"obstacle": obstacles}))).domain.surfaces[4]
    assert surface.shape == "curved, radii from 0.05"


def test_a_file_is_told_with_what_was_done_to_it(tmp_path: Path) -> None:
    loose = CUBE[TRIANGLES].reshape(-1, 3) * (1.0 + 1e-12 * np.arange(36)[:, None])
    write_stl(tmp_path / "cube.stl", loose, np.arange(36).reshape(12, 3))
    (tmp_path / "cube.toml").write_text(IN_A_CUBE.format(radius=0.5))
    domain = check(load_scene(tmp_path / "cube.toml")).domain
    assert domain.file == str(tmp_path / "cube.stl")
    assert [(surface.name, surface.shape) for surface in domain.surfaces] == [("shell", "facets")]
    result = CliRunner().invoke(app, ["check", str(tmp_path / "cube.toml")], env={"COLUMNS": "200"})
    assert "domain: mesh, from " in result.stdout
    assert "points of the file were joined" in result.stdout


def test_a_body_larger_than_the_domain_hints_at_units(tmp_path: Path) -> None:
    write_stl(tmp_path / "cube.stl", CUBE, TRIANGLES)
    (tmp_path / "cube.toml").write_text(IN_A_CUBE.format(radius=500.0))
    result = CliRunner().invoke(app, ["check", str(tmp_path / "cube.toml")], env={"COLUMNS": "400"})
    assert result.exit_code == 2
    assert "body.0: found a bounding radius of 500 in a domain of width 3" in result.output
    assert "domain.scale" in result.output
