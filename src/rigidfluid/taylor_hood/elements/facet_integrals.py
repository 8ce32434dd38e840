"""Integrals over boundary facets of quadratic elements, flat or curved (isoparametric).

The nodes of a facet are its vertices, then its edges' midpoints, as in `Numbering.facet_nodes`.
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.taylor_hood.elements.numbering import facet_edges

# ∫ φᵢ over a straight quadratic facet of measure 1: Simpson's weights on an edge, the midpoints' on a triangle.
_WEIGHTS = {2: np.array([1.0, 1.0, 4.0]) / 6.0, 3: np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]) / 3.0}

_POINTS = 4
"""Points of Gauss' rule in each direction: exact for ∫ φᵢ n of a curved triangle, and for three velocities on a flat
one."""


def facet_weights(points: FloatArray, facets: IntArray) -> FloatArray:
    """∫ φᵢ over each facet for its nodes i, (F, 3 | 6), for vertices at ``points`` and ``facets`` (F, d)."""
    edges = points[facets[:, 1:]] - points[facets[:, :1]]
    gram = edges @ np.swapaxes(edges, 1, 2)
    measure = np.sqrt(np.linalg.det(gram)) / (1.0 if facets.shape[1] == 2 else 2.0)
    return np.outer(measure, _WEIGHTS[facets.shape[1]])


def area_vectors(facet_points: FloatArray) -> FloatArray:
    """∫ φᵢ n over each facet for its nodes i, (F, 3 | 6, d) [length^(d-1)].

    Parameters
    ----------
    facet_points : (F, 3 | 6, d) array
        Coordinates of the nodes of each facet [length].

    Returns
    -------
    (F, 3 | 6, d) array
        The normal n of an edge from a to b points towards (y_b - y_a, x_a - x_b), and of a triangle towards (b - a) ×
        (c - a).
    """
    if facet_points.shape[2] == 2:
        return np.asarray(np.einsum("ij,fjd->fid", _edge_integrals(), _turned(facet_points)))
    pairs = np.cross(facet_points[:, :, None], facet_points[:, None, :])
    return np.asarray(np.einsum("ijk,fjkd->fid", _triangle_integrals(), pairs))


def normals_at_nodes(facet_points: FloatArray) -> FloatArray:
    """Unit normals of each facet at its nodes, (F, 3 | 6, d), in the sense of `area_vectors`."""
    d = facet_points.shape[2]
    tangents = [np.einsum("ij,fjd->fid", slope, facet_points) for slope in _slopes(_node_coordinates(d))]
    normal = _turned(tangents[0]) if d == 2 else np.cross(*tangents)
    return np.asarray(normal / np.linalg.norm(normal, axis=2, keepdims=True))


def area_at_points(facet_points: FloatArray, points: int = _POINTS) -> tuple[FloatArray, FloatArray]:
    """Gauss' rule on each facet: the nodes' functions at its points, (q, 3 | 6), and n dA there, (F, q, d).

    Parameters
    ----------
    facet_points : (F, 3 | 6, d) array
        Coordinates of the nodes of each facet [length].
    points : int
        Points of the rule in each direction.
    """
    shapes, slopes, weight = _tabulated(facet_points.shape[2], points)
    tangents = [slope @ facet_points for slope in slopes]
    area = _turned(tangents[0]) if len(tangents) == 1 else np.cross(tangents[0], tangents[1])
    return shapes, np.asarray(weight[:, None] * area)


def into_fluid(facets: IntArray, cells: IntArray, points: FloatArray) -> IntArray:
    """The ``facets`` (F, d) of ``cells`` (M, d+1), two vertices exchanged where their normal points out of the cells.

    ``points`` (N, d): the vertices.
    """
    d = points.shape[1]
    opposite = cells.ravel()[opposite_corners(facets, cells, len(points))]
    corners = points[facets]
    edges = corners[:, 1:] - corners[:, :1]
    normal = _turned(edges[:, 0]) if d == 2 else np.cross(edges[:, 0], edges[:, 1])
    outward = np.sum((points[opposite] - corners[:, 0]) * normal, axis=1) < 0.0
    found = facets.copy()
    found[outward, :2] = facets[outward, 1::-1]
    return found


def opposite_corners(facets: IntArray, cells: IntArray, vertices: int) -> IntArray:
    """The corner that each of the ``facets`` (F, d) lies opposite to, (F,), counted through all ``cells`` (M, d+1).

    A boundary facet is of one cell; ``vertices``: the number of the mesh's.
    """
    d = facets.shape[1]
    number = vertices ** np.arange(d)
    faces = np.stack([np.delete(cells, corner, axis=1) for corner in range(d + 1)], axis=1)
    keys = (np.sort(faces, axis=2) @ number).ravel()
    order = np.argsort(keys, kind="stable")
    return np.asarray(order[np.searchsorted(keys, np.sort(facets, axis=1) @ number, sorter=order)])


def _turned(vectors: FloatArray) -> FloatArray:
    """(y, -x) of (x, y), on the last axis."""
    return np.stack([vectors[..., 1], -vectors[..., 0]], axis=-1)


def _node_coordinates(dimension: int) -> FloatArray:
    """Barycentric coordinates of a facet's nodes, (3 | 6, d)."""
    corners = np.eye(dimension)
    return np.concatenate([corners, [corners[pair].mean(axis=0) for pair in facet_edges(dimension)]])


