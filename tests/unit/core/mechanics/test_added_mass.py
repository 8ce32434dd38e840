"""Added mass against Lamb's values."""

from types import SimpleNamespace

import numpy as np
import pytest
from facet_shapes import polygon
from mesh_tools import ball, ellipsoid
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.mechanics.added_mass import added_mass


def test_of_a_ball_half_the_mass_of_the_fluid_it_displaces():
    shape = ball(0.3, dimension=3)
    np.testing.assert_allclose(added_mass(shape), 0.5 * shape.volume * np.eye(3), rtol=1e-12)


def test_of_a_disk_the_mass_of_the_fluid_it_displaces():
    shape = ball(0.3)
    np.testing.assert_allclose(added_mass(shape), shape.volume * np.eye(2), rtol=1e-12)


def test_of_an_ellipse():
    shape = ellipsoid(0.3, 0.1)
    np.testing.assert_allclose(added_mass(shape), np.pi * np.diag([0.1**2, 0.3**2]))


def test_of_a_spheroid_of_ratio_two():
    """k₁ = .2100, k₂ = .7042 in Lamb's table, § 115."""
    shape = ellipsoid(2.0, 1.0, 1.0)
    np.testing.assert_allclose(np.diag(added_mass(shape)) / shape.volume, [0.2100, 0.7042, 0.7042], atol=5e-5)


def test_of_a_thin_plate():
    """A disk of radius c that moves broadside: 8c³/3."""
    shape = ellipsoid(1.0, 1.0, 1e-5)
    assert added_mass(shape)[2, 2] == pytest.approx(8 / 3, rel=1e-4)


def test_of_a_shape_of_facets_that_of_the_ellipse_like_it_wherever_its_axes_are():
    """A box of 4 by 1, turned by .5: an ellipse of its area and of axes in its ratio."""
    turn = Rotation.from_rotvec([0.0, 0.0, 0.5]).as_matrix()[:2, :2]
    box = polygon(np.array([[-2.0, -0.5], [2.0, -0.5], [2.0, 0.5], [-2.0, 0.5]]) @ turn.T)
    half = np.sqrt(4.0 / (4.0 * np.pi))
    like = turn @ added_mass(ellipsoid(4.0 * half, half)) @ turn.T
    np.testing.assert_allclose(added_mass(box), like, rtol=1e-12)


def test_of_a_box_of_facets_in_space_that_of_the_ellipsoid_like_it():
    """Of 4 by 2 by 1, turned about an axis that is none of its own."""
    turn, sides = Rotation.from_rotvec([0.3, -0.5, 0.7]).as_matrix(), np.array([4.0, 2.0, 1.0])
    box = box_of_facets(sides, turn)
    axes = sides * (box.volume / (4.0 / 3.0 * np.pi * sides.prod())) ** (1.0 / 3.0)
    like = turn @ added_mass(ellipsoid(*axes)) @ turn.T
    np.testing.assert_allclose(added_mass(box), like, rtol=1e-9, atol=1e-12)


def box_of_facets(sides, turn):
    corners = (np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)]) * sides) @ turn.T
    facets = ConvexHull(corners).simplices
    away = np.cross(*np.swapaxes(np.diff(corners[facets], axis=1), 0, 1))
    inward = np.sum(away * corners[facets].mean(axis=1), axis=1) < 0.0
    facets[inward] = facets[inward][:, ::-1]
    known = {"dimension": 3, "semi_axes": None, "radius": None, "volume": float(sides.prod())}
    return SimpleNamespace(facets=Facets(corners, facets, np.zeros(len(facets), dtype=int)), **known)
