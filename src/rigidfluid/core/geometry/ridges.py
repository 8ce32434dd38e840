"""Ridges that facets share with their neighbours: corners of edges in the plane, edges of triangles in space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import IntArray


class Ridges(NamedTuple):
    """``corners`` (R, d-1) of all ridges, ascending; how many facets there are at each, ``facets_at`` (R,), and the sum
    ``turn`` (R,) of the senses in which these go along it.

    ``number`` (F, d) of the ridges of each facet, and the ``sense`` (F, d), 1 or -1, different for two neighbours that
    are turned alike. A surface is closed and turned alike where each ridge has two facets and turn 0.
    """

    corners: IntArray
    facets_at: IntArray
    turn: IntArray
    number: IntArray
    sense: IntArray


def ridges_of(vertices: IntArray) -> Ridges:
    """The ridges of facets ``vertices`` (F, d)."""
    count, d = vertices.shape
    if d == 2:
        ends, sense = vertices[:, :, None], np.tile([-1, 1], (count, 1))
    else:
        ahead = np.stack([vertices, np.roll(vertices, -1, axis=1)], axis=2)
        ends, sense = np.sort(ahead, axis=2), np.where(ahead[:, :, 0] < ahead[:, :, 1], 1, -1)
    corners, number = np.unique(ends.reshape(count * d, -1), axis=0, return_inverse=True)
    number = number.reshape(count, d)
    turn = np.zeros(len(corners), dtype=np.int64)
    np.add.at(turn, number, sense)
    return Ridges(corners, np.bincount(number.ravel(), minlength=len(corners)), turn, number, sense)
