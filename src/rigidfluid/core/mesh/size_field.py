"""The cell size wanted at a point: fine near bodies, finer still inside a narrow gap, coarse elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import FloatArray, Pose
from rigidfluid.core.model.wall import Wall


@dataclass(frozen=True, slots=True)
class Sizes:
    """What decides the cell size.

    Parameters
    ----------
    size, size_body : float
        Edge length far from the bodies, and on a body [length].
    growth : float
        Growth of the size with the distance to a body [1].
    cells_per_gap : float
        How many cells lie across a gap.
    refinements : int
        How often size_body may be halved for that.
    order : int
        Of the cells at bodies and curved walls: 1 straight, 2 curved.
    """

    size: float
    size_body: float
    growth: float = 0.2
    cells_per_gap: float = 2.0
    refinements: int = 6
    order: int = 2

    @property
    def smallest(self) -> float:
        """Cells are never wanted smaller than size_body / 2^refinements [length]."""
        return self.size_body / 2.0**self.refinements


def wanted_size(
    points: FloatArray, bodies: Sequence[Body], pose: Pose, walls: Sequence[Wall], sizes: Sizes
) -> FloatArray:
    """Cell size at points, h = max(h_min, min(size, size_body + growth·d₁, (d₁ + d₂)/cells_per_gap)).

    d₁ is the distance to the nearest body, d₂ that to the next body or the nearest wall, so that d₁ + d₂ equals the gap
    on the segment that joins two surfaces and is larger off it. Two walls make no gap.

    Parameters
    ----------
    points : (N, d) array
        Where the size is wanted [length].
    bodies : sequence of Body
        The shapes.
    pose : Pose
        Where they are.
    walls : sequence of Wall
        The walls whose gaps are resolved.
    sizes : Sizes
        The numbers of the formula.

    Returns
    -------
    (N,) array
        Wanted edge length [length].
    """
    reach = max((sizes.size - sizes.size_body) / sizes.growth, sizes.cells_per_gap * sizes.size)
    first, second = two_nearest_bodies(points, bodies, pose, reach)
    gap = first + np.minimum(second, nearest_wall(points, walls))
    wanted = np.minimum(sizes.size_body + sizes.growth * first, gap / sizes.cells_per_gap)
    return np.clip(wanted, sizes.smallest, sizes.size)


def two_nearest_bodies(
    points: FloatArray, bodies: Sequence[Body], pose: Pose, reach: float
) -> tuple[FloatArray, FloatArray]:
    """Distances to the nearest and to the second nearest body, each (N,), infinite where beyond ``reach`` [length]."""
    first, second = np.full((2, len(points)), np.inf)
    for i, body in enumerate(bodies):
        from_centre = np.linalg.norm(points - pose.position[i], axis=1)
        near = np.flatnonzero(from_centre - body.bounding_radius < np.minimum(reach, second))
        distance = np.maximum(distance_to_body(pose, i, body, points[near]), 0.0)
        second[near] = np.minimum(second[near], np.maximum(first[near], distance))
        first[near] = np.minimum(first[near], distance)
    return first, second


def nearest_wall(points: FloatArray, walls: Sequence[Wall]) -> FloatArray:
    """Distance to the nearest wall, (N,), infinite without walls [length]."""
    distance = np.full(len(points), np.inf)
    for wall in walls:
        np.minimum(distance, np.maximum(wall.shape.signed_distance(points), 0.0), out=distance)
    return distance
