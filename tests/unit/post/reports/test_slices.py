"""Pictures of 3D runs: slices through known fields, the plane that is chosen, where bodies and gaps are seen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from typer.testing import CliRunner

import rigidfluid
from rigidfluid.cli import app
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.quadratic_cells import EDGES
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Fields
from rigidfluid.post.reports import report
from rigidfluid.post.reports.bodies import cut, placed_bodies
from rigidfluid.post.reports.canvas import Canvas, Shell
from rigidfluid.post.reports.coefficients import reference
from rigidfluid.post.reports.narrowest import gap_middle
from rigidfluid.post.reports.raster import Grid
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.space import box_edges, dry_space_picture
from rigidfluid.post.reports.style import SOLID, VERMILLION
from rigidfluid.post.reports.view_plane import ViewPlane, plane_of_motion, view_plane

OBLIQUE = ViewPlane(np.array([0.6, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]))
ACROSS_THE_DIAGONAL = ViewPlane(np.array([1.0, -1.0, 0.0]) / np.sqrt(2.0), np.array([1.0, 1.0, -2.0]) / np.sqrt(6.0))
BALL = {"type": "sphere", "radius": 0.1}


def cube(side: int) -> Fields:
    """The unit cube in small cubes of six quadratic tetrahedra each, at rest."""
    steps = [np.eye(3, dtype=int)[list(order)].cumsum(axis=0) for order in
             ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))]  # fmt: skip
    corners = np.array([np.vstack([np.zeros((1, 3), dtype=int), step]) for step in steps])
    lowest = np.stack(np.meshgrid(*3 * [np.arange(side)], indexing="ij"), axis=-1).reshape(-1, 1, 1, 3)
    corners = 2 * (lowest + corners).reshape(-1, 4, 3)
    first, second = np.transpose(EDGES[4])
    nodes = np.concatenate([corners, (corners[:, first] + corners[:, second]) // 2], axis=1)
    places, cells = np.unique(nodes.reshape(-1, 3), axis=0, return_inverse=True)
    points = places / (2.0 * side)
    return Fields(points, cells.reshape(-1, 10), np.zeros_like(points), np.zeros(len(points)))


def area(triangles: FloatArray) -> float:
    edges = triangles[:, 1:] - triangles[:, :1]
    return float(0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum())


@pytest.mark.parametrize(
    ("plane", "expected"),
    [(ViewPlane.coordinate_plane(0, 1, 3), 1.0), (OBLIQUE, 1.0 / 0.8), (ACROSS_THE_DIAGONAL, 0.75 * np.sqrt(3.0))],
    ids=["xy", "oblique", "diagonal"],
)
def test_a_slice_has_the_area_of_the_cross_section(plane: ViewPlane, expected: float) -> None:
    """Through the middle of a unit cube; across its diagonal it is a regular hexagon."""
    section = Section.cut(cube(3), plane, np.full(3, 0.5))
    assert area(section.slice_points) == pytest.approx(expected, rel=1e-12)
    np.testing.assert_allclose((section.slice_points - 0.5) @ plane.normal, 0.0, atol=1e-14)


def test_a_slice_shows_a_linear_field_exactly_and_the_vorticity_to_the_observer() -> None:
    fields = cube(2)
    spin = np.array([0.3, -0.7, 1.9])
    fields = Fields(fields.points, fields.cells, np.cross(spin, fields.points), fields.points @ spin)
    section = Section.cut(fields, OBLIQUE, np.array([0.5, 0.4, 0.45]))
    triangulation, values = section.triangles(section.fields.pressure)
    flat = np.stack([triangulation.x, triangulation.y], axis=1)
    np.testing.assert_allclose(values, OBLIQUE.lifted(flat, section.through) @ spin, atol=1e-13)
    np.testing.assert_allclose(section.triangles(section.vorticity)[1], 2.0 * spin @ OBLIQUE.normal, rtol=1e-12)


def test_edges_of_a_slice_are_those_of_the_cells() -> None:
    """A plane across z cuts a cube's six tetrahedra into a square, its diagonal, and pieces along the sides."""
    section = Section.cut(cube(1), ViewPlane.coordinate_plane(0, 1, 3), np.array([0.0, 0.0, 0.3]))
    assert len(section.fields.cells) == 6
    length = np.linalg.norm(np.diff(section.edges, axis=1), axis=2).sum()
    assert length == pytest.approx(4.0 + np.sqrt(2.0) + 2.0 * (0.3 + 0.7), rel=1e-12)


