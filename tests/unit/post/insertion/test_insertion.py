"""`rigidfluid insert`: the first mesh of a scene, its files, and what it says of itself."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from mesh_tools import ball, box, ellipsoid, upright
from typer.testing import CliRunner

from rigidfluid.api import Simulation
from rigidfluid.cli import app
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.mesh_files import write_mesh_vtu, write_msh
from rigidfluid.errors import SceneError
from rigidfluid.post.insertion.insert import INSERTION, insert
from rigidfluid.post.reports.slice import WHOLE, Slice, cut_faces

NAMES = ["ball", "egg", *"abcdef"]
RECTANGLE = {
    "type": "polygon",
    "points": [[0.0, 0.0], [0.6, 0.0], [0.6, 0.3], [0.0, 0.3]],
    "density": 2.0,
    "position": [0.6, 1.3],
    "angle": 0.4,
}
DISK = {"name": "disk", "type": "sphere", "radius": 0.25, "density": 2.0, "position": [1.3, 0.6]}
TEXT = """
[scene]
name = "pair"
dimension = 2
[fluid]
density = 1.0
viscosity = 0.1
[domain]
lower = [0.0, 0.0]
upper = [2.0, 2.0]
[[body]]
type = "sphere"
radius = 0.25
density = 2.0
position = [1.0, 0.6]
[mesh]
size = 0.3
size_body = 0.1
inserter = "fill"
[time]
end = 1.0
step = 0.1
[output]
every = 0.5
"""


def scene(*bodies: dict[str, Any], **tables: Any) -> dict[str, Any]:
    return {
        "scene": {"name": "pair", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.1},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 2.0]},
        "body": list(bodies or (RECTANGLE, DISK)),
        "mesh": {"size": 0.3, "size_body": 0.1},
        "time": {"end": 1.0, "step": 0.1},
        "output": {"every": 0.5},
        **tables,
    }


def small_mesh(dimension: int) -> Mesh:
    sizes = Sizes(0.4, 0.15, 0.5)
    egg = ellipsoid(0.25, 0.15) if dimension == 2 else ellipsoid(0.25, 0.15, 0.2)
    pose = upright(*np.array([[0.4, 0.4, 0.4], [1.3, 1.2, 1.2]])[:, :dimension])
    return initial_mesh(
        FluidDomain([ball(0.2, dimension), egg], pose, box([0.0] * dimension, [2.0] * dimension), []), sizes
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_gmsh_file_has_all_to_the_last_bit(tmp_path: Path, dimension: int) -> None:
    mesh, names = small_mesh(dimension), NAMES[: 2 + 2 * dimension]
    write_msh(tmp_path / "mesh.msh", mesh, names)
    read = meshio.read(tmp_path / "mesh.msh")
    assert {name: tuple(group) for name, group in read.field_data.items()} == {
        **{name: (number, dimension - 1) for number, name in enumerate(names, start=1)},
        "fluid": (len(names) + 1, dimension),
    }
    np.testing.assert_array_equal(read.points[:, :dimension], mesh.points)
    np.testing.assert_array_equal(np.concatenate([c.data for c in read.cells if c.dim == dimension]), mesh.cells)
    np.testing.assert_array_equal(np.concatenate([c.data for c in read.cells if c.dim < dimension]), mesh.facets)
    groups = zip(read.cells, read.cell_data["gmsh:physical"], strict=True)
    np.testing.assert_array_equal(np.concatenate([g for c, g in groups if c.dim < dimension]), mesh.markers + 1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_vtu_file_has_cells_facets_and_names(tmp_path: Path, dimension: int) -> None:
    mesh, names = small_mesh(dimension), NAMES[: 2 + 2 * dimension]
    write_mesh_vtu(tmp_path / "mesh.vtu", mesh, names)
    read = meshio.read(tmp_path / "mesh.vtu")
    cells, facets = read.cells
    np.testing.assert_array_equal(read.points[:, :dimension], mesh.points)
    np.testing.assert_array_equal(cells.data, mesh.cells)
    np.testing.assert_array_equal(facets.data, mesh.facets)
    np.testing.assert_array_equal(read.cell_data["surface"][0], -1)
    np.testing.assert_array_equal(read.cell_data["surface"][1], mesh.markers)
    assert {name: int(number[0]) for name, number in read.field_data.items()} == dict(
        zip(names, range(8), strict=False)
    )


def test_a_report_counts_what_was_kept(tmp_path: Path) -> None:
    told: list[str] = []
    figures, written = insert(scene_from_dict(scene()), tmp_path, told.append)
    assert {path.name for path in written} | {INSERTION.mark} == {path.name for path in tmp_path.iterdir()}
    assert json.loads((tmp_path / "insertion.json").read_text("utf-8"))["cells"] == figures.cells
    assert [told[0], told[-1]] == ["checking the scene", "writing mesh and report"]
    assert figures.inserter == "fill"
    assert list(figures.seconds) == ["scene", "insertion", "grading"]
    rectangle, disk, left = figures.surfaces[:3]
    assert (rectangle.kind, disk.kind, left.kind) == ("facets", "smooth", "flat")
    assert (rectangle.given_corners, rectangle.kept_corners) == (4, 4)
    assert (rectangle.given_facets, rectangle.kept_facets) == (4, 0)  # all of them halved
    assert rectangle.area == pytest.approx(1.8, rel=1e-13)
    assert rectangle.volume == pytest.approx(0.18, rel=1e-13)
    assert max(rectangle.vertices_off, rectangle.middles_off, disk.vertices_off) < 1e-15
    longest = 2.0 * np.pi * 0.25 / disk.facets
    assert disk.middles_off == pytest.approx(longest**2 / (8.0 * 0.25), rel=0.05)
    assert disk.volume == pytest.approx(disk.exact_volume, rel=0.03)
    assert figures.volume == pytest.approx(4.0 - rectangle.volume - disk.volume, rel=1e-12)
    assert figures.exact_volume == pytest.approx(4.0 - 0.18 - np.pi / 16.0, rel=1e-12)
    assert sum(figures.quality_histogram) == figures.cells


def test_a_body_across_periodic_surfaces_is_whole(tmp_path: Path) -> None:
    """Its figures are those of its image on the mesh, which is that of the run."""
    sides = [{"on": side, "type": "periodic"} for side in ("left", "right")]
    case = scene_from_dict(scene({**DISK, "position": [1.999999, 0.6], "radius": 0.2}, boundary=sides))
    figures, _ = insert(case, tmp_path)
    assert [surface.name for surface in figures.surfaces] == ["disk", "bottom", "top"]
    disk = figures.surfaces[0]
    assert disk.vertices_off < 1e-12
    assert disk.volume == pytest.approx(np.pi * 0.04, rel=0.05)
    assert figures.cells == len(Simulation(case).state.mesh.cells)


def test_level_sets_lose_corners(tmp_path: Path) -> None:
    figures, _ = insert(scene_from_dict(scene(mesh={"size": 0.3, "size_body": 0.1, "inserter": "level_set"})), tmp_path)
    rectangle = figures.surfaces[0]
    assert rectangle.kept_corners == 0
    assert rectangle.middles_off > 1e-3


def test_a_slice_through_cells_is_as_large_as_the_domain_there() -> None:
    mesh = small_mesh(3)
    cut = Slice.cut((mesh.points[:, 2] - 0.8)[mesh.cells], WHOLE)
    triangles = cut.values(mesh.points[mesh.cells])
    np.testing.assert_allclose(triangles[..., 2], 0.8, rtol=1e-12)
    sides = triangles[:, 1:] - triangles[:, :1]
    assert 0.5 * np.abs(np.cross(sides[:, 0], sides[:, 1])[:, 2]).sum() == pytest.approx(4.0, rel=1e-10)  # no body
    edges = cut_faces(mesh.points, mesh.cells, np.array([0.0, 0.0, 1.0]), np.full(3, 0.8))
    assert np.linalg.norm(np.diff(edges, axis=1), axis=2).sum() > 8.0
    np.testing.assert_allclose(edges[..., 2], 0.8, rtol=1e-12)


def test_a_report_of_a_mesh_in_space(tmp_path: Path) -> None:
    body = {"type": "sphere", "radius": 0.4, "density": 2.0, "position": [1.0, 1.0, 1.0]}
    tables = {
        "scene": {"name": "ball", "dimension": 3},
        "domain": {"lower": [0.0] * 3, "upper": [2.0] * 3},
        "mesh": {"size": 0.6, "size_body": 0.25, "growth": 0.5, "inserter": "fill"},
    }
    figures, written = insert(scene_from_dict(scene(body, **tables)), tmp_path)
    assert figures.surfaces[0].volume == pytest.approx(figures.surfaces[0].exact_volume, rel=0.2)
    assert figures.surfaces[1].area == pytest.approx(4.0, rel=1e-12)
    assert figures.volume == pytest.approx(8.0 - figures.surfaces[0].volume, rel=1e-12)
    assert all(path.stat().st_size for path in written)


def test_the_command_tells_what_it_does(tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_text(TEXT, encoding="utf-8")
    result = CliRunner().invoke(app, ["insert", str(file), "--out", str(tmp_path / "mesh")], env={"COLUMNS": "200"})
    assert result.exit_code == 0, result.stderr
    assert "pair: filling between the facets of domain and bodies" in result.stderr
    assert "worst quality" in result.stdout
    assert "insertion.html" in result.stdout


def test_a_scene_without_a_mesh_is_refused_without_a_traceback(tmp_path: Path) -> None:
    file = tmp_path / "dry.toml"
    text = TEXT.partition("[mesh]")[0] + "[time]" + TEXT.partition("[time]")[2]
    file.write_text(text.replace("viscosity = 0.1", 'viscosity = 0.1\nbackend = "dry"'), encoding="utf-8")
    result = CliRunner().invoke(app, ["insert", str(file), "--out", str(tmp_path / "mesh")])
    assert result.exit_code == 2
    assert result.stderr.startswith(f"Error: {file}: mesh: found no such table")
    assert not (tmp_path / "mesh").exists()


def test_a_scene_without_a_fluid_that_has_a_mesh_is_meshed_as_with_one(tmp_path: Path) -> None:
    wet, _ = insert(scene_from_dict(tomllib.loads(TEXT)), tmp_path / "wet")
    dry = TEXT.replace("viscosity = 0.1", 'viscosity = 0.1\nbackend = "dry"')
    other, _ = insert(scene_from_dict(tomllib.loads(dry)), tmp_path / "dry")
    assert (other.cells, other.vertices, other.surfaces) == (wet.cells, wet.vertices, wet.surfaces)


def test_a_way_that_does_not_suit_a_shape_is_refused() -> None:
    with pytest.raises(SceneError, match=r"mesh.inserter: found 'cad' with body.0 made of facets"):
        scene_from_dict(scene(mesh={"size": 0.3, "size_body": 0.1, "inserter": "cad"}))
    with pytest.raises(SceneError, match=r"mesh.inserter"):
        scene_from_dict(scene(mesh={"size": 0.3, "size_body": 0.1, "inserter": "glue"}))


def test_cells_of_a_file_fill_the_domain(tmp_path: Path) -> None:
    _, written = insert(scene_from_dict(scene(DISK)), tmp_path)
    read = meshio.read(next(path for path in written if path.suffix == ".msh"))
    triangles = np.concatenate([c.data for c in read.cells if c.type == "triangle"])
    area = cell_volumes(read.points[:, :2], triangles)
    assert area.min() > 0.0
    assert area.sum() == pytest.approx(4.0 - np.pi / 16.0, rel=0.01)
