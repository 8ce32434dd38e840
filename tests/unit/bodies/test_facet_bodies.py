"""Polygons and polyhedra: masses against closed forms, and what is refused."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from facet_shapes import CUBE, TRIANGLES, binary_stl, polygon, polyhedron
from mesh_files import write_stl
from mesh_tools import ball

from rigidfluid.bodies.polygon import Polygon, PolygonOptions
from rigidfluid.bodies.polyhedron import Polyhedron, PolyhedronOptions
from rigidfluid.core.mechanics.added_mass import added_mass
from rigidfluid.core.mechanics.rotational_factor import largest_rotational_factor
from rigidfluid.core.mechanics.shapes import half_thickness, inscribed_radius
from rigidfluid.errors import SceneError


def test_an_l_has_the_moments_of_its_two_rectangles() -> None:
    found = polygon([(9.0, 5.0), (11.0, 5.0), (11.0, 5.5), (9.5, 5.5), (9.5, 7.0), (9.0, 7.0)])
    areas, centres = np.array([1.0, 0.75]), np.array([[10.0, 5.25], [9.25, 6.25]])
    centre = areas @ centres / 1.75
    own = areas * np.array([2.0**2 + 0.5**2, 0.5**2 + 1.5**2]) / 12.0
    moved = areas * np.sum((centres - centre) ** 2, axis=1)
    assert found.volume == pytest.approx(1.75, rel=1e-14)
    assert found.unit_inertia[0, 0] == pytest.approx((own + moved).sum() / 1.75, rel=1e-13)
    np.testing.assert_allclose(found.facets.points[0] + centre, [9.0, 5.0], rtol=1e-14)
    assert found.bounding_radius == pytest.approx(max(np.hypot(*([11.0, 5.0] - centre)), np.hypot(*([9, 7] - centre))))


def test_a_shape_may_be_thick_where_its_centre_is_not() -> None:
    corner = polygon([(0.0, 0.0), (0.3, 0.0), (0.3, 0.12), (0.12, 0.12), (0.12, 0.3), (0.0, 0.3)])
    assert half_thickness(corner) == pytest.approx(0.12 * np.sqrt(2) / (1.0 + np.sqrt(2)), rel=0.05)
    assert 0.0 < inscribed_radius(corner) < 0.01
    thin = polygon([(0.0, 0.0), (1.0, 0.0), (1.0, 0.1), (0.1, 0.1), (0.1, 1.0), (0.0, 1.0)])
    assert inscribed_radius(thin) == 0.0
    assert half_thickness(ball(0.2)) == 0.2


@pytest.mark.parametrize("height", [1e-2, 1e-5, 1e-8])
def test_however_thin_a_shape_is_its_thickness_is_found(height: float, tmp_path: Path) -> None:
    """The incircle's radius of a triangle, 2A over the outline; half the height of a slab, along no axis."""
    side = float(np.hypot(0.2, height))
    triangle = polygon([(0.0, 0.0), (0.4, 0.0), (0.2, height)])
    assert half_thickness(triangle) == pytest.approx(2.0 * 0.2 * height / (0.4 + 2.0 * side), rel=0.01)
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    write_stl(tmp_path / "slab.stl", CUBE * [1.0, 1.0, max(height, 1e-6)] @ turn, np.array(TRIANGLES))
    assert half_thickness(polyhedron(tmp_path / "slab.stl")) == pytest.approx(0.5 * max(height, 1e-6), rel=1e-5)