def run(folder: Path, bodies: list[dict[str, Any]], gravity: list[float] | None, **tables: Any) -> Results:
    """Some states of bodies without a fluid in a box of 4 by 3 by 2."""
    data = {
        "scene": {"name": "flight", "dimension": 3},
        "fluid": {"backend": "dry"} | ({} if gravity is None else {"gravity": gravity}),
        "domain": {"lower": [0.0, 0.0, 0.0], "upper": [4.0, 3.0, 2.0]},
        "body": [{"density": 1.0, "position": [2.0, 1.5, 1.0]} | (BALL if "type" not in b else {}) | b for b in bodies],
        "time": {"end": 0.5, "step": 0.05},
        "output": {"every": 0.25},
    } | tables
    rigidfluid.run(rigidfluid.scene_from_dict(data), folder)
    return read_results(folder)


@pytest.mark.parametrize(
    ("velocity", "gravity", "right", "up"),
    [
        ([0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1, 0, 0], [0, 1, 0]),
        ([0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0, 0, 1], [0, 1, 0]),
        ([0.6, 0.0, 0.8], [0.0, -1.0, 0.0], [0.6, 0, 0.8], [0, 1, 0]),
        ([-0.6, 0.0, -0.8], [0.0, -1.0, 0.0], [0.6, 0, 0.8], [0, 1, 0]),
        ([0.0, 0.5, 0.0], [0.0, 0.0, -1.0], [0, 1, 0], [0, 0, 1]),
        ([0.0, 0.0, 0.8], [-0.6, -0.8, 0.0], [0, 0, 1], [0.6, 0.8, 0]),
        ([0.0, 0.8, 0.0], None, [1, 0, 0], [0, 1, 0]),
        ([0.0, 0.0, 0.0], None, [1, 0, 0], [0, 1, 0]),
    ],
)
def test_the_plane_of_motion(
    velocity: list[float], gravity: list[float] | None, right: list[float], up: list[float], tmp_path: Path
) -> None:
    plane = plane_of_motion(run(tmp_path, [{"velocity": velocity}], gravity))
    np.testing.assert_allclose(plane.right, right, atol=1e-6)
    np.testing.assert_allclose(plane.up, up, atol=1e-6)


def test_bodies_that_spread_over_space_are_seen_along_an_axis(tmp_path: Path) -> None:
    places = [[1.0, 1.0, 0.5], [3.0, 2.0, 1.5], [2.0, 1.2, 1.4], [1.2, 2.0, 0.6]]
    plane = plane_of_motion(run(tmp_path, [{"position": place} for place in places], [0.0, -0.1, 0.0]))
    assert plane.words == "xy-plane"


