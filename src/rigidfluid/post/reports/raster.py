"""Fields on a grid of points in a plane, in 2D the plane itself, in 3D a slice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.model.types import Fields, FloatArray, IntArray
from rigidfluid.post.reports.flow import basis, node_coordinates
from rigidfluid.post.reports.plane import QUARTERS
from rigidfluid.post.reports.slice import EIGHTHS
from rigidfluid.post.reports.view_plane import ViewPlane

_ROUNDING = 1e-9
"""Least barycentric coordinate, taken negative, of a point inside: rounding on a side."""


@dataclass(frozen=True)
class Grid:
    """Points origin + i·right + j·up, i < ``columns``, j < ``rows``.

    ``origin``, ``right``, ``up`` : (d,), the last two at right angles [length].
    """

    origin: FloatArray
    right: FloatArray
    up: FloatArray
    columns: int
    rows: int

    @classmethod
    def between(cls, lower: FloatArray, upper: FloatArray, longer: int) -> Grid:
        """Square cells' middles between two corners (2,) of the plane, ``longer`` of them along the longer side."""
        size = upper - lower
        columns, rows = np.maximum(np.round(longer * size / size.max()), 2).astype(int)
        right, up = np.diag(size / (columns, rows))
        return cls(lower + 0.5 * (right + up), right, up, int(columns), int(rows))

    def lifted(self, plane: ViewPlane, through: FloatArray) -> Grid:
        """This grid of the plane's own coordinates as points of the plane through a point ``through`` (d,)."""
        right, up = self.right[0] * plane.right, self.up[1] * plane.up
        return Grid(plane.lifted(self.origin, through), right, up, self.columns, self.rows)

    @property
    def plane(self) -> ViewPlane:
        """The directions of the rows and columns."""
        return ViewPlane(self.right / np.linalg.norm(self.right), self.up / np.linalg.norm(self.up))

    def points(self, columns: slice | None = None, rows: slice | None = None) -> FloatArray:
        """The points, or a part of them, (rows, columns, d)."""
        i = np.arange(self.columns)[columns or slice(None)]
        j = np.arange(self.rows)[rows or slice(None)]
        return np.asarray(self.origin + i[None, :, None] * self.right + j[:, None, None] * self.up)

    def about(self, centre: FloatArray, radius: float) -> tuple[slice, slice] | None:
        """Columns and rows of the square that a ball about ``centre`` (d,) covers; None outside the grid."""
        middle = self.coordinates(centre)
        reach = radius / np.array([np.linalg.norm(self.right), np.linalg.norm(self.up)])
        first = np.maximum(np.floor(middle - reach).astype(int), 0)
        last = np.minimum(np.ceil(middle + reach).astype(int), (self.columns - 1, self.rows - 1)) + 1
        if np.any(last <= first):
            return None
        return slice(int(first[0]), int(last[0])), slice(int(first[1]), int(last[1]))

    def coordinates(self, points: FloatArray) -> FloatArray:
        """i and j of the feet of ``points`` (…, d) in the plane, (…, 2)."""
        axes = np.stack([self.right / (self.right @ self.right), self.up / (self.up @ self.up)])
        return np.asarray((points - self.origin) @ axes.T)


@dataclass(frozen=True)
class Sampling:
    """Points of a grid that lie in a mesh: their ``place`` (P,) in the grid row by row, ``cell`` (P,), and
    ``weights`` (P, b) of its nodes; ``shape`` of the grid."""

    shape: tuple[int, int]
    place: IntArray
    cell: IntArray
    weights: FloatArray

    @classmethod
    def locate(cls, fields: Fields, grid: Grid) -> Sampling:
        """Find the points in the cells, each cut into four triangles or eight tetrahedra between its nodes."""
        parts, inner = _parts(fields)
        corners = fields.points[parts]
        near, lowest, counts = _rectangles(corners, grid)
        corners, each = corners[near], counts.prod(axis=1)
        part = np.repeat(np.arange(len(near)), each)
        number = np.arange(len(part)) - (np.cumsum(each) - each)[part]
        i, j = lowest[part].T + np.divmod(number, counts[part, 0])[::-1]
        own = _barycentric(corners, part, grid.origin + i[:, None] * grid.right + j[:, None] * grid.up)
        inside = own.min(axis=1) >= -_ROUNDING
        part, own = near[part[inside]], own[inside]
        coordinates = np.einsum("pk,pkl->pl", own, inner[part % len(inner)])
        place = (j * grid.columns + i)[inside]
        return cls((grid.rows, grid.columns), place, part // len(inner), basis(coordinates))

    def image(self, values: FloatArray) -> FloatArray:
        """Values (M, b) at the nodes of the cells as (rows, columns) at the grid's points, nan outside the mesh."""
        image = np.full(self.shape[0] * self.shape[1], np.nan)
        image[self.place] = np.einsum("pb,pb->p", self.weights, values[self.cell])
        return image.reshape(self.shape)

    def cells(self) -> IntArray:
        """The number of the cell at each point of the grid, (rows, columns), -1 outside the mesh."""
        image = np.full(self.shape[0] * self.shape[1], -1, dtype=np.int64)
        image[self.place] = self.cell
        return image.reshape(self.shape)


def _parts(fields: Fields) -> tuple[IntArray, FloatArray]:
    """Linear simplices, their nodes (k M, d+1), cell by cell; and their corners in a cell's coordinates (k, …, d+1)."""
    parts = QUARTERS if fields.points.shape[1] == 2 else EIGHTHS
    corners = parts.shape[1]
    return fields.cells[:, parts].reshape(-1, corners), node_coordinates(corners)[parts]


def _rectangles(corners: FloatArray, grid: Grid) -> tuple[IntArray, IntArray, IntArray]:
    """Which simplices may hold points of the grid, and of each the lowest i and j, and how many of both."""
    where = grid.coordinates(corners)
    last = np.array([grid.columns - 1, grid.rows - 1])
    lowest = np.maximum(np.ceil(where.min(axis=1) - _ROUNDING), 0).astype(np.int64)
    highest = np.minimum(np.floor(where.max(axis=1) + _ROUNDING), last).astype(np.int64)
    near = (highest >= lowest).all(axis=1)
    if corners.shape[2] == 3:
        height = (corners - grid.origin) @ grid.plane.normal
        near &= (height.min(axis=1) <= 0.0) & (height.max(axis=1) >= 0.0)
    return np.flatnonzero(near), lowest[near], (highest - lowest + 1)[near]


def _barycentric(corners: FloatArray, part: IntArray, points: FloatArray) -> FloatArray:
    """Coordinates (P, d+1) of ``points`` (P, d), each in its ``part`` of the simplices."""
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).swapaxes(1, 2))
    others = np.einsum("pkl,pl->pk", inverse[part], points - corners[part, 0])
    return np.hstack([1.0 - others.sum(axis=1, keepdims=True), others])
