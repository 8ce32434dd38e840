"""Triangles on a grid of points in a plane: slices of a flow that lie in it, and surfaces that it is looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
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
    """Points of a grid that triangles cover: their ``place`` (P,) in the grid row by row, ``triangle`` (P,), and
    ``weights`` (P, 3) of its corners; ``shape`` of the grid."""

    shape: tuple[int, int]
    place: IntArray
    triangle: IntArray
    weights: FloatArray

    @classmethod
    def locate(cls, corners: FloatArray, grid: Grid) -> Sampling:
        """Find the points that triangles with ``corners`` (T, 3, d) cover, seen at right angles to the plane."""
        where = grid.coordinates(corners)
        near, lowest, counts = _rectangles(where, grid)
        each = counts.prod(axis=1)
        number = np.repeat(np.arange(len(near)), each)
        within = np.arange(len(number)) - (np.cumsum(each) - each)[number]
        row, column = np.divmod(within, counts[number, 0])
        points = lowest[number] + np.stack([column, row], axis=1)
        weights = _barycentric(where[near][number], points)
        inside = weights.min(axis=1) >= -_ROUNDING
        place = points[inside] @ [1, grid.columns]
        return cls((grid.rows, grid.columns), place, near[number[inside]], weights[inside])

    def values(self, values: FloatArray) -> FloatArray:
        """Values (T, 3, …) at the corners as (P, …) at the points, linear between corners."""
        return np.asarray(np.einsum("pk,pk...->p...", self.weights, values[self.triangle]))

    def image(self, values: FloatArray) -> FloatArray:
        """Values (T, 3) at the corners as (rows, columns) at the grid's points, nan where no triangle is."""
        image = np.full(self.shape[0] * self.shape[1], np.nan)
        image[self.place] = self.values(values)
        return image.reshape(self.shape)


def _rectangles(where: FloatArray, grid: Grid) -> tuple[IntArray, IntArray, IntArray]:
    """Which triangles may cover points of the grid, and of each the lowest i and j, and how many of both.

    Triangles seen from the side, without an area, cover none.
    """
    last = np.array([grid.columns - 1, grid.rows - 1])
    lowest = np.maximum(np.ceil(where.min(axis=1) - _ROUNDING), 0).astype(np.int64)
    highest = np.minimum(np.floor(where.max(axis=1) + _ROUNDING), last).astype(np.int64)
    sides = where[:, 1:] - where[:, :1]
    near = (highest >= lowest).all(axis=1) & (np.abs(_cross(sides[:, 0], sides[:, 1])) > _ROUNDING)
    return np.flatnonzero(near), lowest[near], (highest - lowest + 1)[near]


def _barycentric(corners: FloatArray, points: FloatArray) -> FloatArray:
    """Coordinates (P, 3) of ``points`` (P, 2), each in its triangle with ``corners`` (P, 3, 2)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    away, area = points - corners[:, 0], _cross(first, second)
    one, two = _cross(away, second) / area, _cross(first, away) / area
    return np.stack([1.0 - one - two, one, two], axis=1)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
