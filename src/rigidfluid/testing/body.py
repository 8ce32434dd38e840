"""Contract tests of a body type."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facet_moments import facet_moments, unit_inertia
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.model.body import Body


class BodyContract:
    """Geometry and mass of one shape, measured from its own signed distance.

    Override the fixture ``body``; parametrise it to hold several shapes to the same standard.
    """

    tolerance: ClassVar[float] = 1e-10
    """Accuracy of points and distances, relative to the bounding radius."""
    quadrature_tolerance: ClassVar[float] = 5e-3
    """Accuracy of volume and unit_inertia as counted on a grid of points."""
    cad_tolerance: ClassVar[float] = 1e-5
    """Accuracy of the volume of the CAD shape (the kernel integrates numerically)."""

    @pytest.fixture
    def body(self) -> Body:
        """The body under test."""
        raise NotImplementedError("override the fixture `body`")

    def test_volume_is_that_of_the_inside(self, body: Body) -> None:
        """Volume = ∫ of the indicator of signed_distance < 0, by counting grid points."""
        points, cell = _grid(body)
        counted = np.count_nonzero(body.signed_distance(points) < 0) * cell
        assert counted == pytest.approx(body.volume, rel=self.quadrature_tolerance)

    def test_centre_of_mass_is_the_origin(self, body: Body) -> None:
        """∫ r = 0 over the inside."""
        centre = _inside(body).mean(axis=0)
        assert np.abs(centre).max() < self.quadrature_tolerance * body.bounding_radius

    def test_unit_inertia_is_that_of_the_inside(self, body: Body) -> None:
        """Unit inertia = mean of |r|² I - r rᵀ over the inside, in 2D its scalar."""
        inside = _inside(body)
        counted = _unit_inertia(inside)
        assert body.unit_inertia.shape == counted.shape
        np.testing.assert_allclose(
            body.unit_inertia, counted, rtol=0, atol=self.quadrature_tolerance * np.abs(counted).max()
        )

    def test_closest_point_is_signed_distance_away(self, body: Body) -> None:
        """|x - closest_point(x)| = |signed_distance(x)|."""
        points = _probes(body)
        away = np.linalg.norm(points - body.closest_point(points), axis=1)
        np.testing.assert_allclose(away, np.abs(body.signed_distance(points)), rtol=0, atol=self._length(body))

    def test_closest_point_is_on_the_surface(self, body: Body) -> None:
        """signed_distance(closest_point(x)) = 0, and it is its own closest point."""
        foot = body.closest_point(_probes(body))
        np.testing.assert_allclose(body.signed_distance(foot), 0.0, rtol=0, atol=self._length(body))
        np.testing.assert_allclose(body.closest_point(foot), foot, rtol=0, atol=self._length(body))

    def test_no_surface_point_is_nearer(self, body: Body) -> None:
        """|signed_distance(x)| is at most the distance to each sample of the surface."""
        points = _probes(body)
        apart = np.linalg.norm(points[:, None] - body.sample_surface(500)[None], axis=2).min(axis=1)
        assert np.all(np.abs(body.signed_distance(points)) <= apart + self._length(body))

    def test_sign_is_negative_inside_positive_outside(self, body: Body) -> None:
        """Far points are outside; going from the surface to a far point, the distance is never negative."""
        far = 10 * body.bounding_radius * _directions(body.dimension)
        assert np.all(body.signed_distance(far) > 0)
        inside = _inside(body)
        deepest = inside[np.argmin(body.signed_distance(inside))]
        assert body.signed_distance(deepest[None])[0] < 0

    def test_distance_changes_as_fast_as_the_point_moves(self, body: Body) -> None:
        """signed_distance(x + s n) = signed_distance(x) + s along the outward line of a surface point."""
        foot = body.closest_point(2 * body.bounding_radius * _directions(body.dimension))
        outward = 2 * body.bounding_radius * _directions(body.dimension) - foot
        for share in (0.1, 0.5, 0.9):
            expected = share * np.linalg.norm(outward, axis=1)
            found = body.signed_distance(foot + share * outward)
            np.testing.assert_allclose(found, expected, rtol=0, atol=self._length(body))

    def test_samples_are_on_the_surface(self, body: Body) -> None:
        """About as many points as asked for, all with zero signed distance."""
        samples = body.sample_surface(200)
        assert samples.shape[1] == body.dimension
        assert 100 <= len(samples) <= 400
        np.testing.assert_allclose(body.signed_distance(samples), 0.0, rtol=0, atol=self._length(body))

    def test_bounding_radius_holds_and_is_tight(self, body: Body) -> None:
        """The farthest sample of the surface is at the bounding radius, and none is beyond."""
        farthest = np.linalg.norm(body.sample_surface(2000), axis=1).max()
        assert 0.98 * body.bounding_radius <= farthest <= (1 + self.tolerance) * body.bounding_radius

    def test_radius_is_given_for_balls_alone(self, body: Body) -> None:
        """A radius means signed_distance(x) = |x| - radius."""
        if body.radius is None:
            return
        points = _probes(body)
        expected = np.linalg.norm(points, axis=1) - body.radius
        np.testing.assert_allclose(body.signed_distance(points), expected, rtol=0, atol=self._length(body))

    def test_semi_axes_are_given_for_ellipsoids_alone(self, body: Body) -> None:
        """Semi-axes a mean Σ (x_i/a_i)² = 1 on the surface."""
        if body.semi_axes is None:
            return
        assert body.semi_axes.shape == (body.dimension,)
        scaled = np.linalg.norm(body.sample_surface(200) / body.semi_axes, axis=1)
        np.testing.assert_allclose(scaled, 1.0, rtol=0, atol=self.tolerance * np.ptp([0.0, *1 / body.semi_axes]))

    def test_cad_shape_is_the_same_shape(self, body: Body) -> None:
        """The CAD shape has the exact volume and centre in any unit, and its mesh has its boundary on the surface."""
        occ = pytest.importorskip("netgen.occ")
        unit = 0.7 * body.bounding_radius
        shape = body.cad_shape(unit)
        if shape is None:
            assert body.facets is not None, "neither a cad_shape nor facets: no mesh can be made around it"
            return
        assert shape.mass * unit**body.dimension == pytest.approx(body.volume, rel=self.cad_tolerance)
        assert np.linalg.norm(list(shape.center)) < self.cad_tolerance * body.bounding_radius / unit
        mesh = occ.OCCGeometry(shape, dim=body.dimension).GenerateMesh(maxh=0.5 * body.bounding_radius / unit)
        boundary = mesh.Elements1D() if body.dimension == 2 else mesh.Elements2D()
        used = np.unique(boundary.NumPy()["nodes"][:, : body.dimension]) - 1
        distance = body.signed_distance(unit * mesh.Coordinates()[used])
        np.testing.assert_allclose(distance, 0.0, rtol=0, atol=1e-6 * body.bounding_radius)

    def test_facets_are_the_same_shape(self, body: Body) -> None:
        """They are closed, in one frame with the distances, and enclose the exact volume with normals outwards."""
        if body.facets is None:
            return
        points, vertices = body.facets.points, body.facets.vertices
        moments = facet_moments(body.facets)
        areas = area_vectors(points, vertices)
        assert np.abs(areas.sum(axis=0)).max() < self.tolerance * np.abs(areas).sum()
        assert moments.volume == pytest.approx(body.volume, rel=self.tolerance)
        assert np.abs(moments.centre).max() < self._length(body)
        largest = np.abs(body.unit_inertia).max()
        np.testing.assert_allclose(unit_inertia(moments.second), body.unit_inertia, atol=self.tolerance * largest)
        assert np.linalg.norm(points, axis=1).max() == pytest.approx(body.bounding_radius, rel=self.tolerance)
        middles = points[vertices].mean(axis=1)
        np.testing.assert_allclose(body.signed_distance(middles), 0.0, rtol=0, atol=self._length(body))
        step = 1e-6 * body.bounding_radius * areas / np.linalg.norm(areas, axis=1, keepdims=True)
        assert np.all(body.signed_distance(middles + step) > 0)
        assert np.all(body.signed_distance(middles - step) < 0)
        assert body.radius is None
        assert body.semi_axes is None

    def _length(self, body: Body) -> float:
        return self.tolerance * body.bounding_radius


def _directions(dimension: int) -> FloatArray:
    vectors = np.random.default_rng(3).normal(size=(60, dimension))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _probes(body: Body) -> FloatArray:
    """Points near, inside and far, on the axes as well."""
    size = body.bounding_radius
    scattered = np.random.default_rng(1).uniform(-1.5 * size, 1.5 * size, (200, body.dimension))
    on_axes = np.concatenate([share * size * np.eye(body.dimension) for share in (-1.2, -0.7, -0.01, 0.3, 0.95, 4.0)])
    return np.concatenate([scattered, on_axes])


def _grid(body: Body) -> tuple[FloatArray, float]:
    """A point in each cell of a box about the body, and the volume of one cell.

    Anywhere in the cell: midpoints would all be on one side of a flat face along an axis.
    """
    samples = body.sample_surface(2000)
    lower, upper = 1.01 * samples.min(axis=0), 1.01 * samples.max(axis=0)
    count = 400 if body.dimension == 2 else 60
    corners = np.stack(np.meshgrid(*[np.arange(count)] * body.dimension, indexing="ij"), axis=-1)
    corners = corners.reshape(-1, body.dimension)
    cell = (upper - lower) / count
    return lower + (corners + np.random.default_rng(2).uniform(size=corners.shape)) * cell, float(np.prod(cell))


def _inside(body: Body) -> FloatArray:
    points, _ = _grid(body)
    return points[body.signed_distance(points) < 0]


def _unit_inertia(points: FloatArray) -> FloatArray:
    square = np.mean(np.sum(points**2, axis=1))
    if points.shape[1] == 2:
        return np.full((1, 1), square)
    return np.asarray(square * np.eye(3) - points.T @ points / len(points))
