"""Distances to a surface made of facets, with the right sign at edges and corners too."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_faces import Faces, faces_of
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.plane_of_facets import plane_around
from rigidfluid.core.geometry.surface import Surface

if TYPE_CHECKING:
    from rigidfluid.core.geometry.facet_tree import Tree

_TOUCHING = 1e-8
"""Distance, over the size of the surface, below which points have no direction from an edge or a corner."""

_FLAT = 1e-12
"""Height of a point before a facet, over the size of the surface, that is rounding."""

_FEW = 1_000
"""Number of facets of which each is compared with all points."""

_CORNER = np.array([0, 1, 0, 2, 0, 1, 0])
"""A corner of the vertex, edge or inside of a facet that each number of bits (less one) stands for."""


class Nearby(NamedTuple):
    """Places of a surface: the ``point`` (m,) each is near to, by its row, the ``facet`` (m,) that it is on, or one of
    them, 0 on a surface without facets, the ``foot`` (m, d), the signed ``distance`` (m,) and the unit ``normal`` (m,
    d) into the fluid."""

    point: IntArray
    facet: IntArray
    foot: FloatArray
    distance: FloatArray
    normal: FloatArray

    def select(self, rows: IntArray | BoolArray) -> Nearby:
        """Places in these ``rows``, or where they are true."""
        return Nearby(self.point[rows], self.facet[rows], self.foot[rows], self.distance[rows], self.normal[rows])


class _Measured(NamedTuple):
    foot: FloatArray
    distance: FloatArray
    normal: FloatArray


class FacetSurface(Surface):
    """A surface of facets, which share the points that they have in common.

    The distance is that to the nearest point p of all facets. Its sign is that of (x - p)·n, where n is the mean of
    the normals of the facets that meet at p, each weighted by its angle there.

    Parameters
    ----------
    facets : Facets
        All of a closed surface, or a part of one. Markers are not looked at but by `piece`.
    whole : FacetSurface, optional
        The closed surface that this is a part of, between the same points. Points that are on its fluid side are at
        positive distances from the part, too; all others have the sign that the part itself gives them.

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

    def piece(self, marker: int) -> Surface:
        """Surface of the facets with this marker, a part of this closed one: their plane if all of this surface is on
        its one side, and the facets alone if they are not flat or their plane goes on inside."""
        part = self.facets.part(self.facets.markers == marker)
        plane = plane_around(part, self._points[np.unique(self._vertices)])
        return FacetSurface(part, whole=self) if plane is None else plane

    @property
    def whole(self) -> FacetSurface:
        """The closed surface that this is a part of, or itself."""
        return self._whole or self

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around all facets, (d,) each [length]."""
        return self._bounds

    @property
    def facet_normals(self) -> FloatArray:
        """Unit normals into the fluid of all facets, (F, d)."""
        return self._faces.normals[:, -1]

    def nearest(self, points: FloatArray) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
        """Rows of the nearest facets (N,), and `closest_point`, `signed_distance` and `normal` of ``points`` (N, d)."""
        found = self._nearest(points)
        return (found[0], *self._measured(points, *found))

    def closest_point(self, points: FloatArray) -> FloatArray:
        """Nearest points of the facets, (N, d) for ``points`` (N, d) [length]."""
        return self._measured(points, *self._nearest(points)).foot

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """Distance to the nearest facet, (N,), > 0 in the fluid, for ``points`` (N, d) [length]."""
        return self._measured(points, *self._nearest(points)).distance

    def normal(self, points: FloatArray) -> FloatArray:
        """Unit normals into the fluid, (N, d), at the closest points of ``points`` (N, d).

        The normal at an edge or a corner is the direction in which the distance grows at the point itself, or, for a
        point of the surface, the mean of the normals there.
        """
        return self._measured(points, *self._nearest(points)).normal

    def nearby(self, points: FloatArray, reach: float | FloatArray, spread: float | FloatArray) -> Nearby:
        """Places of the surface that are nearer to a point than all around them, as the two sides of a hollow.

        Parameters
        ----------
        points : (N, d) array
            Anywhere [length].
        reach : float or (N,) array
            Largest distance, may be infinite [length].
        spread : float or (N,) array
            How much farther than the nearest place others may be [length].

        Returns
        -------
        Nearby
            Of each point the nearest place, and of points in the fluid also the others.
        """
        from rigidfluid.core.geometry.facet_tree import facets_within

        facet, bits, weights = self._nearest(points)
        first = self._measured(points, facet, bits, weights)
        near = np.flatnonzero(first.distance <= reach)
        nearest = Nearby(near, facet[near], *(column[near] for column in first))
        if self._is_convex:
            return nearest
        within = np.where(first.distance > 0, np.minimum(reach, first.distance + spread), 0.0)
        query, others, their_bits, their_weights = facets_within(
            self._points, self.tree, np.ascontiguousarray(points, dtype=float), within
        )
        total, numbers = len(self._faces.facets_at), self._faces.numbers
        place = query * total + numbers[others, their_bits - 1]
        beside = np.flatnonzero(place != query * total + numbers[facet, bits - 1][query])
        if len(beside) == 0:
            return nearest
        place, row, times = np.unique(place[beside], return_index=True, return_counts=True)
        # nearer than all around: the nearest point of each facet that meets there is there
        row = beside[row[times == self._faces.facets_at[place % total]]]
        more = self._measured(
            points[query[row]], others[row], their_bits[row], their_weights[row][:, : points.shape[1]]
        )
        ahead = np.flatnonzero(self._side(points[query[row]], others[row], their_bits[row]) > 0)
        ahead = ahead[_distinct(query[row][ahead], more.foot[ahead], first.foot, _TOUCHING * self._size)]
        further = Nearby(query[row][ahead], others[row][ahead], *(column[ahead] for column in more))
        return Nearby(*(np.concatenate(both) for both in zip(nearest, further, strict=True)))

    def _nearest(self, points: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
        """The nearest facet of each of ``points``, bits of the corners that carry weight there, and the weights."""
        from rigidfluid.core.geometry.facet_tree import nearest_facets

        queries = np.ascontiguousarray(points, dtype=float)
        nearest, bits, weights = nearest_facets(self._points, self.tree, queries)
        return nearest, bits, weights[:, : self._points.shape[1]]

    def _measured(self, points: FloatArray, facet: IntArray, bits: IntArray, weights: FloatArray) -> _Measured:
        """Foot, signed distance and normal of one facet's nearest point to each of ``points`` (N, d)."""
        foot = np.einsum("ni,nij->nj", weights, self._points[self._vertices[facet]])
        side = self._side(points, facet, bits)
        in_fluid = side >= 0
        if self._whole is not None and not in_fluid.all():
            behind = ~in_fluid  # only there may another piece be nearer
            in_fluid[behind] = self._whole.signed_distance(points[behind]) > 0
        off = np.where(in_fluid[:, None], points - foot, foot - points)
        away = np.linalg.norm(off, axis=1)
        normal = self._faces.normals[facet, bits - 1]
        sharp = (bits < self._faces.numbers.shape[1]) & (away > _TOUCHING * self._size)
        normal[sharp] = off[sharp] / away[sharp, None]
        return _Measured(foot, np.where(in_fluid, away, -away), normal)

    def _side(self, points: FloatArray, facet: IntArray, bits: IntArray) -> FloatArray:
        """(x - p)·n, (N,), with p a corner that carries weight, as n is across all that the nearest point lies on."""
        corner = self._vertices[facet, _CORNER[bits - 1]]
        return np.asarray(np.einsum("nj,nj->n", points - self._points[corner], self._faces.normals[facet, bits - 1]))

    @cached_property
    def _is_convex(self) -> bool:
        """Tell whether it surely encloses a convex body: no point is before a facet, and each place the only nearest
        one of a point in the fluid."""
        if self._whole is not None or not 0 < len(self._vertices) <= _FEW:
            return False
        used, corner = self._points[np.unique(self._vertices)], self._points[self._vertices[:, 0]]
        heights = np.einsum("fpj,fj->fp", used[None] - corner[:, None], self.facet_normals)
        return bool(np.all(heights <= _FLAT * self._size))

    @cached_property
    def tree(self) -> Tree:
        """Tree of all facets."""
        from rigidfluid.core.geometry.facet_tree import Tree, build_tree

        return Tree(*build_tree(self._points, self._vertices, np.arange(len(self._vertices), dtype=np.int32)))

    @cached_property
    def _faces(self) -> Faces:
        return faces_of(self._points, self._vertices)


def _distinct(query: IntArray, foot: FloatArray, first: FloatArray, touching: float) -> BoolArray:
    """Tell whether each place is farther than ``touching`` [length] from the first of its point, and from those before,
    (m,).

    Rounding may say of a point over an end of facets that it is an inside of one and the end of another.
    """
    apart = np.linalg.norm(foot - first[query], axis=1) > touching
    same = (query[:, None] == query) & (np.linalg.norm(foot[:, None] - foot, axis=2) <= touching)
    return np.asarray(apart & ~np.tril(same, -1).any(axis=1))


def nearby(shape: Surface, points: FloatArray, reach: float | FloatArray, spread: float | FloatArray) -> Nearby:
    """Places of a shape by `FacetSurface.nearby`; the nearest place alone if it has no facets, as its hollows are not
    known."""
    if isinstance(shape, FacetSurface):
        return shape.nearby(points, reach, spread)
    distance = shape.signed_distance(points)
    near = np.flatnonzero(distance <= reach)
    foot, normal = shape.closest_point(points[near]), shape.normal(points[near])
    return Nearby(near, np.zeros_like(near), foot, distance[near], normal)
