"""Triangles of a 2D field's mesh for pictures in a plane, and the domain's distance on a grid in it."""

from __future__ import annotations

import numpy as np
from matplotlib.tri import Triangulation

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Fields
from rigidfluid.post.reports.view_plane import ViewPlane

OUTLINE = 400
"""Points along the longer side of the grid in which a domain's outline is found."""

QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""The nodes of the four linear triangles that a quadratic one is cut into."""


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


def distance_grid(domain: Domain, plane: ViewPlane, through: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coordinates (X,), (Y,) of a grid a little larger than the domain, in the ``plane`` through a point (d,), and
    distances (Y, X), > 0 inside [length]."""
    lower, upper = plane.extent(*domain.extent)
    size = upper - lower
    margin = 2.0 * float(size.max()) / OUTLINE
    counts = np.maximum(OUTLINE * size / size.max(), OUTLINE / 4).astype(int)
    x, y = (np.linspace(*ends) for ends in zip(lower - margin, upper + margin, counts, strict=True))
    points = plane.lifted(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2), through)
    away = np.min([np.abs(piece.shape.signed_distance(points)) for piece in domain.pieces], axis=0)
    return x, y, np.where(domain.contains(points), away, -away).reshape(len(y), len(x))
