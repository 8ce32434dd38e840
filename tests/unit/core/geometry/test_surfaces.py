"""What bodies and walls have in common, and that nobody but the box knows the names of its faces."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
from dish import rim
from mesh_tools import ball, ellipsoid

import rigidfluid
from rigidfluid.core.geometry.surface import Plane, Surface
from rigidfluid.domains.box import NAMES

SOURCE = Path(rigidfluid.__file__).parent


def test_a_plane_across_an_axis_has_exactly_its_coordinate() -> None:
    plane, points = Plane(np.array([0.1, 0.7]), np.array([0.0, -1.0])), np.random.default_rng(0).normal(size=(50, 2))
    assert plane.axis == 1
    assert np.all(plane.closest_point(points)[:, 1] == 0.7)
    np.testing.assert_array_equal(plane.signed_distance(points), 0.7 - points[:, 1])
    np.testing.assert_array_equal(plane.normal(points[:2]), [[0.0, -1.0]] * 2)


def test_a_slope_lies_along_no_axis() -> None:
    plane, points = Plane(np.zeros(2), np.array([0.6, 0.8])), np.random.default_rng(0).normal(size=(50, 2))
    assert plane.axis is None
    np.testing.assert_allclose(plane.signed_distance(plane.closest_point(points)), 0.0, atol=1e-15)


@pytest.mark.parametrize("dimension", [2, 3])
def test_curvature_has_a_sign(dimension: int) -> None:
    assert ball(0.3, dimension).radius == 0.3
    assert Plane(np.zeros(dimension), np.eye(dimension)[0]).radius == np.inf
    assert rim(0, dimension=dimension).shape.radius == -1.0
    assert ellipsoid(*[1.0, 0.5, 0.7][:dimension]).radius is None


@pytest.mark.parametrize("shape", [ball(0.3), ball(0.3, 3), ellipsoid(0.4, 0.2), ellipsoid(0.4, 0.2, 0.3)])
def test_bodies_are_surfaces_with_normals_out_of_them(shape: Surface) -> None:
    lower, upper = shape.bounds
    surface = shape.sample_surface(50)
    assert np.all((surface >= lower - 1e-12) & (surface <= upper + 1e-12))
    normal = shape.normal(surface)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-12)
    gradient = surface / shape.semi_axes**2
    np.testing.assert_allclose(normal, gradient / np.linalg.norm(gradient, axis=1, keepdims=True), atol=1e-6)
    assert shape.plane is None


def named_faces(path: Path) -> set[str]:
    """Texts of a module that are names of a box's faces, but for values of keywords, as in ``side="left"``."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    keywords = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.keyword)}
    texts = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and id(node) not in keywords]
    return {node.value for node in texts if node.value in NAMES}


def test_the_box_alone_knows_the_names_of_its_faces() -> None:
    """And the swimmer those of its balls."""
    found = {str(path.relative_to(SOURCE)): named_faces(path) for path in sorted(SOURCE.rglob("*.py"))}
    assert {name: faces for name, faces in found.items() if faces} == {
        "domains/box.py": set(NAMES),
        "mechanisms/three_sphere_swimmer.py": {"left", "right"},
    }