@pytest.fixture(scope="module")
def tilted(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """An ellipsoid near the floor and flying obliquely, its long axis along its way."""
    half = 0.5 * np.arctan2(-0.8, 0.6)
    body = {"type": "ellipsoid", "semi_axes": [0.4, 0.1, 0.2], "velocity": [0.6, 0.0, 0.8]}
    place = {"orientation": [np.cos(half), 0.0, np.sin(half), 0.0], "position": [1.0, 0.3, 0.6]}
    return run(tmp_path_factory.mktemp("tilted"), [body | place], [0.0, -0.1, 0.0])


def test_an_ellipsoid_is_cut_in_its_true_ellipse(tilted: Results) -> None:
    plane, (body,) = view_plane(tilted), placed_bodies(tilted, -1)
    centre = body.centre
    (curve,) = cut(body, plane, centre)
    own = (curve - plane.flat(centre)) / (0.4, 0.1)
    np.testing.assert_allclose(np.linalg.norm(own, axis=1), 1.0, atol=0.01)
    (beside,) = cut(body, plane, centre + 0.1 * plane.normal)
    assert np.ptp(beside[:, 0]) == pytest.approx(2.0 * 0.4 * np.sqrt(0.75), rel=0.01)
    assert cut(body, plane, centre + 0.21 * plane.normal) == []


@pytest.mark.parametrize("gap", [0.1, 1e-6])
def test_the_smallest_gap_is_found_in_the_plane_and_in_no_other(gap: float, tilted: Results) -> None:
    height = np.full_like(tilted.bodies["y"], 0.1 + gap)
    tilted = replace(tilted, bodies=tilted.bodies | {"y": height, "gap": height - 0.1})
    plane, centre = view_plane(tilted), tilted.quantity("position")[-1, 0]
    middle = gap_middle(tilted, -1, 0, plane)
    assert middle is not None
    np.testing.assert_allclose(middle, [plane.flat(centre)[0], 0.5 * gap], atol=1e-2 * gap)
    assert gap_middle(tilted, -1, 0, ViewPlane.coordinate_plane(0, 2, 3)) is None


@pytest.mark.parametrize("kind", ["sphere", "ellipsoid"])
def test_surfaces_of_bodies_enclose_their_volume_and_their_normals_point_out(
    kind: str, tilted: Results, tmp_path: Path
) -> None:
    results = tilted if kind == "ellipsoid" else run(tmp_path, [{}], None)
    body = results.system.bodies[0]
    shell = Shell.cover(body, 1000)
    assert np.linalg.det(shell.triangles).sum() / 6.0 == pytest.approx(body.volume, rel=0.02)
    step = 1e-4 * body.bounding_radius
    outside = body.signed_distance((shell.triangles + step * shell.normals).reshape(-1, 3))
    np.testing.assert_allclose(outside, step, rtol=0.1)


def test_facets_are_flat_and_their_normals_point_out() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) - 0.25
    facets = Facets(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), np.zeros(4, dtype=int))
    shell = Shell.cover(cast(Body, SimpleNamespace(facets=facets)), 1000)
    np.testing.assert_array_equal(shell.triangles, corners[facets.vertices])
    outwards = np.vstack([-np.eye(3)[[2, 1, 0]], np.full((1, 3), np.sqrt(1.0 / 3.0))])
    np.testing.assert_allclose(shell.normals, np.repeat(outwards[:, None], 3, axis=1), atol=1e-15)


def test_a_box_has_twelve_edges() -> None:
    edges = box_edges(np.array([[0, 0, 0], [1.0, 2.0, 4.0]]))
    assert np.linalg.norm(np.diff(edges, axis=1), axis=2).sum() == 28.0


TRIANGLE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def front() -> Canvas:
    """An empty picture of the unit square, seen along z."""
    flat = Grid.between(np.zeros(2), np.ones(2), 20)
    return Canvas.blank(flat.lifted(ViewPlane.coordinate_plane(0, 1, 3), np.zeros(3)))


@pytest.mark.parametrize("heights", [(0.0, 1.0), (1.0, 0.0)])
def test_what_is_nearer_hides_what_is_behind_whatever_is_painted_first(heights: tuple[float, float]) -> None:
    together, apart = front(), front()
    triangles = np.array([TRIANGLE + [0.0, 0.0, height] for height in heights])
    values = np.repeat(np.array(heights)[:, None, None], 3, axis=1)
    together.paint(triangles, values, lambda at: np.repeat(0.5 * at, 3, axis=1))
    for k in range(2):
        apart.paint(triangles[[k]], values[[k]], lambda at: np.repeat(0.5 * at, 3, axis=1))
    for canvas in (together, apart):
        painted = np.isfinite(canvas.depth)
        assert painted.sum() == pytest.approx(0.5 * 20 * 20, rel=0.05)
        np.testing.assert_allclose(canvas.depth[painted], 1.0, rtol=1e-12)
        np.testing.assert_allclose(canvas.picture[painted], 0.5, rtol=1e-12)
        assert (canvas.picture[~painted] == 1.0).all()


