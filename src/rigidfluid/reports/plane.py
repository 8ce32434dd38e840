"""What a picture of a 2D field asks of its mesh and domain: finer triangles, outlines, the narrowest gap of a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.tri import Triangulation
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import BoolArray, Fields, FloatArray, IntArray

OUTLINE = 400
"""Points along the longer side of the grid in which a domain's outline is found."""

QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""The nodes of the four linear triangles that a quadratic one is cut into."""


@dataclass(frozen=True)
class Outline:
    """The boundary's vertices (V,) of a field's mesh, and the number of the closed curve that each lies on (V,)."""

    points: FloatArray
    curve: IntArray

    @classmethod
    def of(cls, fields: Fields) -> Outline:
        """The outline of a triangle mesh."""
        edges = np.sort(fields.cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, count = np.unique(edges, axis=0, return_counts=True)
        vertices, local = np.unique(edges[count == 1], return_inverse=True)
        first, second = local.reshape(-1, 2).T
        links = coo_array((np.ones(len(first)), (first, second)), shape=(len(vertices),) * 2)
        _, curve = connected_components(links, directed=False)
        return cls(fields.points[vertices], curve.astype(np.int64))

    def around(self, centre: FloatArray) -> FloatArray:
        """The vertices (W, 2) of the curve nearest to a body's centre (2,)."""
        return self.points[self._own(centre)]

    def narrowest(self, centre: FloatArray) -> FloatArray:
        """Middle (2,) of the shortest line from the body about ``centre`` (2,) to any other surface."""
        own = self._own(centre)
        found = cKDTree(self.points[~own]).query(self.points[own])
        nearest = int(np.argmin(found[0]))
        other = self.points[~own][np.asarray(found[1])[nearest]]
        return np.asarray(0.5 * (self.points[own][nearest] + other))

    def _own(self, centre: FloatArray) -> BoolArray:
        nearest = int(np.argmin(np.linalg.norm(self.points - centre, axis=1)))
        return np.asarray(self.curve == self.curve[nearest])


def fine_triangles(fields: Fields) -> Triangulation:
    """Every quadratic triangle cut into four linear ones at its nodes."""
    return Triangulation(fields.points[:, 0], fields.points[:, 1], fields.cells[:, QUARTERS].reshape(-1, 3))


def cell_by_cell(fields: Fields) -> Triangulation:
    """The four triangles of each cell, with nodes of its own: node b of cell m has number 6 m + b."""
    x, y = fields.points[fields.cells].reshape(-1, 2).T
    return Triangulation(x, y, np.arange(fields.cells.size).reshape(-1, 6)[:, QUARTERS].reshape(-1, 3))


def corner_triangles(fields: Fields) -> Triangulation:
    """The cells themselves."""
    return Triangulation(fields.points[:, 0], fields.points[:, 1], fields.cells[:, :3])


def distance_grid(domain: Domain) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coordinates (X,), (Y,) of a grid a little larger than the domain, and distances (Y, X), > 0 inside [length]."""
    margin = 2.0 * float(domain.size.max()) / OUTLINE
    lower, upper = (corner + sign * margin for corner, sign in zip(domain.extent, (-1.0, 1.0), strict=True))
    counts = np.maximum(OUTLINE * domain.size / domain.size.max(), OUTLINE / 4).astype(int)
    x, y = (np.linspace(*ends) for ends in zip(lower, upper, counts, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    away = np.min([np.abs(piece.shape.signed_distance(points)) for piece in domain.pieces], axis=0)
    return x, y, np.where(domain.contains(points), away, -away).reshape(len(y), len(x))