def _shapes(at: FloatArray) -> FloatArray:
    """φⱼ at barycentric coordinates (q, d), (q, 3 | 6)."""
    middles = [4.0 * at[:, a] * at[:, b] for a, b in facet_edges(at.shape[1])]
    return np.column_stack([at * (2.0 * at - 1.0), *middles])


def _slopes(at: FloatArray) -> list[FloatArray]:
    """∂φⱼ/∂ξ along each edge from the first vertex, d - 1 times (q, 3 | 6)."""
    d = at.shape[1]
    slopes = []
    for axis in range(1, d):
        of = np.eye(d)[axis] - np.eye(d)[0]  # ∂λ/∂ξ
        middles = [4.0 * (at[:, a] * of[b] + at[:, b] * of[a]) for a, b in facet_edges(d)]
        slopes.append(np.column_stack([(4.0 * at - 1.0) * of, *middles]))
    return slopes


def _rule(dimension: int, points: int = _POINTS) -> tuple[FloatArray, FloatArray]:
    """Points (q, d), in barycentric coordinates, and weights (q,) on a facet, collapsed from a square in 3D."""
    root, weight = np.polynomial.legendre.leggauss(points)
    root, weight = (1.0 + root) / 2.0, weight / 2.0
    if dimension == 2:
        return np.column_stack([1.0 - root, root]), weight
    u, v = np.array(list(product(root, root))).T
    share = np.outer(weight * (1.0 - root), weight).ravel()
    return np.column_stack([(1.0 - u) * (1.0 - v), u, v * (1.0 - u)]), share


@cache
def _tabulated(dimension: int, points: int) -> tuple[FloatArray, list[FloatArray], FloatArray]:
    """φⱼ and its slopes at the points of Gauss' rule, and the weights."""
    at, weight = _rule(dimension, points)
    return _shapes(at), _slopes(at), weight


@cache
def _edge_integrals() -> FloatArray:
    """∫ φᵢ φⱼ', (3, 3)."""
    at, weight = _rule(2)
    return np.asarray(np.einsum("q,qi,qj->ij", weight, _shapes(at), *_slopes(at)))


@cache
def _triangle_integrals() -> FloatArray:
    """∫ φᵢ ∂₁φⱼ ∂₂φₖ, (6, 6, 6)."""
    at, weight = _rule(3)
    return np.asarray(np.einsum("q,qi,qj,qk->ijk", weight, _shapes(at), *_slopes(at)))
