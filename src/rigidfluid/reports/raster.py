"""Fields on a grid of points in a plane, in 2D the plane itself, in 3D a slice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.model.types import Fields, FloatArray, IntArray
from rigidfluid.reports.flow import basis
from rigidfluid.reports.plane import QUARTERS

_ROUNDING = 1e-9
"""By which barycentric coordinates may be negative of a point on a side."""

_MIDDLES = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]])


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

    @property
    def normal(self) -> FloatArray:
        """Unit normal (3,) of the plane, in 3D."""
        across = np.cross(self.right, self.up)
        return np.asarray(across / np.linalg.norm(across))

    def coordinates(self, points: FloatArray) -> FloatArray:
        """i and j of the feet of ``points`` (…, d) in the plane, (…, 2)."""
        axes = np.stack([self.right / (self.right @ self.right), self.up / (self.up @ self.up)])
        return np.asarray((points - self.origin) @ axes.T)


@dataclass(frozen=True)
class Sampling:
    """Which points of a grid lie in a mesh: their ``place`` (P,) in the grid row by row, ``cell`` (P,), and
    ``weights`` (P, b) of its nodes; ``shape`` of the grid."""

    shape: tuple[int, int]
    place: IntArray
    cell: IntArray
    weights: FloatArray

    @classmethod
    def of(cls, fields: Fields, grid: Grid) -> Sampling:
        """Find the points in the cells; of curved cells in 2D in four triangles each, whose corners are the nodes."""
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
    if fields.points.shape[1] == 3:
        return fields.cells[:, :4], np.eye(4)[None]
    return fields.cells[:, QUARTERS].reshape(-1, 3), _MIDDLES[QUARTERS]


def _rectangles(corners: FloatArray, grid: Grid) -> tuple[IntArray, IntArray, IntArray]:
    """Which simplices may hold points of the grid, and of each the lowest i and j, and how many of both."""
    where = grid.coordinates(corners)
    last = np.array([grid.columns - 1, grid.rows - 1])
    lowest = np.maximum(np.ceil(where.min(axis=1) - _ROUNDING), 0).astype(np.int64)
    highest = np.minimum(np.floor(where.max(axis=1) + _ROUNDING), last).astype(np.int64)
    near = (highest >= lowest).all(axis=1)
    if corners.shape[2] == 3:
        height = (corners - grid.origin) @ grid.normal
        near &= (height.min(axis=1) <= 0.0) & (height.max(axis=1) >= 0.0)
    return np.flatnonzero(near), lowest[near], (highest - lowest + 1)[near]


def _barycentric(corners: FloatArray, part: IntArray, points: FloatArray) -> FloatArray:
    """Coordinates (P, d+1) of ``points`` (P, d), each in its ``part`` of the simplices."""
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).swapaxes(1, 2))
    others = np.einsum("pkl,pl->pk", inverse[part], points - corners[part, 0])
    return np.hstack([1.0 - others.sum(axis=1, keepdims=True), others])
