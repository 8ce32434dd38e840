"""Simplices cut by parallel planes into pieces, and a quadrature rule for these."""

from __future__ import annotations

from functools import cache
from itertools import combinations_with_replacement
from math import factorial
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray

_SLACK = 1e-9
"""Height over the distance of planes up to which a corner counts as on a plane [1]."""


class Pieces(NamedTuple):
    """Pieces of cells: the ``cell`` (P,) of each, the barycentric coordinates there of its ``corners`` (P, d+1, d+1),
    and their ``height`` (P, d+1) over the first plane, in distances of planes [1]."""

    cell: IntArray
    corners: FloatArray
    height: FloatArray

    def select(self, chosen: BoolArray) -> Pieces:
        """The pieces that are ``chosen`` (P,)."""
        return Pieces(self.cell[chosen], self.corners[chosen], self.height[chosen])

    def with_corner(self, row: IntArray, corner: FloatArray, height: FloatArray) -> Pieces:
        """Pieces whose corner number ``row`` (P,) is moved to ``corner`` (P, d+1) at a ``height`` (P,)."""
        corners, heights, every = self.corners.copy(), self.height.copy(), np.arange(len(row))
        corners[every, row], heights[every, row] = corner, height
        return Pieces(self.cell, corners, heights)

    @property
    def share(self) -> FloatArray:
        """Volume over that of the cell (P,) [1]."""
        return np.asarray(np.abs(np.linalg.det(self.corners)))


def cut_by_layers(height: FloatArray) -> Pieces:
    """Pieces of M cells whose corners have a ``height`` (M, d+1) in distances of planes, each between two planes.

    A piece across the first plane above its lowest corner is cut in two where that plane meets the edge from this
    corner to the highest one, until none is; each cut takes a corner from one side of the plane.
    """
    count, corners = height.shape
    rest = Pieces(np.arange(count), np.tile(np.eye(corners), (count, 1, 1)), height)
    whole = []
    while len(rest.cell):
        plane = np.floor(rest.height.min(axis=1) + _SLACK) + 1.0
        crosses = rest.height.max(axis=1) > plane + _SLACK
        whole.append(rest.select(~crosses))
        rest, plane = rest.select(crosses), plane[crosses]
        low, high, every = rest.height.argmin(axis=1), rest.height.argmax(axis=1), np.arange(len(plane))
        bottom, top = rest.height[every, low], rest.height[every, high]
        share = ((plane - bottom) / (top - bottom))[:, None]
        corner = (1.0 - share) * rest.corners[every, low] + share * rest.corners[every, high]
        parts = [rest.with_corner(row, corner, plane) for row in (low, high)]
        rest = Pieces(*(np.concatenate(values) for values in zip(*parts, strict=True)))
    return Pieces(*(np.concatenate(values) for values in zip(*whole, strict=True)))


@cache
def simplex_rule(count: int) -> tuple[FloatArray, FloatArray]:
    """Barycentric coordinates (q, count) and weights (q,) of sum 1 that integrate polynomials of degree 5 over a
    simplex with so many corners exactly.

    Notes
    -----
    Grundmann & Moeller, SIAM J. Numer. Anal. 15 (1978) 282, doi:10.1137/0715019, with s = 2.
    """
    d, s = count - 1, 2
    points, weights = [], []
    for i in range(s + 1):
        base = 2 * s + 1 + d - 2 * i
        weight = (-1.0) ** i * factorial(d) * base ** (2 * s + 1) / (4.0**s * factorial(i) * factorial(base + i))
        for corners in combinations_with_replacement(range(count), s - i):
            points.append((2.0 * np.bincount(corners, minlength=count) + 1.0) / base)
            weights.append(weight)
    return np.array(points), np.array(weights)
