"""Surfaces of facets where they stand, and what pairs of them have besides their corners."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.detectors.facet_features import Features, features_of
from rigidfluid.detectors.hollows import hollow_numbers
from rigidfluid.detectors.in_space import in_space


class FacetTriples(NamedTuple):
    """A surface of facets: ``points`` (N, 3) [length], ``vertices`` (F, d), unit ``normals`` (F, 3) into the fluid, and
    its `Features` with ``downhill`` (e, 2, 3)."""

    points: FloatArray
    vertices: IntArray
    normals: FloatArray
    corners: IntArray
    edges: IntArray
    downhill: FloatArray
    all_edges: IntArray


class Solid:
    """A surface of facets in its own frame, and its features that can touch others."""

    def __init__(self, surface: FacetSurface) -> None:
        self.surface = surface

    @cached_property
    def features(self) -> Features:
        """Its corners and edges."""
        return features_of(self.surface)

    @cached_property
    def triples(self) -> FacetTriples:
        """Arrays of the surface and its features, for compiled loops."""
        facets, own = self.surface.facets, self.features
        vectors = (in_space(each) for each in (facets.points, self.surface.facet_normals, own.downhill))
        points, normals, downhill = vectors
        vertices = np.ascontiguousarray(facets.vertices, dtype=np.int64)
        return FacetTriples(points, vertices, normals, own.corners, own.edges, downhill, own.all_edges)

    @cached_property
    def hollows(self) -> IntArray:
        """Number (F,) of the hollow that each facet is in."""
        return hollow_numbers(self.surface)


class PlacedFacets(NamedTuple):
    """A surface of facets at ``position`` (d,), turned by ``rotation`` (d, d)."""

    solid: Solid
    position: FloatArray
    rotation: FloatArray

    def local(self, points: FloatArray) -> FloatArray:
        """Points (…, d) in its frame."""
        return np.asarray((points - self.position) @ self.rotation)

    def lab(self, points: FloatArray) -> FloatArray:
        """Points (…, d) of its frame in that of the domain."""
        return np.asarray(self.position + points @ self.rotation.T)

    @property
    def points(self) -> FloatArray:
        """All its points (N, d) [length]."""
        return self.lab(self.solid.surface.facets.points)


class Places(NamedTuple):
    """Places of one pair: ``point_a``, ``point_b``, ``normal`` (m, d) from b to a, ``gap`` (m,), and the ``sign`` (m,)
    with which they count."""

    point_a: FloatArray
    point_b: FloatArray
    normal: FloatArray
    gap: FloatArray
    sign: FloatArray


def passing_edges(a: PlacedFacets, b: PlacedFacets, reach: float) -> Places:
    """Edges of both that pass each other within ``reach`` [length], in space; each pair once more at the end that is
    nearest to the other edge, with sign -1.

    The nearest points move to such an end before the edges cease to pass, and edges pass at their ends when they are
    parallel. So the energy of both contacts fades to zero there.
    """
    from rigidfluid.detectors.edge_pairs import passing_edges

    points_a, points_b, both = a.points, b.points, (a.solid.features, b.solid.features)
    edges_a = both[0].edges[_near_boxes(points_a[both[0].edges], b, reach)]
    edges_b = both[1].edges[_near_boxes(points_b[both[1].edges], a, reach)]
    point_a, point_b, sign = passing_edges(points_a, edges_a, points_b, edges_b, reach)
    away = point_a - point_b
    gap = np.linalg.norm(away, axis=1)
    return Places(point_a, point_b, away / gap[:, None], gap, sign)


def _near_boxes(groups: FloatArray, other: PlacedFacets, reach: float) -> BoolArray:
    """Tell which groups of points (m, k, d) have a box within ``reach`` of that around another surface, in its
    frame."""
    lower, upper = other.solid.surface.bounds
    inside = other.local(groups)
    return np.asarray(np.all((inside.max(axis=1) >= lower - reach) & (inside.min(axis=1) <= upper + reach), axis=1))


def shallowest_piercing(a: PlacedFacets, b: PlacedFacets) -> Places:
    """The shallowest edge that goes through a facet, if any does, by its deeper end."""
    one, other = _piercing_edges(a, b), _piercing_edges(b, a)
    if len(one.gap) + len(other.gap) == 0:
        return one
    turned = other._replace(point_a=other.point_b, point_b=other.point_a, normal=-other.normal)
    both = Places(*(np.concatenate(each) for each in zip(one, turned, strict=True)))
    rows = [int(np.argmax(both.gap))] if len(both.gap) else []
    return Places(*(each[rows] for each in both))


def _piercing_edges(a: PlacedFacets, b: PlacedFacets) -> Places:
    """Edges of a through facets of b."""
    from rigidfluid.core.geometry.crossings import crossings

    facets, inside = b.solid.surface.facets, b.local(a.points)
    points, edges = np.concatenate([facets.points, inside]), a.solid.features.all_edges + len(facets.points)
    crossed = crossings(points, edges, b.solid.surface.tree)
    if len(crossed) == 0:
        none = np.empty((0, points.shape[1]))
        return Places(none, none, none, np.empty(0), np.empty(0))
    normal = b.solid.surface.facet_normals[crossed[:, 1]]
    ends = points[edges[crossed[:, 0]]]
    heights = np.einsum("mej,mj->me", ends - points[facets.vertices[crossed[:, 1], :1]], normal)
    deeper = np.argmin(heights, axis=1)
    rows = np.arange(len(crossed))
    gap, end = np.minimum(heights[rows, deeper], 0.0), ends[rows, deeper]
    return Places(b.lab(end), b.lab(end - gap[:, None] * normal), normal @ b.rotation.T, gap, np.ones(len(gap)))
