"""Features of a surface of facets that can touch others: corners that stick out, and in space edges that do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facet_faces import faces_of, unit
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.ridges import Ridges, ridges_of

_FLAT = 1e-9
"""Sine of the angle below which a facet goes on straight."""


@dataclass(frozen=True)
class Features:
    """``corners`` (c,), rows of points, and ``edges`` (e, 2), empty in the plane; ``downhill`` (e, 2, d), directions
    across the edge into the facets on both sides; ``all_edges`` (E, 2), those that do not stick out too."""

    corners: IntArray
    edges: IntArray
    downhill: FloatArray
    all_edges: IntArray


def features_of(surface: FacetSurface) -> Features:
    """The corners that are farther out along their mean normal than all that they have an edge to, and the edges that
    are so of the facets next to them; of a part of a surface those of the whole that lie on the part."""
    found = _features(surface.whole.facets)
    own = np.isin(np.arange(len(surface.facets.points)), surface.facets.vertices)
    corners, edges = own[found.corners], own[found.edges].all(axis=1)
    return Features(
        found.corners[corners],
        found.edges[edges],
        found.downhill[edges],
        found.all_edges[own[found.all_edges].all(axis=1)],
    )


def _features(facets: Facets) -> Features:
    points, vertices = facets.points, facets.vertices
    dimension = points.shape[1]
    faces = faces_of(points, vertices)
    ridges = ridges_of(vertices)
    edges = ridges.corners if dimension == 3 else np.unique(np.sort(vertices, axis=1), axis=0)
    normals = np.zeros_like(points)
    normals[vertices] = faces.normals[:, [0, 1, 3][:dimension]]
    both_ways = np.concatenate([edges, edges[:, ::-1]])
    along = unit(points[both_ways[:, 1]] - points[both_ways[:, 0]])
    rise = np.full(len(points), -np.inf)
    np.maximum.at(rise, both_ways[:, 0], np.sum(along * normals[both_ways[:, 0]], axis=1))
    corners = np.flatnonzero((rise < -_FLAT) & np.isfinite(rise))
    if dimension == 2:
        return Features(corners, np.empty((0, 2), dtype=np.int64), np.empty((0, 2, 2)), edges)
    mean, downhill = _sides(points, vertices, ridges)
    sharp = np.flatnonzero(np.all(np.einsum("esk,ek->es", downhill, mean) < -_FLAT, axis=1))
    return Features(corners, edges[sharp], downhill[sharp], edges)


def _sides(points: FloatArray, vertices: IntArray, ridges: Ridges) -> tuple[FloatArray, FloatArray]:
    """Mean unit normals (E, 3) of the facets at the ``ridges``, and unit directions (E, 2, 3) across each into them,
    zero where it has one facet alone."""
    at = ridges.number.T.ravel()
    ends, opposite = ridges.corners[at], np.roll(vertices, -2, axis=1).T.ravel()
    mean = np.zeros((len(ridges.corners), 3))
    np.add.at(mean, at, np.tile(unit(area_vectors(points, vertices)), (3, 1)))
    along = unit(points[ends[:, 1]] - points[ends[:, 0]])
    away = points[opposite] - points[ends[:, 0]]
    across = unit(away - np.sum(away * along, axis=1)[:, None] * along)
    order = np.argsort(at, kind="stable")
    second = np.append(False, at[order][1:] == at[order][:-1]).astype(np.int64)
    downhill = np.zeros((len(mean), 2, 3))
    downhill[at[order], second] = across[order]
    return unit(mean), downhill
