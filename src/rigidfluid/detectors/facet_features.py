"""What of a surface of facets can touch others: corners that stick out, and in space edges that do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.model.facet_faces import faces_of, unit
from rigidfluid.core.model.facet_surface import FacetSurface
from rigidfluid.core.model.facets import Facets, area_vectors
from rigidfluid.core.model.types import FloatArray, IntArray

_FLAT = 1e-9
"""Sine of the angle below which a facet goes on straight."""


@dataclass(frozen=True)
class Features:
    """``corners`` (c,), rows of points, and ``edges`` (e, 2), empty in the plane, with their mean unit normals
    ``corner_normals`` (c, d) and ``edge_normals`` (e, d); ``all_edges`` (E, 2), those that do not stick out too."""

    corners: IntArray
    corner_normals: FloatArray
    edges: IntArray
    edge_normals: FloatArray
    all_edges: IntArray


def features_of(surface: FacetSurface) -> Features:
    """The corners that are farther out along their mean normal than all that they have an edge to, and the edges that
    are so of the facets beside them; of a part of a surface those of the whole that lie on the part."""
    found = _features(surface.whole.facets)
    own = np.isin(np.arange(len(surface.facets.points)), surface.facets.vertices)
    corners, edges = own[found.corners], own[found.edges].all(axis=1)
    return Features(
        found.corners[corners],
        found.corner_normals[corners],
        found.edges[edges],
        found.edge_normals[edges],
        found.all_edges[own[found.all_edges].all(axis=1)],
    )


def _features(facets: Facets) -> Features:
    points, vertices = facets.points, facets.vertices
    dimension = points.shape[1]
    faces = faces_of(points, vertices)
    ahead = np.concatenate([vertices[:, [i, (i + 1) % dimension]] for i in range(dimension)])
    edges = np.unique(np.sort(ahead, axis=1), axis=0)
    normals = np.zeros_like(points)
    normals[vertices] = faces.normals[:, [0, 1, 3][:dimension]]
    both_ways = np.concatenate([edges, edges[:, ::-1]])
    along = unit(points[both_ways[:, 1]] - points[both_ways[:, 0]])
    rise = np.full(len(points), -np.inf)
    np.maximum.at(rise, both_ways[:, 0], np.sum(along * normals[both_ways[:, 0]], axis=1))
    corners = np.flatnonzero((rise < -_FLAT) & np.isfinite(rise))
    if dimension == 2:
        return Features(corners, normals[corners], np.empty((0, 2), np.int64), np.empty((0, 2)), edges)
    sharp, mean = _sharp_edges(points, vertices, edges)
    return Features(corners, normals[corners], edges[sharp], mean[sharp], edges)


def _sharp_edges(points: FloatArray, vertices: IntArray, edges: IntArray) -> tuple[IntArray, FloatArray]:
    """Rows of ``edges`` from which the facets on both sides go down, and the mean normals of all."""
    numbers = {tuple(edge): row for row, edge in enumerate(edges.tolist())}
    normal = unit(area_vectors(points, vertices))
    mean, across, row = np.zeros((len(edges), 3)), [], []
    for i in range(3):
        ends = np.sort(vertices[:, [i, (i + 1) % 3]], axis=1)
        row.append(np.array([numbers[tuple(end)] for end in ends.tolist()]))
        np.add.at(mean, row[-1], normal)
        across.append(vertices[:, (i + 2) % 3])
    mean, at = unit(mean), np.concatenate(row)
    down = unit(points[np.concatenate(across)] - points[edges[at, 0]])
    rise = np.full(len(edges), -np.inf)
    np.maximum.at(rise, at, np.sum(down * mean[at], axis=1))
    return np.flatnonzero(rise < -_FLAT), mean
