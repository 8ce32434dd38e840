"""Finds the straight cells that hold given points."""

from __future__ import annotations

from itertools import product

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray

INSIDE = -1e-10
"""Least barycentric coordinate of a point that counts as inside a cell [1]."""

_FEW = (3, 16)
_MANY = 64
_CANDIDATES = (*_FEW, _MANY, 512)

_FARTHEST = 2
"""Largest number of periods along each way in which an image is looked for."""


class CellFinder:
    """The cells (M, d+1) between ``points`` (N, d), sorted by their centres for as many searches as are wanted.

    Targets whose least coordinate is above ``beside`` in the best of `_MANY` cells are looked for in no others.
    """

    def __init__(self, points: FloatArray, cells: IntArray, beside: float = INSIDE) -> None:
        from scipy.spatial import cKDTree

        self._beside = beside

        self._corners = points[cells]
        self._centres = cKDTree(self._corners.mean(axis=1))
        self._inverse = np.linalg.inv(np.moveaxis(self._corners[:, 1:] - self._corners[:, :1], -1, -2))

    def find(self, targets: FloatArray) -> tuple[IntArray, FloatArray]:
        """The cell of each target (N,) and its barycentric coordinates there (N, d+1).

        A target outside the mesh takes the cell that it is least outside of, with its coordinates moved inside.
        """
        cell, coordinates = self._nearest(targets)
        return cell, move_inside(coordinates)

    def periods_ahead(self, targets: FloatArray, ways: FloatArray) -> IntArray:
        """Numbers of the ``ways`` (k, d) from each target to its image in the mesh, (N, k).

        Few cells are tried at all images, before many are at any: most targets are in a cell of one image.
        """
        ahead, depth = np.zeros((len(targets), len(ways)), dtype=np.int64), np.full(len(targets), -np.inf)
        steps = sorted(product(range(-_FARTHEST, _FARTHEST + 1), repeat=len(ways)), key=_length)
        for counts, step in product((_FEW, _CANDIDATES), steps):
            outside = np.flatnonzero(depth < INSIDE)
            found = self._nearest(targets[outside] + np.array(step) @ ways, counts)[1].min(axis=1)
            better = found > depth[outside]
            ahead[outside[better]], depth[outside[better]] = step, found[better]
        return ahead

    def _nearest(self, targets: FloatArray, counts: tuple[int, ...] = _CANDIDATES) -> tuple[IntArray, FloatArray]:
        """The same as `find` with coordinates as they are.

        The cells tried are those with the nearest centres, more of them for the targets that are not found yet.
        """
        corners, cells = self._corners, len(self._corners)
        cell = np.zeros(len(targets), dtype=np.int64)
        coordinates = np.full((len(targets), corners.shape[1]), -np.inf)
        missing = np.arange(len(targets))
        for count in counts:
            _, near = self._centres.query(targets[missing], k=min(count, cells))
            near = near.reshape(len(missing), min(count, cells))
            rest = np.einsum("nkij,nkj->nki", self._inverse[near], targets[missing, None] - corners[near, 0])
            found = np.concatenate([1.0 - rest.sum(axis=-1, keepdims=True), rest], axis=-1)
            best = np.argmax(found.min(axis=2), axis=1)
            rows = np.arange(len(missing))
            cell[missing], coordinates[missing] = near[rows, best], found[rows, best]
            missing = missing[coordinates[missing].min(axis=1) < (INSIDE if count < _MANY else self._beside)]
            if len(missing) == 0:
                break
        return cell, coordinates


def _length(step: tuple[int, ...]) -> int:
    return sum(abs(each) for each in step)


def locate(points: FloatArray, cells: IntArray, targets: FloatArray) -> tuple[IntArray, FloatArray]:
    """One search among cells, as `CellFinder.find`."""
    return CellFinder(points, cells).find(targets)


def move_inside(coordinates: FloatArray) -> FloatArray:
    """Barycentric ``coordinates`` (N, d+1) without negative ones, and of sum 1."""
    inside = np.maximum(coordinates, 0.0)
    return np.asarray(inside / inside.sum(axis=1, keepdims=True))
