"""Which way two convex bodies face each other, by GJK and, where they overlap, EPA.

Chosen by trying tolerances from 1e-4 to 1e-14 on ellipsoids of size 1 with gaps from 1 to -1: at 1e-6 every gap is
right to 5e-5, and no query fails if EPA may take 256 steps. Tighter tolerances make EPA fail (it returns the largest
negative number), and looser ones lose small gaps. At any tolerance the normal is arbitrary where the gap is below it.
So the normal of bodies that nearly touch comes from smaller copies of them, which do not; what GJK leaves open is
removed by `rigidfluid_coal.refinement`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid.api import FloatArray, IntArray
from rigidfluid_coal.shapes import in_space

TOLERANCE = 1e-6
"""Of GJK and EPA, relative to the largest body."""
NEARLY_TOUCHING = 1e-3
"""Gap below which the normal is taken from smaller copies, relative to the largest body."""
SMALLER = 0.9
"""Size of those copies."""


class NarrowPhase:
    """Normals of pairs of ellipsoids.

    Parameters
    ----------
    semi_axes : (n, d) array
        Of each body [length].
    """

    def __init__(self, semi_axes: FloatArray) -> None:
        import coal

        self._coal = coal
        # coal's tolerances are lengths, so lengths are made to be about 1
        self._size = float(semi_axes.max())
        spatial = [in_space(axes) / self._size for axes in semi_axes]
        self._shapes = [coal.Ellipsoid(*axes) for axes in spatial]
        self._smaller = [coal.Ellipsoid(*(SMALLER * axes)) for axes in spatial]
        self._request = coal.DistanceRequest()
        self._request.gjk_tolerance = self._request.epa_tolerance = TOLERANCE
        self._request.gjk_max_iterations, self._request.epa_max_iterations = 500, 256

    def normals(self, body_a: IntArray, body_b: IntArray, position: FloatArray, rotation: FloatArray) -> FloatArray:
        """Unit normals from b to a.

        Parameters
        ----------
        body_a, body_b : (m,) arrays
            Pairs of bodies.
        position : (n, d) array
            Centres [length].
        rotation : (n, d, d) array
            From each body's frame to the lab's [1].

        Returns
        -------
        (m, d) array
            Normals, accurate to the square root of `TOLERANCE` [1].
        """
        turned = _in_space(rotation)
        offsets = np.zeros((len(body_a), 3))
        offsets[:, : position.shape[1]] = (position[body_a] - position[body_b]) / self._size
        rows = zip(body_a, body_b, offsets, strict=True)
        found = [self._normal(a, b, turned[a], turned[b], offset) for a, b, offset in rows]
        return _flattened(np.array(found, dtype=float).reshape(-1, 3), position.shape[1])

    def _normal(self, a: int, b: int, rotation_a: FloatArray, rotation_b: FloatArray, offset: FloatArray) -> FloatArray:
        place_a = self._coal.Transform3s(rotation_a, offset)
        place_b = self._coal.Transform3s(rotation_b, np.zeros(3))
        gap, normal = self._distance(self._shapes[a], place_a, self._shapes[b], place_b)
        if abs(gap) < NEARLY_TOUCHING:
            _, normal = self._distance(self._smaller[a], place_a, self._smaller[b], place_b)
        return normal

    def _distance(self, shape_a: Any, place_a: Any, shape_b: Any, place_b: Any) -> tuple[float, FloatArray]:
        result = self._coal.DistanceResult()
        gap = self._coal.distance(shape_a, place_a, shape_b, place_b, self._request, result)
        return gap, -result.normal


def _in_space(rotation: FloatArray) -> FloatArray:
    """Turns in the plane (n, 2, 2) as turns about z (n, 3, 3); those in space as they are."""
    d = rotation.shape[1]
    turned = np.tile(np.eye(3), (len(rotation), 1, 1))
    turned[:, :d, :d] = rotation
    return turned


def _flattened(normal: FloatArray, dimension: int) -> FloatArray:
    """The first components (m, d), of length 1 again."""
    flat = normal[:, :dimension]
    return np.asarray(flat / np.linalg.norm(flat, axis=1, keepdims=True))
