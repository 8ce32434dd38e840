"""Quadratic functions on simplices, whose edges may be curved: nodes, gradients and integrals of products."""

from __future__ import annotations

from functools import cache
from itertools import product
from math import factorial, prod

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

EDGES = {3: ((0, 1), (1, 2), (0, 2)), 4: ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))}
"""Which corners each middle node is between, in VTK's order, by the number of corners."""


def node_coordinates(count: int) -> FloatArray:
    """Barycentric coordinates (b, count) of the nodes of a cell with so many corners."""
    corners = np.eye(count)
    first, second = np.transpose(EDGES[count])
    return np.vstack([corners, 0.5 * (corners[first] + corners[second])])


def quadratic_basis(coordinates: FloatArray) -> FloatArray:
    """Nodal functions (…, b) at barycentric ``coordinates`` (…, count) [1]."""
    first, second = np.transpose(EDGES[coordinates.shape[-1]])
    corners = coordinates * (2.0 * coordinates - 1.0)
    return np.concatenate([corners, 4.0 * coordinates[..., first] * coordinates[..., second]], axis=-1)


def node_stretches(points: FloatArray) -> FloatArray:
    """Volume at each node over that in the cell's own coordinates, (M, b), of cells with nodes ``points`` (M, b, d); in
    3D less a term of third order in the bends it is quadratic within the cell [length^d]."""
    return np.asarray(np.abs(np.linalg.det(_along_slopes(points))))


def node_gradients(points: FloatArray, values: FloatArray) -> FloatArray:
    """∂v_i/∂x_j at the b nodes of each of M cells, (M, b, c, d), index i before j, of ``values`` (M, b, c) at the nodes
    ``points`` (M, b, d).

    Both are quadratic in the cell's own coordinates.
    """
    return _along_slopes(values) @ _inverse(_along_slopes(points))


def _along_slopes(values: FloatArray) -> FloatArray:
    """Derivatives (M, b, c, d) of ``values`` (M, b, c) in the cells' own coordinates."""
    cells, nodes, components = values.shape
    slopes = _slopes(2 if nodes == 6 else 3)
    by_node = slopes.transpose(1, 0, 2).reshape(nodes, -1)  # one product of matrices
    found = (np.swapaxes(values, 1, 2).reshape(-1, nodes) @ by_node).reshape(cells, components, nodes, slopes.shape[2])
    return np.asarray(np.swapaxes(found, 1, 2))


def _inverse(matrices: FloatArray) -> FloatArray:
    """Inverses of small ``matrices`` (…, d, d) by their cofactors."""
    if matrices.shape[-1] == 2:
        (a, b), (c, d) = np.moveaxis(matrices, (-2, -1), (0, 1))
        adjugate, determinant = np.stack([np.stack([d, -b], -1), np.stack([-c, a], -1)], -2), a * d - b * c
    else:
        x, y, z = np.moveaxis(matrices, -2, 0)
        adjugate = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-1)
        determinant = np.sum(x * adjugate[..., 0], axis=-1)
    return np.asarray(adjugate / determinant[..., None, None])


@cache
def mean_products(count: int) -> FloatArray:
    """Means (b, b) of products of two nodal functions over a straight cell with so many corners [1]."""
    own = np.eye(count)
    corners = np.einsum("ip,iq->ipq", own, 2.0 * own - 1.0)  # λ_i(2λ_i - 1) = λ_i(λ_i - Σ λ_j), as Σ λ = 1
    middles = np.zeros((len(EDGES[count]), count, count))
    for number, (first, second) in enumerate(EDGES[count]):
        middles[number, first, second] = 4.0
    functions = np.concatenate([corners, middles])
    return np.asarray(np.einsum("apq,brs,pqrs->ab", functions, functions, _moments(count)))


def _moments(count: int) -> FloatArray:
    """Means of λ_p λ_q λ_r λ_s over a cell: d! Π α! / (4 + d)!, with α times each."""
    moments, d = np.empty(4 * (count,)), count - 1
    for four in product(range(count), repeat=4):
        powers = prod(factorial(four.count(corner)) for corner in range(count))
        moments[four] = factorial(d) * powers / factorial(4 + d)
    return moments


@cache
def _slopes(dimension: int) -> FloatArray:
    """Derivatives (b, b, d) of the basis at the nodes: node, function, direction from the first corner to another."""
    corners, nodes = np.eye(dimension + 1), node_coordinates(dimension + 1)
    first, second = np.transpose(EDGES[dimension + 1])
    of_corners = (4.0 * nodes - 1.0)[:, :, None] * corners
    of_middles = 4.0 * (nodes[:, first, None] * corners[second] + nodes[:, second, None] * corners[first])
    along = np.concatenate([of_corners, of_middles], axis=1)
    return np.asarray(along[..., 1:] - along[..., :1])
