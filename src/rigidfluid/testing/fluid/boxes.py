"""Meshes of the unit box, empty or around two balls, how they move, and integrals over them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import permutations, product
from math import factorial

import numpy as np
from scipy.special import roots_jacobi

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mesh.topology import boundary_facets, orient
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.testing.arrangement import in_a_box

CENTRES, RADII = np.array([[0.3, 0.35, 0.5], [0.68, 0.62, 0.45]]), (0.12, 0.1)
"""The two balls [length]."""

_MARGIN = 0.12
"""How far around a ball the mesh moves with it [length]: less than half the gap and less than the way to a face."""


@cache
def box(dimension: int, divisions: int) -> Mesh:
    """The unit box, each of its ``divisions`` ** d cubes in d! simplices along its diagonal (Kuhn 1960)."""
    shape = (divisions + 1,) * dimension
    points = np.array(list(product(np.linspace(0.0, 1.0, divisions + 1), repeat=dimension)))
    corner = np.array(list(product(range(divisions), repeat=dimension)))
    cells = np.concatenate([_path(corner, axes, shape) for axes in permutations(range(dimension))])
    return orient(_marked(points, cells))


@cache
def box_with_balls(dimension: int) -> Mesh:
    """The unit box around the two balls."""
    return _around(balls_pose(dimension), 1.0)


def finer_box_with_balls(dimension: int, shift: FloatArray) -> Mesh:
    """Other, smaller cells around the two balls, displaced by ``shift`` (2, d), with smaller facets on them."""
    start = balls_pose(dimension)
    return _around(replace(start, position=start.position + shift), 0.7)


def balls_pose(dimension: int) -> Pose:
    """Positions and orientations of the balls of `box_with_balls`."""
    return Pose(CENTRES[:, :dimension].copy(), np.tile(np.eye(1, 1 if dimension == 2 else 4), (2, 1)))


def nobody(dimension: int) -> Pose:
    """The pose of no body at all."""
    return Pose(np.zeros((0, dimension)), np.zeros((0, 1 if dimension == 2 else 4)))


def swayed(points: FloatArray, shift: FloatArray) -> FloatArray:
    """The ``points`` (N, d) of an empty box, its inside displaced by up to ``shift`` (d,)."""
    return np.asarray(points + np.prod(np.sin(np.pi * points), axis=1)[:, None] * shift)


def swayed_across(points: FloatArray, shift: FloatArray) -> FloatArray:
    """The ``points`` (N, d) of an empty box, displaced by up to ``shift`` (d,), but not along the first axis.

    It is the same all along that axis, so that points on the faces across it slide in them.
    """
    moved = points.copy()
    moved[:, 1:] += np.prod(np.sin(np.pi * points[:, 1:]), axis=1)[:, None] * shift[1:]
    return moved


def carried(points: FloatArray, shift: FloatArray) -> FloatArray:
    """The ``points`` (N, d) of a box with the two balls, these displaced by ``shift`` (2, d)."""
    return np.asarray(points + sum(_near(points, ball)[:, None] * shift[ball] for ball in range(2)))


def stirred(points: FloatArray, shift: FloatArray) -> FloatArray:
    """The ``points`` (N, d) of a box with the two balls, displaced by up to ``shift`` (d,) between balls and faces."""
    between = sum(4.0 * _near(points, ball) * (1.0 - _near(points, ball)) for ball in range(2))
    return np.asarray(points + np.asarray(between)[:, None] * shift)


def renumbered(mesh: Mesh, seed: int = 0) -> Mesh:
    """The same mesh with its vertices, cells and facets in another order."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(mesh.points))
    number = np.argsort(order)
    facets = rng.permutation(len(mesh.facets))
    cells = number[mesh.cells[rng.permutation(len(mesh.cells))]]
    return Mesh(mesh.points[order], cells, number[mesh.facets[facets]], mesh.markers[facets])


def copied(mesh: Mesh) -> Mesh:
    """The same mesh in arrays of its own."""
    return replace(
        mesh,
        points=mesh.points.copy(),
        cells=mesh.cells.copy(),
        facets=mesh.facets.copy(),
        markers=mesh.markers.copy(),
    )


