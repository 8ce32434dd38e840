"""Contract tests of a domain."""

from __future__ import annotations

from collections.abc import Hashable
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.fill import fill_mesh
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.generation.refine_surface import bisect, edges_of_facets, middles_on_surfaces, one_per_cell
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Mesh, Pose

_PROBES = 400
_STEP = 1e-6
_NUDGE = 1e-3
"""Step of differences, and distance from the boundary that is surely inside or outside, over the domain's size."""


_MADE: dict[tuple[Hashable, float], tuple[Mesh, Mesh]] = {}


class DomainContract:
    """Geometry of the surfaces, and that meshes made from the CAD shape, or the facets, are of the same domain.

    Override the fixture ``domain``; parametrise it to hold several domains to the same standard.
    """

    tolerance: ClassVar[float] = 1e-10
    """Accuracy of points and distances, relative to the size of the domain."""
    smooth_share: ClassVar[float] = 0.95
    """Least share of the points at which the distance to a piece is differentiable [1]."""
    coarse: ClassVar[float] = 0.2
    """Edges of the coarse mesh over the size of the domain; those of the fine one are half as long."""
    volume_tolerance: ClassVar[float] = 0.02
    """Relative error of volume and areas on the refined mesh: facets are up to h²/8R off a curved boundary."""

    @pytest.fixture
    def domain(self) -> Domain:
        """The domain under test."""
        raise NotImplementedError("override the fixture `domain`")

    @pytest.fixture
    def meshes(self, domain: Domain) -> tuple[Mesh, Mesh]:
        """A coarse one and a fine one, made once for all tests of a domain."""
        key = _identity(domain), self.coarse
        if key not in _MADE:
            _MADE[key] = _mesh(domain, self.coarse), _mesh(domain, 0.5 * self.coarse)
        return _MADE[key]

    def test_names_are_names(self, domain: Domain) -> None:
        """Each piece has one of its own, and none is `all`."""
        assert all(isinstance(name, str) and name for name in domain.names)
        assert len(set(domain.names)) == len(domain.names) > 0
        assert "all" not in domain.names

    def test_closest_point_is_signed_distance_away(self, domain: Domain) -> None:
        """|x - closest_point(x)| = |signed_distance(x)|."""
        points = _probes(domain)
        for piece in domain.pieces:
            away = np.linalg.norm(points - piece.shape.closest_point(points), axis=1)
            self._assert_close(away, np.abs(piece.shape.signed_distance(points)), domain)

    def test_closest_point_is_on_the_surface(self, domain: Domain) -> None:
        """signed_distance(closest_point(x)) = 0, and it is its own closest point."""
        for piece in domain.pieces:
            foot = piece.shape.closest_point(_probes(domain))
            self._assert_close(piece.shape.signed_distance(foot), 0.0, domain)
            self._assert_close(piece.shape.closest_point(foot), foot, domain)

    def test_distance_changes_as_fast_as_the_point_moves(self, domain: Domain) -> None:
        """|∇ signed_distance| = 1, but for the few points where several of the surface's are nearest."""
        for piece in domain.pieces:
            slope = np.linalg.norm(_gradient(piece, _probes(domain), _size(domain)), axis=1)
            assert np.all(slope <= 1.0 + 1e-6)
            assert np.mean(np.abs(slope - 1.0) < 1e-6) >= self.smooth_share

    def test_normal_is_the_slope_of_the_distance(self, domain: Domain, meshes: tuple[Mesh, Mesh]) -> None:
        """On the piece itself the normal is ∇ signed_distance, of length 1."""
        for number, piece in enumerate(domain.pieces):
            points = _middles(meshes[0], number)
            slope = _gradient(piece, piece.shape.closest_point(points), _size(domain))
            np.testing.assert_allclose(piece.shape.normal(points), slope, rtol=0, atol=1e-6)

    def test_the_fluid_is_where_normals_point(self, domain: Domain, meshes: tuple[Mesh, Mesh]) -> None:
        """A little way along the normal from a piece is inside, the same way against it outside."""
        for number, piece in enumerate(domain.pieces):
            foot = piece.shape.closest_point(_middles(meshes[1], number))
            step = _NUDGE * _size(domain) * piece.shape.normal(foot)
            assert domain.contains(foot + step).all()
            assert not domain.contains(foot - step).any()

    def test_a_part_between_two_planes_is_the_same_all_along(self, domain: Domain) -> None:
        """A part, if the domain has one, has its names, flat ends at the planes, and its points between them."""
        lower, upper = domain.extent
        for axis in range(len(lower)):
            low, high = lower[axis] + np.array([0.3, 0.6]) * (upper - lower)[axis]
            part, points = domain.between(axis, low, high), _probes(domain)
            if part is None:
                continue
            assert part.names == domain.names
            ends = [p.shape.plane.point[axis] for p in part.pieces if p.shape.plane and p.shape.plane.axis == axis]
            self._assert_close(np.sort(ends), np.array([low, high]), domain)
            between = (points[:, axis] > low) & (points[:, axis] < high)
            np.testing.assert_array_equal(part.contains(points), domain.contains(points) & between)
            assert part.volume / domain.volume == pytest.approx(0.3)

    def test_the_mesh_is_in_the_domain(self, domain: Domain, meshes: tuple[Mesh, Mesh]) -> None:
        """Vertices off the boundary are inside, and the bounding box of the mesh is `extent`."""
        points, boundary = meshes[1].points, np.unique(meshes[1].facets)
        assert domain.contains(np.delete(points, boundary, axis=0)).all()
        lower, upper = domain.extent
        assert np.all(points >= lower - self.tolerance * _size(domain))
        assert np.all(points <= upper + self.tolerance * _size(domain))
        missing = np.concatenate([points.min(axis=0) - lower, upper - points.max(axis=0)])
        assert np.all(missing <= self.coarse**2 * _size(domain))

    def test_facets_lie_on_the_surface_of_their_number(self, domain: Domain, meshes: tuple[Mesh, Mesh]) -> None:
        """Every piece has facets, and their vertices are on it, within the box around it."""
        for mesh in meshes:
            np.testing.assert_array_equal(np.unique(mesh.markers), np.arange(len(domain.pieces)))
            for number, piece in enumerate(domain.pieces):
                points = mesh.points[np.unique(mesh.facets[mesh.markers == number])]
                self._assert_close(piece.shape.signed_distance(points), 0.0, domain)
                lower, upper = piece.shape.bounds
                assert np.all(points >= lower - self.tolerance * _size(domain))
                assert np.all(points <= upper + self.tolerance * _size(domain))

    def test_volume_and_areas_are_those_of_fine_meshes(self, domain: Domain, meshes: tuple[Mesh, Mesh]) -> None:
        """When all edges of the boundary are halved, each new vertex on its surfaces, errors fall, to a quarter of a
        smooth surface's. Netgen's own edges depend on curvature, too, and may not get shorter where they are asked to.
        """
        finer = meshes[1], _halved(meshes[1], domain)
        errors = [_sizes_of(domain, mesh) / _sizes_told(domain) - 1.0 for mesh in finer]
        assert np.all(np.abs(errors[1]) < self.volume_tolerance), errors
        assert np.all(np.abs(errors[1]) <= np.maximum(0.5 * np.abs(errors[0]), self.tolerance)), errors

    def test_closed_forms_are_true(self, domain: Domain, meshes: tuple[Mesh, Mesh]) -> None:
        """A plane's distance is (x - x₀)·n; a round surface has one centre, x - radius · n at each of its points x."""
        points = _probes(domain)
        for number, piece in enumerate(domain.pieces):
            plane, radius = piece.shape.plane, piece.shape.radius
            if plane is not None:
                assert np.linalg.norm(plane.unit_normal) == pytest.approx(1.0, rel=1e-14)
                told = (points - plane.point) @ plane.unit_normal
                self._assert_close(piece.shape.signed_distance(points), told, domain)
                assert radius is not None
                assert np.isinf(radius)
            elif radius is not None:
                foot = piece.shape.closest_point(_middles(meshes[0], number))
                centre = foot - radius * piece.shape.normal(foot)
                np.testing.assert_allclose(centre, centre[:1] + 0.0 * centre, rtol=0, atol=1e-6 * _size(domain))

    def test_coordinates_go_from_0_to_1(self, domain: Domain, meshes: tuple[Mesh, Mesh]) -> None:
        """On each piece that has them, to its very edges."""
        for number, piece in enumerate(domain.pieces):
            if piece.coordinates is not None:
                vertices = meshes[1].points[np.unique(meshes[1].facets[meshes[1].markers == number])]
                inside = piece.coordinates(vertices)
                assert inside.shape == (len(vertices), domain.dimension - 1)
                np.testing.assert_allclose(inside.min(axis=0), 0.0, rtol=0, atol=1e-9)
                np.testing.assert_allclose(inside.max(axis=0), 1.0, rtol=0, atol=1e-9)

    def _assert_close(self, found: FloatArray, expected: FloatArray | float, domain: Domain) -> None:
        np.testing.assert_allclose(found, expected, rtol=0, atol=self.tolerance * _size(domain))


