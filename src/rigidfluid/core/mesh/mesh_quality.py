"""Signed volume, size and shape quality of simplices, vectorised: called on the whole mesh at every step."""

from __future__ import annotations

from math import factorial, sqrt

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray


def cell_volumes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Signed volume of every simplex, V = det(x_1 - x_0, …, x_d - x_0) / d!, negative for an inverted one, (M,)
    [length^d]."""
    return _signed_volumes(_corners(points, cells))


def cell_quality(points: FloatArray, cells: IntArray) -> FloatArray:
    """Shape quality of every simplex, q = (V / V_d)^(2/d) / mean(l²), (M,): 1 for a regular simplex, 0 for a flat or
    inverted one.

    V_d = √(d+1) / (d! 2^(d/2)) is the volume of the regular simplex of unit edges; the mean goes over all edges. The
    mean-ratio measure of Liu and Joe (1994), DOI 10.1007/BF01955874.
    """
    corners = _corners(points, cells)
    relative = _relative_volumes(corners)
    power = relative if points.shape[1] == 2 else np.cbrt(relative) ** 2
    quality: FloatArray = power / _mean_square_edge(corners)
    return quality


def cell_sizes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Edge of the regular simplex of the same volume, (V / V_d)^(1/d), zero for an inverted one, (M,) [length]."""
    relative = _relative_volumes(_corners(points, cells))
    size: FloatArray = np.sqrt(relative) if points.shape[1] == 2 else np.cbrt(relative)
    return size


def edge_lengths(points: FloatArray, cells: IntArray) -> FloatArray:
    """Length of every edge of every simplex, (M, d(d+1)/2) [length]."""
    first, second = np.triu_indices(cells.shape[1], 1)
    return np.asarray(np.linalg.norm(points[cells[:, second]] - points[cells[:, first]], axis=-1))


def regular_edges(points: FloatArray, cells: IntArray) -> FloatArray:
    """Edge of a regular simplex of the volume of each one, (M,) [length]."""
    d = cells.shape[1] - 1
    regular = np.sqrt(d + 1.0) / (2.0 ** (0.5 * d) * factorial(d))
    return np.asarray((np.abs(cell_volumes(points, cells)) / regular) ** (1.0 / d))


def _corners(points: FloatArray, cells: IntArray) -> FloatArray:
    """Coordinates by corner and component, (d+1, d, M), each a contiguous row."""
    return np.ascontiguousarray(points.T)[:, cells.T].swapaxes(0, 1)


def _signed_volumes(corners: FloatArray) -> FloatArray:
    edges = corners[1:] - corners[0]
    if len(edges) == 2:
        (ax, ay), (bx, by) = edges
        area: FloatArray = 0.5 * (ax * by - ay * bx)
        return area
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = edges
    volume: FloatArray = (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
    return volume


def _relative_volumes(corners: FloatArray) -> FloatArray:
    """max(V, 0) / V_d, the volumes over that of the regular simplex of unit edges."""
    d = len(corners) - 1
    regular = sqrt(d + 1) / (factorial(d) * 2 ** (d / 2))
    return np.maximum(_signed_volumes(corners), 0.0) / regular


def _mean_square_edge(corners: FloatArray) -> FloatArray:
    first, second = np.triu_indices(len(corners), 1)
    total = np.zeros(corners.shape[2])
    for a, b in zip(first, second, strict=True):
        for component in corners[a] - corners[b]:
            total += component * component
    return total / len(first)
