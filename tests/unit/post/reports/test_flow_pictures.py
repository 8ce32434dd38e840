"""Vorticity and sampling of known fields, and the shape of pictures of long thin domains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.tri import TriContourSet

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.quadratic_cells import EDGES
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.cell_gradients import nodal_shear_rate, nodal_vorticity, vorticity
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.moment import Moment
from rigidfluid.post.reports.pictures import flow_picture, streamline_picture, viscosity_picture, whole_mesh_picture
from rigidfluid.post.reports.raster import Grid
from rigidfluid.post.reports.scale import QUANTITIES, Scale
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.style import BODY, HATCH, OUTSIDE, STYLE
from rigidfluid.post.reports.view_plane import ViewPlane

SPEED = Scale("speed", 0.0, 1.0, 1.0)
SPIN = np.array([0.3, -0.7, 1.9])


def square(side: int, size: tuple[float, float] = (1.0, 1.0)) -> Fields:
    """Quadratic triangles on a rectangle, at rest."""
    x, y = (np.linspace(0.0, length, 2 * side + 1) for length in size)
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    width = 2 * side + 1
    first = (2 * np.arange(side)[:, None] * width + 2 * np.arange(side)).reshape(-1, 1)
    lower = first + [0, 2, 2 * width + 2, 1, width + 2, width + 1]
    upper = first + [0, 2 * width + 2, 2 * width, width + 1, 2 * width + 1, width]
    return Fields(points, np.vstack([lower, upper]), np.zeros_like(points), np.zeros(len(points)))


def with_velocity(fields: Fields, velocity: FloatArray) -> Fields:
    return Fields(fields.points, fields.cells, velocity, fields.pressure)


def curved_cell(dimension: int) -> Fields:
    """One cell whose middle nodes are off the straight lines between its corners, at rest."""
    corners = np.vstack([np.zeros(dimension), np.eye(dimension)])
    middles = corners[np.array(EDGES[dimension + 1])].mean(axis=1)
    middles += np.random.default_rng(0).uniform(-0.06, 0.06, middles.shape)
    points = np.vstack([corners, middles])
    return Fields(points, np.arange(len(points))[None], np.zeros_like(points), np.zeros(len(points)))


def test_a_rigid_rotation_has_twice_its_spin_also_in_curved_cells() -> None:
    plane = curved_cell(2)
    turning = SPIN[2] * np.stack([-plane.points[:, 1], plane.points[:, 0]], axis=1)
    np.testing.assert_allclose(vorticity(with_velocity(plane, turning)), 2.0 * SPIN[2], rtol=1e-13)
    space = curved_cell(3)
    turning = np.cross(SPIN, space.points)
    found = vorticity(with_velocity(space, turning))
    np.testing.assert_allclose(found, np.broadcast_to(2.0 * SPIN, found.shape), rtol=1e-12)


@pytest.mark.parametrize("at_once", [20_000, 5])
def test_vorticity_at_a_node_is_the_mean_of_its_cells(monkeypatch: pytest.MonkeyPatch, at_once: int) -> None:
    """Also if cells are taken in several parts."""
    monkeypatch.setattr("rigidfluid.core.output.cell_gradients._AT_ONCE", at_once)
    fields = square(3)
    x, y = fields.points.T
    fields = with_velocity(fields, np.stack([np.abs(y - 1 / 3), 0.0 * x], axis=1))
    at_kink = np.isclose(y, 1 / 3)
    sides = vorticity(fields)[..., 0]
    expected = [np.mean(sides[fields.cells == node]) for node in range(len(fields.points))]
    np.testing.assert_allclose(nodal_vorticity(fields)[:, 0], expected, atol=1e-13)
    assert np.abs(nodal_vorticity(fields)[at_kink, 0]).max() < 0.5


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_shear_rate_of_a_shear_is_its_slope_and_that_of_a_rotation_is_zero(dimension: int) -> None:
    fields = curved_cell(dimension)
    shear = np.zeros((dimension, dimension))
    shear[0, 1] = 3.0
    for gradient, rate in ((shear, 3.0), (shear - shear.T, 0.0), (2.0 * np.diag([1.0, -1.0, 0.0][:dimension]), 4.0)):
        found = nodal_shear_rate(with_velocity(fields, fields.points @ gradient.T))
        np.testing.assert_allclose(found, rate, atol=1e-12)


def test_the_line_in_the_picture_of_a_viscosity_is_where_the_stress_is_the_yield_stress() -> None:
    """In a flow y² with the viscosity 1 + x the stress is 2 y (1 + x)."""
    fields = square(8)
    x, y = fields.points.T
    fields = replace(with_velocity(fields, np.stack([y**2, 0.0 * x], axis=1)), viscosity=1.0 + x)
    scale = Scale.fit("viscosity", *zip(moment(fields).section.spread("viscosity"), strict=True))
    assert (scale.lowest, scale.highest) == (1.0, 2.0)
    lines = {stress: _lines(viscosity_picture([moment(fields)], scale, stress)) for stress in (None, 1.0, 9.0)}
    assert lines[None] == lines[9.0] == []
    (line,) = lines[1.0]
    np.testing.assert_allclose(2.0 * line[:, 1] * (1.0 + line[:, 0]), 1.0, atol=0.01)
    assert len(line) > 8


def _lines(figure: Figure) -> list[FloatArray]:
    """Points (K, 2) of the contours in the first panel."""
    sets = [each for each in figure.axes[0].collections if isinstance(each, TriContourSet)]
    return [np.asarray(path.vertices) for each in sets for path in each.get_paths()]


def test_a_viscosity_that_does_not_vary_has_no_picture() -> None:
    with pytest.raises(OutputError, match=r"viscosity: found none in these fields.*\[fluid.material\]"):
        moment(square(1)).section.values("viscosity")


def test_poiseuille_flow_has_a_vorticity_linear_across_the_channel() -> None:
    fields = square(3)
    y = fields.points[:, 1]
    fields = with_velocity(fields, np.stack([y * (1.0 - y), 0.0 * y], axis=1))
    np.testing.assert_allclose(vorticity(fields)[..., 0], (2.0 * y - 1.0)[fields.cells], atol=1e-13)


def test_a_linear_field_is_sampled_exactly_and_nothing_outside_the_mesh() -> None:
    section = moment(square(3)).section
    grid = Grid(np.array([-0.25, 0.1]), np.array([0.05, 0.0]), np.array([0.0, 0.05]), 40, 10)
    x = np.add.outer(np.zeros(10), -0.25 + 0.05 * np.arange(40))
    y = np.add.outer(0.1 + 0.05 * np.arange(10), np.zeros(40))
    values = 1.0 + section.fields.points @ [1.0, -3.0]
    inside = (x > 1e-6) & (x < 1.0 - 1e-6)
    for at_nodes in (values, values[section.fields.cells]):
        image = section.image(at_nodes, grid)
        np.testing.assert_allclose(image[inside], (1.0 + x - 3.0 * y)[inside], atol=1e-13)
        assert np.isnan(image[(x < -1e-6) | (x > 1.0 + 1e-6)]).all()


def test_a_quadratic_field_is_sampled_between_its_nodes_with_the_second_order() -> None:
    grid = Grid(np.array([0.013, 0.027]), np.array([0.02, 0.0]), np.array([0.0, 0.02]), 48, 48)
    x, y = np.moveaxis(grid.points(), -1, 0)
    errors = []
    for side in (4, 8):
        section = moment(square(side)).section
        u, v = section.fields.points.T
        errors.append(np.abs(section.image(u**2 - 3.0 * u * v, grid) - (x**2 - 3.0 * x * y)).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_the_area_of_values_is_that_of_the_picture() -> None:
    fields = square(3, (2.0, 0.5))
    for quantity in QUANTITIES:
        values, areas = moment(fields).section.spread(quantity)
        assert values.shape == areas.shape
        assert areas.sum() == pytest.approx(1.0)
    rising = Fields(fields.points, fields.cells, fields.velocity, fields.points[:, 0])
    values, areas = moment(rising).section.spread("pressure")
    assert values @ areas == pytest.approx(1.0)


def test_a_slice_through_a_tetrahedron_is_sampled_in_its_plane() -> None:
    corners = np.vstack([np.zeros(3), np.eye(3)])
    points = np.vstack([corners, corners[np.array(EDGES[4])].mean(axis=1)])
    fields = Fields(points, np.arange(10)[None], np.zeros_like(points), np.zeros(10))
    grid = Grid(np.array([0.02, 0.02, 0.25]), np.array([0.1, 0.0, 0.0]), np.array([0.0, 0.1, 0.0]), 10, 10)
    x, y = 0.02 + 0.1 * np.arange(10)[None, :], 0.02 + 0.1 * np.arange(10)[:, None]
    image = Section.cut(fields, grid.plane, grid.origin).image(points @ [1.0, 2.0, 3.0], grid)
    inside = x + y < 0.75
    np.testing.assert_allclose(image[inside], (x + 2.0 * y + 0.75)[inside], atol=1e-13)
    assert np.isnan(image[~inside]).all()


def moment(fields: Fields) -> Moment:
    """All of a plane field."""
    section = Section.cut(fields, ViewPlane.coordinate_plane(0, 1, 2), np.zeros(2))
    return Moment(time=0.0, section=section, centre=np.zeros(2), width=0.1, gap=0.1)


def swirl(size: tuple[float, float]) -> Moment:
    fields = square(4, size)
    x, y = fields.points.T
    return moment(with_velocity(fields, np.stack([-y, x], axis=1)))


@pytest.mark.parametrize("size", [(1.0, 30.0), (30.0, 1.0), (1.0, 1.0)])
def test_pictures_of_any_domain_fit_on_a_page(size: tuple[float, float]) -> None:
    shown = [swirl(size)] * 4
    figures = [flow_picture(shown, Scale(quantity, 0.0, 1.0, 1.0)) for quantity in QUANTITIES]
    for figure in (*figures, streamline_picture(shown, SPEED), whole_mesh_picture(shown[0], SPEED)):
        assert np.all(np.array(figure.get_size_inches()) < 18.0)


@pytest.mark.parametrize(("count", "size"), [(4, (1.5, 1.2)), (3, (1.5, 1.2)), (1, (10.0, 1.0)), (4, (1.0, 6.0))])
def test_words_beside_panels_are_within_the_picture(count: int, size: tuple[float, float]) -> None:
    moments = [swirl(size)] * count
    with rc_context(STYLE):
        figure = flow_picture(moments, Scale("vorticity", -1.0, 1.0, 0.1))
        figure.canvas.draw()
        for axes in figure.axes:
            words = axes.get_tightbbox()
            assert words is not None
            assert min(words.x0, words.y0) >= 0.0
            assert words.x1 <= figure.bbox.width
            assert words.y1 <= figure.bbox.height


def test_streamlines_go_along_the_flow_and_there_are_none_at_rest() -> None:
    def lines(moment: Moment) -> list[FloatArray]:
        drawn = streamline_picture([moment], SPEED).axes[0].collections[1:]
        return [path for one in drawn for path in one.get_segments()]

    turning = swirl((1.0, 1.0))
    ends = np.array([[path[0], path[-1]] for path in lines(turning)])
    radius = np.linalg.norm(ends, axis=2)
    assert len(ends) > 50
    np.testing.assert_allclose(
        radius[:, 0], radius[:, 1], atol=0.005
    )  # circles; lines are bent to parts of the picture
    assert lines(moment(square(4))) == []


def test_bodies_are_drawn_apart_from_what_is_outside() -> None:
    """A body over the edge of a plane field, of which a quarter of the picture has none."""
    angle = np.linspace(0.0, 2.0 * np.pi, 60)
    circle = 0.2 * np.stack([np.cos(angle), np.sin(angle)], axis=1) + [1.0, 0.5]
    figure = flow_picture([replace(swirl((1.0, 1.0)), outlines=(circle,))], SPEED)
    axes = figure.axes[0]
    axes.set_xlim(0.5, 1.5)
    figure.canvas.draw()
    shown = np.asarray(figure.canvas.buffer_rgba())[..., :3]

    def colour(x: float, y: float) -> set[str]:
        column, row = axes.transData.transform((x, y)).round().astype(int)
        near = shown[len(shown) - row - 12 : len(shown) - row + 12, column - 12 : column + 12].reshape(-1, 3)
        return {to_hex(one / 255.0) for one in near}

    assert colour(1.1, 0.5) == {BODY} == colour(0.9, 0.5)
    assert {OUTSIDE, HATCH} <= colour(1.35, 0.5)
    assert BODY not in colour(1.35, 0.5) | colour(0.6, 0.5)