def test_a_triangle_seen_from_the_side_leaves_the_picture_as_it_is() -> None:
    canvas = front()
    level = TRIANGLE[None][..., [0, 2, 1]] + [0.0, 0.525, 0.0]  # through the middles of points
    canvas.paint(level, np.zeros((1, 3, 1)), lambda at: np.zeros((len(at), 3)))
    assert (canvas.picture == 1.0).all()


def test_lines_behind_what_is_painted_are_not_shown() -> None:
    canvas = front()
    canvas.paint(TRIANGLE[None] + [0.0, 0.0, 0.5], np.zeros((1, 3, 1)), lambda at: np.zeros((len(at), 3)))
    points = np.array([[0.2, 0.2, 0.0], [0.2, 0.2, 0.45], [0.2, 0.2, 1.0], [0.9, 0.9, 0.0]])
    assert canvas.shows(points, 0.1).tolist() == [False, True, True, True]


def test_bodies_are_lit_from_above_and_a_path_is_drawn(tilted: Results) -> None:
    (axes,) = dry_space_picture(tilted, [0.5], view_plane(tilted)).axes
    image = axes.images[0].get_array()[..., 0]
    brightness = image[image < 1.0] / to_rgb(SOLID)[0]
    assert brightness.max() == pytest.approx(1.0, abs=0.02)
    assert brightness.min() == pytest.approx(0.4, abs=0.02)
    rows = np.nonzero(image < 1.0)[0]
    upper, lower = (image[row][image[row] < 1.0].mean() for row in (rows.max() - 5, rows.min() + 5))
    assert upper > lower
    assert len(axes.collections) == 13
    (path,) = (c for c in axes.collections if to_rgb(c.get_edgecolor()[0]) == to_rgb(VERMILLION))
    assert len(path.get_segments()) > 0


@pytest.fixture(scope="module")
def wet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ball pushed obliquely in a small box of fluid, of few cells."""
    folder = tmp_path_factory.mktemp("wet")
    fluid = {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.1, "gravity": [0.0, -1.0, 0.0]}
    body = {"name": "ball", "radius": 0.4, "density": 1.5, "velocity": [0.3, 0.0, 0.4]}
    mesh, time = {"size": 1.0, "size_body": 0.4}, {"end": 0.04, "step": 0.02}
    run(folder, [body], None, fluid=fluid, mesh=mesh, time=time, output={"every": 0.02})
    return folder


@pytest.mark.long
def test_a_report_of_a_3d_flow(wet: Path) -> None:
    names = {path.name for path in report(wet, plane="xz", follow="ball")}
    flow = {"speed_field", "streamlines", "vorticity", "pressure", "whole_mesh", "mesh", "space"}
    assert {f"{name}.png" for name in flow} <= names
    page = (wet / "report.html").read_text(encoding="utf-8")
    assert "In the xz-plane through ball." in page
    results = read_results(wet)
    assert reference(results) is None


@pytest.mark.parametrize(("arguments", "text"), [(["--follow", "nobody"], "nobody"), (["--plane", "zx"], "zx")])
def test_wrong_wishes(arguments: list[str], text: str, wet: Path) -> None:
    result = CliRunner().invoke(app, ["report", str(wet), *arguments])
    assert result.exit_code == 2
    assert text in result.stderr


def test_fields_of_a_3d_run_are_quadratic_for_others(wet: Path) -> None:
    meshio = pytest.importorskip("meshio")
    results = read_results(wet)
    read = meshio.read(results.series[-1][1])
    assert set(read.cells_dict) == {"tetra10"}
    speed = np.linalg.norm(read.point_data["velocity"], axis=1)
    on_body = np.isclose(np.linalg.norm(read.points - results.quantity("position")[-1, 0], axis=1), 0.4, atol=1e-6)
    assert on_body.sum() > 20
    np.testing.assert_allclose(speed[on_body], np.linalg.norm(results.quantity("velocity")[-1, 0]), rtol=0.05)