def _size(domain: Domain) -> float:
    return float(domain.size.max())


def _probes(domain: Domain) -> FloatArray:
    """Points (N, d) at random in the domain."""
    lower, upper = domain.extent
    points = np.random.default_rng(0).uniform(lower, upper, (_PROBES, domain.dimension))
    inside = points[domain.contains(points)]
    assert len(inside) > 0
    return inside


def _identity(domain: Domain) -> Hashable:
    """Key by which domains differ: some are made from more than their options."""
    options, extent = domain.options.model_dump_json(), tuple(np.ravel(domain.extent).tolist())
    facets = () if domain.facets is None else (domain.facets.points.tobytes(), domain.facets.vertices.tobytes())
    return type(domain), domain.dimension, options, domain.names, domain.volume, extent, facets


def _mesh(domain: Domain, relative_size: float) -> Mesh:
    size = relative_size * _size(domain)
    if domain.facets is not None:
        return fill_mesh(FluidDomain([], _nobody(domain), domain, []), Sizes(size, size, 0.3))
    return generate_mesh(FluidDomain([], _nobody(domain), domain, ()), Sizes(size, size, 0.3))


def _nobody(domain: Domain) -> Pose:
    return Pose(np.zeros((0, domain.dimension)), np.zeros((0, 1 if domain.dimension == 2 else 4)))


