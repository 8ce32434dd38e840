"""Distances to a surface made of facets, with the right sign at edges and corners too."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.model.facets import Facets, area_vectors
from rigidfluid.core.model.surface import Plane, Surface
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from rigidfluid.core.model.facet_tree import Tree

_FLAT = 1e-10
"""Over the size of the surface: points that are less off a plane lie in it."""

_TOUCHING = 1e-8
"""Over the size of the surface: nearer points have no direction from an edge or a corner."""

_VERTICES = np.array([0, 1, 3])
_EDGES = np.array([2, 4, 5])
_EDGE_ENDS = np.array([[0, 1], [0, 2], [1, 2]])
"""Bits (less one) of the corners of a facet's vertices and edges, and the ends of the edges."""

_CORNER = np.array([0, 1, 0, 2, 0, 1, 0])
"""A corner of the vertex, edge or inside of a facet that each number of bits (less one) stands for."""


class FacetSurface(Surface):
    """A surface of facets, which share the points that they have in common.

    The distance is that to the nearest point p of all facets. Its sign is that of (x - p)·n, where n is the mean of
    the normals of the facets that meet at p, each weighted by its angle there.

    Parameters
    ----------
    facets : Facets
        All of a closed surface, or a part of one. Markers are not looked at but by `piece`.
    whole : FacetSurface, optional
        The closed surface that this is a part of. Points that are on its fluid side are at positive distances from the
        part, too; all others have the sign that the part itself gives them.

    Notes
    -----
    J. A. Bærentzen and H. Aanæs, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243, doi:10.1109/TVCG.2005.49.
    """

    def __init__(self, facets: Facets, whole: FacetSurface | None = None) -> None:
        self.facets = facets
        self._whole = whole
        self._points = np.ascontiguousarray(facets.points, dtype=float)
        self._vertices = np.ascontiguousarray(facets.vertices, dtype=np.int64)
        used = self._points[np.unique(self._vertices)]
        self._bounds = used.min(axis=0), used.max(axis=0)
        self._size = float(np.max(self._bounds[1] - self._bounds[0]))

    def piece(self, marker: int) -> FacetSurface:
        """The facets with this marker, a part of this closed surface."""
        chosen = self.facets.markers == marker
        part = Facets(self.facets.points, self.facets.vertices[chosen], self.facets.markers[chosen])
        return FacetSurface(part, whole=self)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around all facets, (d,) each [length]."""
        return self._bounds

    @cached_property
    def plane(self) -> Plane | None:
        """The plane that all facets lie in, bounded as they are; None if there is no such plane."""
        total = area_vectors(self._points, self._vertices).sum(axis=0)
        length = np.linalg.norm(total)
        if length == 0:
            return None
        normal, origin = total / length, self._points[self._vertices[0, 0]]
        heights = (self._points[np.unique(self._vertices)] - origin) @ normal
        return Plane(origin, normal, self._bounds) if np.all(np.abs(heights) <= _FLAT * self._size) else None

    @property
    def radius(self) -> float | None:
        """Infinite where all facets lie in a plane, else None [length]."""
        return None if self.plane is None else np.inf

    def closest_point(self, points: FloatArray) -> FloatArray:
        """Nearest points of the facets, (N, d) for ``points`` (N, d) [length]."""
        return self._foot(*self._nearest(points))

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """Distance to the nearest facet, (N,), > 0 in the fluid, for ``points`` (N, d) [length]."""
        nearest, bits, weights = self._nearest(points)
        away = np.linalg.norm(points - self._foot(nearest, bits, weights), axis=1)
        return np.asarray(np.where(self._in_fluid(points, nearest, bits), away, -away))

    def normal(self, points: FloatArray) -> FloatArray:
        """Unit normals into the fluid, (N, d), at the closest points of ``points`` (N, d).

        At edges and corners the direction in which the distance grows at the point itself, or, of a point of the
        surface, the mean of the normals there.
        """
        nearest, bits, weights = self._nearest(points)
        normal = self._normals[nearest, bits - 1]
        off = points - self._foot(nearest, bits, weights)
        away = np.linalg.norm(off, axis=1)
        sharp = (bits < self._normals.shape[1]) & (away > _TOUCHING * self._size)
        side = np.where(self._in_fluid(points[sharp], nearest[sharp], bits[sharp]), 1.0, -1.0)
        normal[sharp] = (side / away[sharp])[:, None] * off[sharp]
        return np.asarray(normal)

    def _nearest(self, points: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
        """The nearest facet of each of ``points``, bits of the corners that carry weight there, and the weights."""
        from rigidfluid.core.model.facet_tree import nearest_facets

        queries = np.ascontiguousarray(points, dtype=float)
        nearest, bits, weights = nearest_facets(self._points, self._vertices, self._tree, queries)
        return nearest, bits, weights[:, : self._points.shape[1]]

    def _foot(self, nearest: IntArray, bits: IntArray, weights: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("ni,nij->nj", weights, self._points[self._vertices[nearest]]))

    def _in_fluid(self, points: FloatArray, nearest: IntArray, bits: IntArray) -> BoolArray:
        # a corner that carries weight instead of the nearest point, since the normal is across what both lie on
        corner = self._vertices[nearest, _CORNER[bits - 1]]
        side = np.einsum("nj,nj->n", points - self._points[corner], self._normals[nearest, bits - 1])
        if self._whole is None:
            return np.asarray(side >= 0)
        return np.asarray((side >= 0) | (self._whole.signed_distance(points) > 0))

    @cached_property
    def _tree(self) -> Tree:
        from rigidfluid.core.model.facet_tree import Tree, build_tree

        return Tree(*build_tree(self._points, self._vertices, np.arange(len(self._vertices), dtype=np.int32)))

    @cached_property
    def _normals(self) -> FloatArray:
        """On each facet's vertices, edges and inside, by the bits (less one) of their corners, (F, 2^d - 1, d)."""
        points, vertices = self._points, self._vertices
        normal = _unit(area_vectors(points, vertices))
        normals = np.repeat(normal[:, None], 2 ** points.shape[1] - 1, axis=1)
        normals[:, _VERTICES[: points.shape[1]]] = _mean_normals(vertices, normal, _angles(points[vertices]))
        if points.shape[1] == 3:
            edges = np.sort(vertices[:, _EDGE_ENDS], axis=2)
            _, number = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
            normals[:, _EDGES] = _mean_normals(number.reshape(-1, 3), normal, np.ones((len(vertices), 3)))
        return normals


def _mean_normals(numbers: IntArray, normal: FloatArray, weight: FloatArray) -> FloatArray:
    """Unit means (F, k, d) of the normals (F, d) of all facets that have the vertices or edges ``numbers`` (F, k)."""
    total = np.zeros((int(numbers.max()) + 1, normal.shape[1]))
    np.add.at(total, numbers, weight[:, :, None] * normal[:, None])
    return _unit(total)[numbers]


def _angles(corners: FloatArray) -> FloatArray:
    """The angles at the corners of triangles (F, 3, 3); of edges (F, 2, 2) each end counts alike, (F, d) [rad]."""
    if corners.shape[1] == 2:
        return np.ones(corners.shape[:2])
    ahead, behind = _unit(np.roll(corners, -1, axis=1) - corners), _unit(np.roll(corners, 1, axis=1) - corners)
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(ahead - behind, axis=2), np.linalg.norm(ahead + behind, axis=2)))


def _unit(vectors: FloatArray) -> FloatArray:
    """Of length 1 along the last axis; none where there is no direction, as between two sides of a blade."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))