def test_a_flat_polyhedron_is_refused(tmp_path: Path) -> None:
    """Before anything is divided by its volume: warnings are errors here."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 0.0]])
    write_stl(tmp_path / "flat.stl", points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    with pytest.raises(SceneError, match=r"body\.file: found facets that enclose nothing"):
        polyhedron(tmp_path / "flat.stl")


def test_a_cube_has_the_inertia_of_the_text_book_about_any_axes(tmp_path: Path) -> None:
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    cube = polyhedron(binary_stl(tmp_path / "cube.stl", CUBE @ turn + 4.0, TRIANGLES), scale=0.5)
    assert cube.volume == pytest.approx(1 / 8, rel=1e-6)  # the file has single precision
    np.testing.assert_allclose(cube.unit_inertia, 0.25 * np.eye(3) / 6, atol=1e-7)


def test_added_mass_and_rotational_factor_of_a_thin_bar_follow_its_length() -> None:
    bar = polygon([(0.0, 0.0), (4.0, 0.0), (4.0, 0.04), (0.0, 0.04)])
    along, across = np.diag(added_mass(bar))
    assert across == pytest.approx(pi * 2.0**2, rel=0.3)  # of a plate, πl²/4
    assert along < 0.1 * bar.volume
    assert largest_rotational_factor(bar) == pytest.approx(3.0, rel=1e-3)


def test_a_turned_bar_has_the_same_added_mass_turned() -> None:
    bar = [(0.0, 0.0), (2.0, 0.0), (2.0, 0.3), (0.0, 0.3)]
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    turned = polygon(np.array(bar) @ turn.T)
    np.testing.assert_allclose(added_mass(turned), turn @ added_mass(polygon(bar)) @ turn.T, atol=1e-14)


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "crosses itself"),
        ([(0, 0), (2, 0), (2, 1), (1, 0), (0, 1)], "crosses itself"),  # a corner on an edge
        ([(0, 0), (1, 0), (1, 0), (0, 1)], "corners 1 and 2 at the same place"),
        ([(0, 0), (1, 0), (1, 1), (0, 0)], "corners 3 and 0 at the same place"),
        ([(0, 0), (1, 0), (2, 0)], "straight back"),
        ([(0, 0), (2, 0), (1, 0), (1, 1)], "straight back"),
        ([(0, 0), (1, 0), (2, 1e-10)], "straight back"),
    ],
)
def test_lines_that_are_no_polygon_are_refused(corners: Any, words: str) -> None:
    with pytest.raises(SceneError, match=rf"body\.points: found .*{words}"):
        polygon(corners)


def test_dimensions_are_refused_by_name() -> None:
    with pytest.raises(SceneError, match=r'body\.type: found "polygon" in 3D'):
        Polygon(PolygonOptions(points=[[0, 0], [1, 0], [0, 1]]), 3)
    with pytest.raises(SceneError, match=r'body\.type: found "stl" in 2D'):
        Polyhedron(PolyhedronOptions(file="any.stl"), 2)


@pytest.mark.parametrize(
    ("triangles", "words"),
    [
        (TRIANGLES[1:], "an open surface, 3 edges"),
        ([TRIANGLES[0][::-1], *TRIANGLES[1:]], "3 edges that triangles go along in one sense"),
        ([*TRIANGLES, [0, 1, 1]], "1 triangles of no area"),
        ([*TRIANGLES, *((np.array(TRIANGLES) + 8).tolist())], "a surface in 2 pieces"),
    ],
)
def test_surfaces_that_enclose_no_body_are_refused(triangles: Any, words: str, tmp_path: Path) -> None:
    path = binary_stl(tmp_path / "cube.stl", np.concatenate([CUBE, CUBE + 5.0]), triangles)
    with pytest.raises(SceneError, match=rf"body\.file: found {words}"):
        polyhedron(path)


def test_a_polyhedron_that_goes_through_itself_is_refused(tmp_path: Path) -> None:
    pushed = CUBE.copy()
    pushed[7] = [-0.5, -0.5, 0.5]  # out through the opposite side
    with pytest.raises(SceneError, match=r"body\.file: found a surface that crosses itself"):
        polyhedron(binary_stl(tmp_path / "cube.stl", pushed, TRIANGLES))


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.1, 2.0])
def test_facets_in_one_plane_do_not_cross_whatever_rounding_says(turn: float, tmp_path: Path) -> None:
    """A cube's faces cut into fans about a middle that is off the plane by single precision."""
    points, triangles = fans_on_a_cube()
    across = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    body = polyhedron(binary_stl(tmp_path / "cube.stl", points @ across.T @ across[[1, 2, 0]], triangles))
    assert body.volume == pytest.approx(1.0, rel=1e-6)


def fans_on_a_cube() -> tuple[np.ndarray, list[list[int]]]:
    """Each face with five vertices on each edge and a fan of triangles from one within."""
    points: list[tuple[float, ...]] = []
    triangles: list[list[int]] = []

    def number(point: np.ndarray) -> int:
        key = tuple(np.round(point, 9).tolist())
        if key not in points:
            points.append(key)
        return points.index(key)

    steps = np.arange(5) / 5.0
    zeros, ones = np.zeros(5), np.ones(5)
    around = np.concatenate(
        [
            np.stack([steps, zeros], 1),
            np.stack([ones, steps], 1),
            np.stack([1 - steps, ones], 1),
            np.stack([zeros, 1 - steps], 1),
        ]
    )
    for axis in range(3):
        for side in (0.0, 1.0):
            ring = [number(np.insert(at, axis, side)) for at in around]
            middle = number(np.insert(np.array([0.37, 0.41]), axis, side))
            for a, b in zip(ring, np.roll(ring, -1), strict=True):
                outwards = (axis != 1) == (side == 1.0)
                triangles.append([middle, a, int(b)] if outwards else [middle, int(b), a])
    return np.array(points), triangles


@pytest.mark.parametrize("content", [b"", b"solid\nendsolid\n", b"solid\nvertex 0 0\n", b"\x00" * 200])
def test_files_without_triangles_are_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "cube.stl").write_bytes(content)
    with pytest.raises(SceneError, match=r"body\.file: found .*cube\.stl"):
        polyhedron(tmp_path / "cube.stl")
    with pytest.raises(SceneError, match=r"missing\.stl: No such file"):
        polyhedron(tmp_path / "missing.stl")