def _halved(mesh: Mesh, domain: Domain) -> Mesh:
    """The mesh with every edge of its boundary cut in two at a point of the exact surface."""
    given = len(mesh.points)
    while True:
        edges, _ = edges_of_facets(mesh, np.ones(len(mesh.facets), dtype=bool))
        edges = edges[(edges < given).all(axis=1)]
        if not len(edges):
            return mesh
        length = np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1)
        edges = edges[one_per_cell(mesh.cells, edges, length, len(mesh.points))]
        mesh = bisect(mesh, edges, middles_on_surfaces(mesh, edges, FluidDomain([], _nobody(domain), domain, ())))


def _middles(mesh: Mesh, piece: int) -> FloatArray:
    """Midpoints of the facets of one piece, (F, d)."""
    return np.asarray(mesh.points[mesh.facets[mesh.markers == piece]].mean(axis=1))


def _gradient(piece: Piece, points: FloatArray, size: float) -> FloatArray:
    steps = _STEP * size * np.eye(points.shape[1])
    distance = piece.shape.signed_distance
    slopes = [distance(points + step) - distance(points - step) for step in steps]
    return np.stack(slopes, axis=1) / (2.0 * _STEP * size)


def _sizes_of(domain: Domain, mesh: Mesh) -> FloatArray:
    """Volume of the mesh, and the area of the facets of each piece, (1 + p,)."""
    corners = mesh.points[mesh.facets]
    edges = corners[:, 1:] - corners[:, :1]
    area = np.sqrt(np.linalg.det(edges @ np.swapaxes(edges, 1, 2))) / (domain.dimension - 1.0)
    areas = np.bincount(mesh.markers, weights=area, minlength=len(domain.pieces))
    return np.append(cell_volumes(mesh.points, mesh.cells).sum(), areas)


def _sizes_told(domain: Domain) -> FloatArray:
    return np.array([domain.volume, *(piece.area for piece in domain.pieces)])
