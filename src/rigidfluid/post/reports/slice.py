"""Tetrahedra cut by a plane into triangles, and their faces into segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import Fields

EIGHTHS = np.array(
    [[0, 4, 6, 7], [4, 1, 5, 8], [6, 5, 2, 9], [7, 8, 9, 3], [4, 9, 5, 6], [4, 9, 6, 7], [4, 9, 7, 8], [4, 9, 8, 5]]
)
"""The nodes of the eight linear tetrahedra that a quadratic one is cut into."""

WHOLE = np.arange(4)[None]
"""A linear tetrahedron as it is."""

_FACES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])

# Of the nodes of a tetrahedron, those above the plane first: between which its triangles have their corners, by how
# many there are above.
_TRIANGLES = {
    1: np.array([[[0, 1], [0, 2], [0, 3]]]),
    2: np.array([[[0, 2], [0, 3], [1, 3]], [[0, 2], [1, 3], [1, 2]]]),
    3: np.array([[[0, 3], [1, 3], [2, 3]]]),
}


@dataclass(frozen=True)
class Slice:
    """The triangles that a plane cuts out of cells.

    ``cell`` (T,) that a triangle is in; ``ends`` (T, 3, 2) the two nodes of the cell, by their numbers in it, that each
    corner lies between; ``share`` (T, 3) how far it is from the first to the second.
    """

    cell: IntArray
    ends: IntArray
    share: FloatArray

    @classmethod
    def cut(cls, height: FloatArray, pieces: IntArray) -> Slice:
        """Cut cells whose nodes have ``height`` (M, b) over the plane, each in ``pieces`` (k, 4) between its nodes."""
        parts = height[:, pieces].reshape(-1, 4)
        number, corners, share = [], [], []
        for above, triangles in _TRIANGLES.items():
            chosen = np.flatnonzero((parts >= 0.0).sum(axis=1) == above)
            order = np.argsort(parts[chosen] < 0.0, axis=1, kind="stable")
            ends = order[:, triangles].reshape(-1, 3, 2)
            part = np.repeat(chosen, len(triangles))
            at_ends = parts[part[:, None, None], ends]
            number.append(part)
            corners.append(pieces[(part % len(pieces))[:, None, None], ends])
            share.append(at_ends[..., 0] / (at_ends[..., 0] - at_ends[..., 1]))
        return cls(np.concatenate(number) // len(pieces), np.concatenate(corners), np.concatenate(share))

    def values(self, values: FloatArray) -> FloatArray:
        """Values (M, b, …) at the nodes of the cells as (T, 3, …) at the corners of the triangles."""
        first, second = (values[self.cell[:, None], self.ends[..., k]] for k in (0, 1))
        share = self.share.reshape(*self.share.shape, *(1,) * (values.ndim - 2))
        return np.asarray((1.0 - share) * first + share * second)


def cut_cells(fields: Fields, normal: FloatArray, through: FloatArray) -> Fields:
    """The part of the fields in cells that have nodes on both sides of the plane across ``normal`` (3,)."""
    above = ((fields.points - through) @ normal >= 0.0)[fields.cells]
    kept, cells = np.unique(fields.cells[above.any(axis=1) & ~above.all(axis=1)], return_inverse=True)
    cells = cells.reshape(-1, fields.cells.shape[1])
    return fields.part(kept, cells)


def cut_faces(nodes: FloatArray, cells: IntArray, normal: FloatArray, through: FloatArray) -> FloatArray:
    """Segments (S, 2, 3) in which the plane cuts the faces between corners of cells (M, b) of ``nodes`` (N, 3)."""
    faces = np.unique(np.sort(cells[:, _FACES].reshape(-1, 3), axis=1), axis=0)
    height = ((nodes - through) @ normal)[faces]
    above = height >= 0.0
    mixed = above.any(axis=1) & ~above.all(axis=1)
    faces, height, above = faces[mixed], height[mixed], above[mixed]
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    one, two = alone[:, None], (alone[:, None] + [1, 2]) % 3
    h, others = np.take_along_axis(height, one, axis=1), np.take_along_axis(height, two, axis=1)
    share = (h / (h - others))[..., None]
    first = nodes[np.take_along_axis(faces, one, axis=1)]
    return np.asarray((1.0 - share) * first + share * nodes[np.take_along_axis(faces, two, axis=1)])
