"""A tree of boxes around facets, to find the nearest of them all. Arrays in, numbers out.

The facets lie along a curve that stays near itself (Morton, 1966). Four in a row are a leaf, and node n of the full
binary tree above holds nodes 2n and 2n + 1, from the root 1 on. So the walk through the tree needs no stack: after a
right child comes the parent's sibling.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.simplices import facet_to_facet, vertex_to_facet

LEAF = 4
"""Facets in a leaf."""

_NEXT_TO_NOTHING = 1e-300
"""A squared distance that only boxes that meet are below."""


class Tree(NamedTuple):
    """All ``facets`` (F, d), ``order`` of those in the tree along the curve, ``boxes`` (nodes, 2, d), the lower and
    upper corner of each [length]."""

    facets: NDArray[np.int32]
    order: NDArray[np.int32]
    boxes: FloatArray


@njit(cache=True, nogil=True)
def build_tree(points, facets, chosen):
    """The tree of the facets ``chosen``."""
    order = chosen[np.argsort(_curve(points, facets, chosen))]
    leaves = 1
    while leaves * LEAF < len(order):
        leaves *= 2
    boxes = np.empty((2 * leaves, 2, points.shape[1]))
    boxes[:, 0], boxes[:, 1] = np.inf, -np.inf
    for row in range(len(order)):
        box = boxes[leaves + row // LEAF]
        for corner in facets[order[row]]:
            for k in range(points.shape[1]):
                box[0, k], box[1, k] = min(box[0, k], points[corner, k]), max(box[1, k], points[corner, k])
    for node in range(leaves - 1, 0, -1):
        for k in range(points.shape[1]):
            boxes[node, 0, k] = min(boxes[2 * node, 0, k], boxes[2 * node + 1, 0, k])
            boxes[node, 1, k] = max(boxes[2 * node, 1, k], boxes[2 * node + 1, 1, k])
    return Tree(facets, order, boxes)


@njit(cache=True, nogil=True)
def empty_tree(facets):
    """A tree of none of the ``facets``, in which nothing is found."""
    return Tree(facets, np.empty(0, np.int32), np.empty((0, 2, facets.shape[1])))


@njit(cache=True, nogil=True, forceinline=True)
def search_to_vertex(points, vertex, tree, square, facet):
    """``square`` and ``facet``, or what in the tree is nearer to a vertex: least squared distance and where."""
    facets, order, boxes = tree
    node = _leaf(points, (vertex,), boxes, 1, square)
    while node > 0:
        first = (node - len(boxes) // 2) * LEAF
        for row in range(first, min(first + LEAF, len(order))):
            new_square = vertex_to_facet(points, vertex, facets, order[row])[0]
            if new_square < square:
                square, facet = new_square, order[row]
        node = _leaf(points, (vertex,), boxes, _after(node), square)
    return square, facet


@njit(cache=True, nogil=True)
def nearest_facets(points, tree, queries):
    """Nearest facet to each of the points ``queries`` (N, d), bits of the corners that carry weight, the weights.

    Each query is the last of ``points`` for a while, since distances are those of vertices.
    """
    facets, last = tree.facets, len(points)
    extended = np.empty((last + 1, points.shape[1]))
    extended[:last] = points
    nearest = np.empty(len(queries), np.int64)
    bits = np.empty(len(queries), np.int64)
    weights = np.empty((len(queries), 3))
    for row in range(len(queries)):
        extended[last] = queries[row]
        guess = _facet_near(extended, last, tree)
        square = vertex_to_facet(extended, last, facets, guess)[0]
        facet = search_to_vertex(extended, last, tree, square, guess)[1]
        nearest[row] = facet
        _, bits[row], weights[row, 0], weights[row, 1], weights[row, 2] = vertex_to_facet(extended, last, facets, facet)
    return nearest, bits, weights


@njit(cache=True, nogil=True)
def facets_within(points, tree, queries, reach):
    """All facets within ``reach`` (N,) of each of the points ``queries`` (N, d), none at zero reach: the query, the
    facet, bits of the corners that carry weight, the weights."""
    last = len(points)
    extended = np.empty((last + 1, points.shape[1]))
    extended[:last] = points
    facets, order, boxes = tree
    pairs = [(0, 0) for _ in range(0)]
    for row in range(len(queries)):
        extended[last] = queries[row]
        limit = reach[row] ** 2
        node = _leaf(extended, (last,), boxes, 1, limit)
        while node > 0:
            first = (node - len(boxes) // 2) * LEAF
            for place in range(first, min(first + LEAF, len(order))):
                if vertex_to_facet(extended, last, facets, order[place])[0] <= limit:
                    pairs.append((row, order[place]))
            node = _leaf(extended, (last,), boxes, _after(node), limit)
    query, nearest, bits = np.empty((3, len(pairs)), np.int64)
    weights = np.empty((len(pairs), 3))
    for row in range(len(pairs)):
        query[row], nearest[row] = pairs[row]
        extended[last] = queries[query[row]]
        found = vertex_to_facet(extended, last, facets, nearest[row])
        bits[row], weights[row, 0], weights[row, 1], weights[row, 2] = found[1], found[2], found[3], found[4]
    return query, nearest, bits, weights


@njit(cache=True, nogil=True)
def leaves_beside(points, corners, tree):
    """The facets in leaves whose boxes meet that of some corners."""
    order, boxes = tree.order, tree.boxes
    found = [order[0] for _ in range(0)]
    node = _leaf(points, corners, boxes, 1, _NEXT_TO_NOTHING)
    while node > 0:
        first = (node - len(boxes) // 2) * LEAF
        for row in range(first, min(first + LEAF, len(order))):
            found.append(order[row])
        node = _leaf(points, corners, boxes, _after(node), _NEXT_TO_NOTHING)
    return found


@njit(cache=True, nogil=True)
def search_to_facet(points, target, tree, square, facet):
    """``square`` and ``facet``, or what in the tree is nearer to the facet ``target``."""
    facets, order, boxes = tree
    corners = facets[target, 0], facets[target, 1], facets[target, -1]
    node = _leaf(points, corners, boxes, 1, square)
    while node > 0:
        first = (node - len(boxes) // 2) * LEAF
        for row in range(first, min(first + LEAF, len(order))):
            new_square = facet_to_facet(points, facets, target, order[row])[0]
            if new_square < square:
                square, facet = new_square, order[row]
        node = _leaf(points, corners, boxes, _after(node), square)
    return square, facet


@njit(cache=True, nogil=True)
def _facet_near(points, vertex, tree):
    """The first facet of the leaf that is found by going to the nearer box each time."""
    order, boxes = tree.order, tree.boxes
    leaves, node = len(boxes) // 2, 1
    while node < leaves:
        node *= 2
        if _apart(points, (vertex,), boxes, node + 1) < _apart(points, (vertex,), boxes, node):
            node += 1
    return order[(node - leaves) * LEAF]


@njit(cache=True, nogil=True, forceinline=True)
def _leaf(points, corners, boxes, node, square):
    """The next leaf, from ``node`` on, whose box is nearer to that of the corners than ``square``; 0 at the end."""
    leaves = len(boxes) // 2
    while node > 0 and leaves > 0:
        if _apart(points, corners, boxes, node) >= square:
            node = _after(node)
        elif node >= leaves:
            return node
        else:
            node *= 2
    return 0


@njit(cache=True, nogil=True, forceinline=True)
def _after(node):
    """The node after this one and all below it."""
    while node & 1:
        node >>= 1
    return node + (node > 0)


@njit(cache=True, nogil=True, forceinline=True)
def _apart(points, corners, boxes, node):
    """Squared distance of the box around some corners and that of a node."""
    total = 0.0
    for k in range(points.shape[1]):
        low = high = points[corners[0], k]
        for corner in corners:
            low, high = min(low, points[corner, k]), max(high, points[corner, k])
        total += max(low - boxes[node, 1, k], boxes[node, 0, k] - high, 0.0) ** 2
    return total


@njit(cache=True, nogil=True)
def _curve(points, facets, chosen):
    """Place of each facet along the curve: the bits of its coordinates in turn."""
    dimension = points.shape[1]
    middle = np.zeros((len(chosen), dimension))
    for row in range(len(chosen)):
        for corner in facets[chosen[row]]:
            for k in range(dimension):
                middle[row, k] += points[corner, k]
    code = np.zeros(len(chosen), np.int64)
    for k in range(dimension):
        low, high = middle[:, k].min(), middle[:, k].max()
        scale = 1023.0 / (high - low) if high > low else 0.0
        for row in range(len(chosen)):
            number = int((middle[row, k] - low) * scale)
            for bit in range(10):
                code[row] |= (number >> bit & 1) << (bit * dimension + k)
    return code
