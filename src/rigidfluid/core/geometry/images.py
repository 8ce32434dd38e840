"""Points of a periodic mesh that are the same but for periods."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.errors import MeshError

_APART = 1e-9
"""A point and its image may be so much nearer or farther than a period, over the size of the domain."""


def originals(
    points: FloatArray, pairs: Sequence[tuple[IntArray, IntArray]], ways: FloatArray
) -> tuple[IntArray, IntArray]:
    """The one of ``points`` (N, d) that each is an image of, (N,), and by how many periods, (N, k); itself if it is no
    image.

    Each of the k ``pairs`` has the numbers of points on two periodic surfaces, the second of which is the first
    displaced by a way of ``ways`` (k, d) [length]. Images may have images, as pairs meet. Raises MeshError if the
    points of a pair do not match.
    """
    start, end = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    allowed = _APART * float(np.ptp(points, axis=0).max())
    for (first, second), way in zip(pairs, ways, strict=True):
        start.append(first[_places(points[first] + way, points[second], allowed)])
        end.append(second)
    size = len(points), len(points)
    row, column = np.concatenate(start), np.concatenate(end)
    graph = scipy.sparse.csr_array((np.ones(len(row)), (row, column)), shape=size)
    _, group = scipy.sparse.csgraph.connected_components(graph, directed=False)
    lowest = np.unique(group, return_index=True)[1]
    original = lowest[group].astype(np.int64)
    return original, periods(points - points[original], ways)


def periods(displacement: FloatArray, ways: FloatArray) -> IntArray:
    """Displacements (N, d) as the nearest whole numbers of ``ways`` (k, d), (N, k)."""
    return np.rint(displacement @ np.linalg.pinv(ways)).astype(np.int64)


def _places(images: FloatArray, points: FloatArray, allowed: float) -> IntArray:
    """The place of each of ``points`` (N, d) among as many ``images`` (N, d)."""
    if len(images) != len(points):
        found = f"{len(images)} and {len(points)} points on two periodic surfaces"
        raise MeshError("mesh", found, "the same facets on both", "Let the mesh be made for periodic surfaces.")
    if not len(points):
        return np.empty(0, dtype=np.int64)
    distance, place = scipy.spatial.cKDTree(images).query(points)
    farthest = float(np.max(distance))
    if farthest > allowed:
        found = f"points on two periodic surfaces that are up to {farthest:.3g} off each other's images"
        raise MeshError("mesh", found, "the same facets on both", "Let the mesh be made for periodic surfaces.")
    return np.asarray(place)