def ball_moments(mesh: Mesh, ball: int) -> tuple[float, FloatArray]:
    """Volume and centroid (d,) of the polyhedron that a ball's facets enclose [length^d], [length]."""
    apex = CENTRES[ball, : mesh.points.shape[1]]
    corners = mesh.points[mesh.facets[mesh.markers == ball]]
    volumes = np.abs(np.linalg.det(corners - apex)) / factorial(len(apex))
    centroids = (corners.sum(axis=1) + apex) / (1 + len(apex))
    return float(volumes.sum()), np.asarray(volumes @ centroids / volumes.sum())


def on_ball(mesh: Mesh, ball: int) -> FloatArray:
    """Vertices and middles of the facets of a ball, (N, d) [length]."""
    corners = mesh.points[mesh.facets[mesh.markers == ball]]
    return np.concatenate([corners.reshape(-1, mesh.points.shape[1]), corners.mean(axis=1)])


def quadrature(mesh: Mesh, count: int = 3) -> tuple[FloatArray, FloatArray]:
    """Points (Q, d) and weights (Q,) of an integral over the mesh, exact in each cell to degree 2 · ``count`` - 1.

    Gauss–Jacobi points on the collapsed cube (Stroud 1971).
    """
    dimension = mesh.points.shape[1]
    inside, rest, weight = np.zeros((1, 0)), np.ones(1), np.ones(1)
    for power in reversed(range(dimension)):
        root, share = roots_jacobi(count, power, 0.0)
        along, share = (1.0 + root) / 2.0, share / 2.0 ** (power + 1)
        inside = np.column_stack([np.repeat(inside, count, axis=0), np.outer(rest, along).ravel()])
        rest, weight = np.outer(rest, 1.0 - along).ravel(), np.outer(weight, share).ravel()
    corners = mesh.points[mesh.cells]
    edges = corners[:, 1:] - corners[:, :1]
    points = corners[:, :1] + np.einsum("qk,mkd->mqd", inside, edges)
    return points.reshape(-1, dimension), np.outer(np.abs(np.linalg.det(edges)), weight).ravel()


def samples(dimension: int, count: int = 40) -> FloatArray:
    """Points (N, d) at random in the unit box."""
    return np.random.default_rng(0).uniform(0.02, 0.98, (count, dimension))


def _around(pose: Pose, scale: float) -> Mesh:
    dimension = pose.position.shape[1]
    semi_axes = np.tile(np.array(RADII)[:, None], dimension)
    away, on_ball = (0.15, 0.06) if dimension == 2 else (0.3, 0.1)
    corners = np.zeros(dimension), np.ones(dimension)
    return in_a_box(semi_axes, pose, corners, range(2 * dimension), (scale * away, scale * on_ball)).mesh


def _path(corner: IntArray, axes: tuple[int, ...], shape: tuple[int, ...]) -> IntArray:
    """The simplices (M, d+1) that go from the low to the high corner of each cube, one axis after the other."""
    steps = np.cumsum(np.eye(len(axes), dtype=np.int64)[list(axes)], axis=0)
    vertices = [corner, *(corner + step for step in steps)]
    return np.stack([np.ravel_multi_index(tuple(vertex.T), shape) for vertex in vertices], axis=1)


def _marked(points: FloatArray, cells: IntArray) -> Mesh:
    """A mesh of the unit box whose facets carry the number of the face that they lie on."""
    facets = boundary_facets(cells)
    middle = points[facets].mean(axis=1)
    distance = np.stack([middle, 1.0 - middle], axis=2).reshape(len(facets), 2 * points.shape[1])
    return Mesh(points, cells, facets, np.argmin(distance, axis=1))


def _near(points: FloatArray, ball: int) -> FloatArray:
    """1 on the ball, 0 beyond a margin around it, smooth between, (N,)."""
    apart = np.linalg.norm(points - CENTRES[ball, : points.shape[1]], axis=1) - RADII[ball]
    return np.asarray(np.cos(0.5 * np.pi * np.clip(apart / _MARGIN, 0.0, 1.0)) ** 2)
