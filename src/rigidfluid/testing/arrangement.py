"""Bodies, walls and a mesh between them, for the tests of detectors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import product

import numpy as np

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.frames import distance_to_body, to_world
from rigidfluid.core.mechanics.rigid import rotate, rotation_matrices
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.domains.box import Box, BoxOptions

ASPECT = 5.0
"""Longest over shortest semi-axis of the slenderest ellipsoids."""

DIVISIONS = 12
"""Points along an edge of a facet where its depth below the surface is measured; the middle is one of them."""

ROOM, SAMPLES = 0.04, 500
"""Upper bound on the least gap of crowded bodies [length], and number of points per surface that measure it."""


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Balls and ellipsoids, walls, and what makes a mesh between them.

    ``semi_axes`` (n, d) of the bodies [length]; their ``pose``; flat ``walls``, numbered as in the mesh.
    """

    semi_axes: FloatArray
    pose: Pose
    walls: tuple[Wall, ...]
    make_mesh: Callable[[], Mesh]

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(self.semi_axes.shape[1])

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The shapes, balls where all semi-axes are equal."""
        return tuple(map(_body, self.semi_axes.tolist()))

    @cached_property
    def mesh(self) -> Mesh:
        """The mesh around the bodies, made when it is first asked for."""
        return self.make_mesh()

    def moved(self, turn: FloatArray, shift: FloatArray, scale: float = 1.0) -> Arrangement:
        """Map bodies, walls and mesh by x → scale · R x + shift, R from the rotation vector ``turn`` (k,) [rad]."""
        rotation = turn_matrix(turn)

        def place(points: FloatArray) -> FloatArray:
            return np.asarray(scale * points @ rotation.T + shift)

        count = len(self.semi_axes)
        pose = Pose(place(self.pose.position), rotate(self.pose.orientation, np.tile(turn, (count, 1))))

        def moved(wall: Wall) -> Wall:
            plane = wall.shape.plane
            assert plane is not None
            return replace(wall, shape=Plane(place(plane.point), rotation @ plane.unit_normal))

        walls = tuple(map(moved, self.walls))
        return Arrangement(
            scale * self.semi_axes, pose, walls, lambda: replace(self.mesh, points=place(self.mesh.points))
        )

    def reversed(self) -> Arrangement:
        """The same with the bodies in reverse order."""
        pose = Pose(self.pose.position[::-1].copy(), self.pose.orientation[::-1].copy())

        def renumbered() -> Mesh:
            return replace(self.mesh, markers=self.renumbered(self.mesh.markers))

        return Arrangement(self.semi_axes[::-1].copy(), pose, self.walls, renumbered)

    def renumbered(self, surfaces: IntArray) -> IntArray:
        """Numbers of surfaces once the bodies are in reverse order; walls keep theirs."""
        count = len(self.semi_axes)
        return np.where(surfaces < count, count - 1 - surfaces, surfaces)

    def distances(self, surfaces: IntArray, points: FloatArray) -> FloatArray:
        """Signed distance (m,) of each of the ``points`` (m, d) to the surface of its number in ``surfaces`` (m,)."""
        rows = zip(surfaces.tolist(), points, strict=True)
        return np.array([self._distance(surface, point[None])[0] for surface, point in rows], dtype=float)

    @cached_property
    def depths(self) -> FloatArray:
        """Depth of the facets of each body below its surface (n,) [length].

        h²/(8R) on a circle of radius R with edges h, h²/(6R) on a sphere with triangles of edges h; measured on the
        mesh, as it depends on where an ellipsoid has its large facets.
        """
        weights = _barycentric(self.dimension)
        depths = np.zeros(len(self.semi_axes))
        for body in range(len(depths)):
            corners = self.mesh.points[self.mesh.facets[self.mesh.markers == body]]
            points = np.einsum("pk,fkd->fpd", weights, corners).reshape(-1, self.dimension)
            depths[body] = -self._distance(body, points).min()
        return depths

    def _distance(self, surface: int, points: FloatArray) -> FloatArray:
        count = len(self.semi_axes)
        if surface < count:
            return distance_to_body(self.pose, surface, self.bodies[surface], points)
        (wall,) = [wall for wall in self.walls if wall.surface == surface]
        return wall.shape.signed_distance(points)


def in_a_box(
    semi_axes: FloatArray,
    pose: Pose,
    corners: tuple[FloatArray, FloatArray],
    faces: Sequence[int],
    sizes: tuple[float, float],
) -> Arrangement:
    """Bodies in a box.

    Parameters
    ----------
    semi_axes : (n, d) array
        Semi-axes of the bodies [length].
    pose : Pose
        Their positions and orientations.
    corners : (d,) array, (d,) array
        Lower and upper corner of the box [length].
    faces : sequence of int
        Which faces are walls: the lower one of axis k is 2k, the upper one 2k + 1.
    sizes : float, float
        Longest edge of the mesh away from the bodies and on them [length].

    Returns
    -------
    Arrangement
        Bodies, walls, and a mesh of the fluid in the box.
    """
    bodies, (lower, upper) = tuple(map(_body, semi_axes.tolist())), corners
    box = Box(BoxOptions(lower=tuple(lower.tolist()), upper=tuple(upper.tolist())), len(lower))
    walls = surfaces_of(box, len(bodies))

    def make_mesh() -> Mesh:
        from rigidfluid.core.mesh.fluid_domain import FluidDomain
        from rigidfluid.core.mesh.generation.meshing import generate_mesh

        return generate_mesh(FluidDomain(bodies, pose, box, walls), Sizes(*sizes, 0.5))

    return Arrangement(semi_axes, pose, tuple(walls[face] for face in faces), make_mesh)


@cache
def balls_apart(dimension: int) -> Arrangement:
    """Four balls of different size in the corner of two walls, most of them within 0.5 of another."""
    centres = np.array([[0.62, 0.51, 0.5], [1.45, 0.63, 0.55], [1.1, 1.35, 0.45], [2.9, 2.7, 0.5]])
    return _balls([0.4, 0.3, 0.35, 0.25], centres, [0, 2], dimension)


@cache
def ball_pair(dimension: int) -> Arrangement:
    """Two balls away from the walls."""
    return _balls([0.4, 0.3], np.array([[0.7, 0.6, 0.5], [1.3, 1.1, 0.8]]), [], dimension)


@cache
def single_ball(dimension: int) -> Arrangement:
    """One ball and no wall."""
    return _balls([0.4], np.array([[1.0, 1.0, 0.5]]), [], dimension)


def balls_overlapping(dimension: int) -> Arrangement:
    """Two overlapping balls, one of them sunk into a wall; there is no mesh between them."""
    return _balls([0.4, 0.3], np.array([[1.0, 0.35, 0.1], [1.5, 0.75, 0.2]]), [2], dimension)


@cache
def random_ellipsoids(dimension: int, seed: int) -> Arrangement:
    """Ellipsoids of aspect ratio up to 5 and one ball at random tilts, crowded in a box of walls without overlap."""
    rng = np.random.default_rng(seed)
    sides, sizes = ((3, 3), (0.3, 0.02)) if dimension == 2 else ((2, 2, 1), (0.4, 0.2))
    cells = np.array(list(product(*map(range, sides))), dtype=float)
    count = len(cells)
    semi_axes = np.repeat(rng.uniform(0.3, 0.45, (count, 1)), dimension, axis=1)
    semi_axes[:, 1:] /= rng.uniform(1.0, ASPECT, (count, dimension - 1))
    semi_axes[0, 1] = semi_axes[0, 0] / ASPECT
    semi_axes[-1] = 0.3
    turns = rng.normal(size=(count, 1 if dimension == 2 else 4))
    orientation = turns if dimension == 2 else turns / np.linalg.norm(turns, axis=1, keepdims=True)
    places, corner = cells + 0.5 + rng.uniform(-0.04, 0.04, cells.shape), np.array(sides, dtype=float)
    shrink = _shrunk(semi_axes, Pose(places, orientation), corner)
    corners = np.zeros(dimension), shrink * corner
    return in_a_box(semi_axes, Pose(shrink * places, orientation), corners, range(2 * dimension), sizes)


def turn_matrix(turn: FloatArray) -> FloatArray:
    """The rotation matrix of a rotation vector (k,) [rad]."""
    upright = np.zeros((1, 1)) if len(turn) == 1 else np.eye(1, 4)
    return np.asarray(rotation_matrices(rotate(upright, turn[None]))[0])


def _balls(radii: list[float], centres: FloatArray, faces: list[int], dimension: int) -> Arrangement:
    """Balls in a box from (0, 0, -1) to (4, 4, 2)."""
    semi_axes = np.tile(np.array(radii)[:, None], dimension)
    upright = np.zeros((1, 1)) if dimension == 2 else np.eye(1, 4)
    pose = Pose(centres[:, :dimension], np.tile(upright, (len(radii), 1)))
    corners = np.array([0.0, 0.0, -1.0])[:dimension], np.array([4.0, 4.0, 2.0])[:dimension]
    return in_a_box(semi_axes, pose, corners, faces, (0.5, 0.02 if dimension == 2 else 0.1))


def _shrunk(semi_axes: FloatArray, pose: Pose, corner: FloatArray) -> float:
    """Factor on positions and box, lowered from 1 until disjoint bodies and walls have a gap of `ROOM` at most."""
    bodies = [_body(row) for row in semi_axes.tolist()]
    shrink = 1.0
    while _least_gap(bodies, replace(pose, position=shrink * pose.position), shrink * corner) > ROOM:
        shrink -= 0.01
    return shrink


def _least_gap(bodies: Sequence[Body], pose: Pose, corner: FloatArray) -> float:
    """Least distance of sampled surface points from bodies of lower number and from the faces of the box [length]."""
    least = np.inf
    for body, shape in enumerate(bodies):
        surface = to_world(pose, body, shape.sample_surface(SAMPLES))
        away = [np.minimum(surface, corner - surface)]
        away += [distance_to_body(pose, other, bodies[other], surface) for other in range(body)]
        least = min(least, *(float(distance.min()) for distance in away))
    return least


def _body(semi_axes: list[float]) -> Body:
    if len(set(semi_axes)) == 1:
        return Sphere(SphereOptions(radius=semi_axes[0]), len(semi_axes))
    return Ellipsoid(EllipsoidOptions(semi_axes=tuple(semi_axes)), len(semi_axes))


def _barycentric(corners: int) -> FloatArray:
    """Weights (p, corners) of points spread over a simplex, edges and middle included."""
    rows = [row for row in product(range(DIVISIONS + 1), repeat=corners) if sum(row) == DIVISIONS]
    return np.array(rows) / DIVISIONS
