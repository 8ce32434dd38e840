"""Compiled loops over cells for a viscosity that varies from one quadrature point to the next.

Points (N,) are those of the straight cells, one cell after another, then those of the curved ones; see `kernels`.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.backends.scikit_fem.kernels import curved_jacobian, inverted, physical_gradients, straight_jacobian


@njit(cache=True)
def fill_strain_rates(tensor, weight, cells, tables, velocity):
    """Write ∇u + ∇uᵀ at all points into ``tensor`` (N, d, d), and what they weigh in an integral into ``weight``."""
    d, sizes = cells.points.shape[1], tables.sizes
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((cells.nodes.shape[1], d))
    point, rule = 0, tables.flat
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, sizes)
        det = inverted(jacobian, inverse)
        for q in range(len(rule.weight)):
            physical_gradients(rule, q, inverse, gradient, sizes)
            weight[point] = rule.weight[q] * det
            strain_rate_at(velocity, nodes, gradient, tensor[point], sizes)
            point += 1
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, sizes)
            weight[point] = rule.weight[q] * inverted(jacobian, inverse)
            physical_gradients(rule, q, inverse, gradient, sizes)
            strain_rate_at(velocity, cells.nodes[cell], gradient, tensor[point], sizes)
            point += 1


@njit(cache=True)
def strain_rate_at(velocity, nodes, gradient, tensor, sizes):
    """Write ∇u + ∇uᵀ at one quadrature point of a cell into ``tensor`` (d, d)."""
    tensor[:] = 0.0
    for i in range(len(sizes.basis)):
        for a in range(len(sizes.axes)):
            for c in range(len(sizes.axes)):
                slope = velocity[nodes[i], a] * gradient[i, c]
                tensor[a, c] += slope
                tensor[c, a] += slope


@njit(cache=True)
def add_stress_load(load, cells, tables, stress):
    """Add (T, ∇v) to ``load`` (nodes, d) for every nodal test function v, ``stress`` T (N, d, d) symmetric."""
    d, sizes = cells.points.shape[1], tables.sizes
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((cells.nodes.shape[1], d))
    point, rule = 0, tables.flat
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, sizes)
        det = inverted(jacobian, inverse)
        for q in range(len(rule.weight)):
            physical_gradients(rule, q, inverse, gradient, sizes)
            add_along(load, nodes, stress[point], gradient, rule.weight[q] * det, sizes)
            point += 1
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, sizes)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            physical_gradients(rule, q, inverse, gradient, sizes)
            add_along(load, cells.nodes[cell], stress[point], gradient, dx, sizes)
            point += 1


@njit(cache=True)
def add_along(load, nodes, stress, gradient, dx, sizes):
    """Add dx T ∇φ of each of a cell's ``nodes`` to its load."""
    for i in range(len(sizes.basis)):
        for a in range(len(sizes.axes)):
            for c in range(len(sizes.axes)):
                load[nodes[i], a] += dx * stress[a, c] * gradient[i, c]


@njit(cache=True)
def add_local_stress(data, cells, sparsity, terms, tables):
    """Add to the entries ``data``, in the order of ``sparsity``, those of the matrix of

    (viscosity (∇u + ∇uᵀ), ∇v) + (slope T:∇u, T:∇v) + (grad_div ∇·u, ∇·v),

    with the direction T, whose coefficients are the ``terms``.
    """
    viscosity, slope, direction, grad_div = terms
    sizes = tables.sizes
    b, d = len(sizes.basis), len(sizes.axes)
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((b, d))
    along, stress, tangent = np.empty(b * d), np.empty((b * d, b * d)), np.empty((b * d, b * d))
    point, rule = 0, tables.flat
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, sizes)
        det = inverted(jacobian, inverse)
        stress[:] = 0.0
        tangent[:] = 0.0
        for q in range(len(rule.weight)):
            physical_gradients(rule, q, inverse, gradient, sizes)
            dx = rule.weight[q] * det
            project(direction[point], gradient, along, sizes)
            add_products(stress, gradient.ravel(), dx * viscosity[point], sizes)
            add_products(tangent, gradient.ravel(), dx * grad_div[cell], sizes)
            add_products(tangent, along, dx * slope[point], sizes)
            point += 1
        scatter_stress(data, sparsity, cell, nodes, stress, tangent, sizes)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        stress[:] = 0.0
        tangent[:] = 0.0
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, sizes)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            physical_gradients(rule, q, inverse, gradient, sizes)
            project(direction[point], gradient, along, sizes)
            add_products(stress, gradient.ravel(), dx * viscosity[point], sizes)
            add_products(tangent, gradient.ravel(), dx * grad_div[cell], sizes)
            add_products(tangent, along, dx * slope[point], sizes)
            point += 1
        scatter_stress(data, sparsity, cell, cells.nodes[cell], stress, tangent, sizes)


@njit(cache=True)
def project(direction, gradient, along, sizes):
    """Write T:∇(φᵢ eₐ) = (T ∇φᵢ)ₐ into ``along`` (b d,)."""
    d = len(sizes.axes)
    for i in range(len(sizes.basis)):
        for a in range(len(sizes.axes)):
            total = 0.0
            for c in range(len(sizes.axes)):
                total += direction[a, c] * gradient[i, c]
            along[i * d + a] = total


@njit(cache=True)
def add_products(matrix, vector, factor, sizes):
    """Add ``factor`` v vᵀ to a ``matrix`` (b d, b d)."""
    for i in range(len(sizes.entries)):
        left = factor * vector[i]
        for j in range(len(sizes.entries)):
            matrix[i, j] += left * vector[j]


@njit(cache=True)
def scatter_stress(data, sparsity, cell, nodes, stress, tangent, sizes):
    """Add one cell's matrix to the entries ``data``: the ``stress`` of ∇u + ∇uᵀ, and the ``tangent`` as it is."""
    b, d = len(sizes.basis), len(sizes.axes)
    ranks = sparsity.ranks[cell]
    for i in range(b):
        for j in range(b):
            scalar = 0.0
            for a in range(d):
                scalar += stress[i * d + a, j * d + a]
            for a in range(d):
                place = sparsity.indptr[nodes[i] * d + a] + d * ranks[i, j]
                for c in range(d):
                    entry = stress[i * d + c, j * d + a] + tangent[i * d + a, j * d + c]
                    data[place + c] += entry + (scalar if a == c else 0.0)
