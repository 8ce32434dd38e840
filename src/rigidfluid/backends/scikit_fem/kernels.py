"""Compiled loops over cells: the system matrix, the history's load, energies. Arrays in, arrays out.

``points`` (N, d) starts with the vertices; fields on nodes are (nodes, d). ``cells`` and ``tables`` are those of
`assembly`: straight cells are mapped by one matrix each, curved ones at each quadrature point by another.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def slots(indptr, indices, unknowns):
    """Position in a sorted CSR matrix of each entry of each cell's matrix, (M, width, width)."""
    cells, width = unknowns.shape
    result = np.empty((cells, width, width), np.int32)
    for cell in range(cells):
        for i in range(width):
            row = unknowns[cell, i]
            first, last = indptr[row], indptr[row + 1]
            for j in range(width):
                result[cell, i, j] = first + np.searchsorted(indices[first:last], unknowns[cell, j])
    return result


@njit(cache=True)
def inverted(jacobian, inverse):
    """Write the inverse of ∂x/∂X (d, d) into ``inverse`` and return |det ∂x/∂X|."""
    a = jacobian
    if len(a) == 2:
        det = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
        inverse[0, 0], inverse[0, 1] = a[1, 1] / det, -a[0, 1] / det
        inverse[1, 0], inverse[1, 1] = -a[1, 0] / det, a[0, 0] / det
        return abs(det)
    det = 0.0
    for i in range(3):
        p, q = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            r, s = (j + 1) % 3, (j + 2) % 3
            inverse[j, i] = a[p, r] * a[q, s] - a[p, s] * a[q, r]
        det += a[i, 0] * inverse[0, i]
    inverse /= det
    return abs(det)


@njit(cache=True)
def straight_jacobian(points, vertices, jacobian):
    """Write ∂x/∂X of one straight cell into ``jacobian`` (d, d)."""
    d = points.shape[1]
    for i in range(d):
        for j in range(d):
            jacobian[i, j] = points[vertices[j + 1], i] - points[vertices[0], i]


@njit(cache=True)
def curved_jacobian(node_points, reference, jacobian):
    """Write ∂x/∂X of one cell with nodes at ``node_points`` (b, d) into ``jacobian`` (d, d), where the basis has the
    gradients ``reference`` (b, d)."""
    jacobian[:] = 0.0
    for node in range(len(reference)):
        for i in range(node_points.shape[1]):
            for j in range(reference.shape[1]):
                jacobian[i, j] += node_points[node, i] * reference[node, j]


@njit(cache=True)
def physical_gradients(reference, inverse, gradient):
    """Write ∂φ/∂x = J⁻ᵀ ∂φ/∂X at one quadrature point into ``gradient`` (b, d)."""
    count, d = reference.shape
    for i in range(count):
        for a in range(d):
            total = 0.0
            for r in range(d):
                total += reference[i, r] * inverse[r, a]
            gradient[i, a] = total


@njit(cache=True)
def add_convection(scalar, value, gradient, dx, nodes, advection, flow):
    """Add (a·∇u, v) + ½ ((∇·c) u, v) at one quadrature point to ``scalar`` (b, b)."""
    b, d = gradient.shape
    spread = 0.0
    for i in range(b):
        for a in range(d):
            spread += gradient[i, a] * flow[nodes[i], a]
    for j in range(b):
        along = 0.5 * spread * value[j]
        for a in range(d):
            speed = 0.0
            for i in range(b):
                speed += value[i] * advection[nodes[i], a]
            along += speed * gradient[j, a]
        along *= dx
        for i in range(b):
            scalar[i, j] += along * value[i]


@njit(cache=True)
def add_stress(stress, divergence, linear, gradient, viscosity, dx):
    """Add viscosity ∂φᵢ/∂xₐ ∂φⱼ/∂x_c at one quadrature point to ``stress`` (b, b, d, d) and -ψₖ ∂φᵢ/∂xₐ to
    ``divergence`` (b, d, d+1)."""
    b, d = gradient.shape
    for i in range(b):
        for a in range(d):
            left = viscosity * dx * gradient[i, a]
            for j in range(b):
                for c in range(d):
                    stress[i, j, a, c] += left * gradient[j, c]
            for k in range(d + 1):
                divergence[i, a, k] -= dx * gradient[i, a] * linear[k]


@njit(cache=True)
def scatter(data, slots, scalar, stress, divergence):
    """Add one cell's matrix to the entries ``data``: ``scalar`` and the stress of ∇u + ∇uᵀ, and the pressures'."""
    b, d = divergence.shape[:2]
    for i in range(b):
        for j in range(b):
            diagonal = scalar[i, j]
            for a in range(d):
                diagonal += stress[i, j, a, a]
            for a in range(d):
                for c in range(d):
                    data[slots[i * d + a, j * d + c]] += stress[i, j, c, a] + (diagonal if a == c else 0.0)
        for a in range(d):
            for k in range(d + 1):
                data[slots[i * d + a, b * d + k]] += divergence[i, a, k]
                data[slots[b * d + k, i * d + a]] += divergence[i, a, k]


@njit(cache=True)
def assemble(points, cells, slots, size, inertia, viscosity, advection, flow, tables):
    """Entries (size,) of the matrix of

    inertia (u, v) + (a·∇u, v) + ½ ((∇·c) u, v) + viscosity (∇u + ∇uᵀ, ∇v) - (p, ∇·v) - (∇·u, q).

    ``advection`` a and ``flow`` c, (nodes, d), already hold the density.
    """
    b, d = tables.mass.shape[0], points.shape[1]
    data = np.zeros(size)
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((b, d))
    scalar, stress, divergence = np.empty((b, b)), np.empty((b, b, d, d)), np.empty((b, d, d + 1))
    moving = np.any(advection) or np.any(flow)
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(points, nodes, jacobian)
        det = inverted(jacobian, inverse)
        scalar[:] = inertia * det * tables.mass
        if moving:
            rule = tables.cubic
            for q in range(len(rule.weight)):
                physical_gradients(rule.gradient[q], inverse, gradient)
                add_convection(scalar, rule.value[q], gradient, rule.weight[q] * det, nodes, advection, flow)
        stress[:] = 0.0
        divergence[:] = 0.0
        rule = tables.flat
        for q in range(len(rule.weight)):
            physical_gradients(rule.gradient[q], inverse, gradient)
            add_stress(stress, divergence, rule.linear[q], gradient, viscosity, rule.weight[q] * det)
        scatter(data, slots[cell], scalar, stress, divergence)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        nodes = cells.nodes[cell]
        scalar[:] = 0.0
        stress[:] = 0.0
        divergence[:] = 0.0
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            physical_gradients(rule.gradient[q], inverse, gradient)
            for i in range(b):
                for j in range(b):
                    scalar[i, j] += inertia * dx * rule.value[q, i] * rule.value[q, j]
            if moving:
                add_convection(scalar, rule.value[q], gradient, dx, nodes, advection, flow)
            add_stress(stress, divergence, rule.linear[q], gradient, viscosity, dx)
        scatter(data, slots[cell], scalar, stress, divergence)
    return data


@njit(cache=True)
def apply_mass(points, cells, tables, field):
    """(field, v) for every nodal test function v, (nodes, d)."""
    d = points.shape[1]
    jacobian, inverse, mass = np.empty((d, d)), np.empty((d, d)), np.empty_like(tables.mass)
    result = np.zeros_like(field)
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(points, nodes, jacobian)
        add_product(result, inverted(jacobian, inverse), tables.mass, nodes, field)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        mass[:] = 0.0
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            for i in range(len(mass)):
                for j in range(len(mass)):
                    mass[i, j] += dx * rule.value[q, i] * rule.value[q, j]
        add_product(result, 1.0, mass, cells.nodes[cell], field)
    return result


@njit(cache=True)
def add_product(result, factor, mass, nodes, field):
    """Add ``factor`` times one cell's ``mass`` (b, b) times the field at its ``nodes``."""
    for i, row in enumerate(nodes):
        for j, column in enumerate(nodes):
            for a in range(field.shape[1]):
                result[row, a] += factor * mass[i, j] * field[column, a]


@njit(cache=True)
def strain_square(points, cells, tables, velocity):
    """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) over the mesh; times the viscosity it is the dissipation."""
    d = points.shape[1]
    jacobian, inverse, slope = np.empty((d, d)), np.empty((d, d)), np.empty((d, d))
    gradient = np.empty((cells.nodes.shape[1], d))
    total = 0.0
    rule = tables.flat
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(points, nodes, jacobian)
        det = inverted(jacobian, inverse)
        for q in range(len(rule.weight)):
            physical_gradients(rule.gradient[q], inverse, gradient)
            total += det * rule.weight[q] * strain_square_at(velocity, nodes, gradient, slope)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            physical_gradients(rule.gradient[q], inverse, gradient)
            total += dx * strain_square_at(velocity, cells.nodes[cell], gradient, slope)
    return total


@njit(cache=True)
def strain_square_at(velocity, nodes, gradient, slope):
    """½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) at one quadrature point of a cell; ``slope`` (d, d) is room for ∇u."""
    d = len(slope)
    slope[:] = 0.0
    for i, node in enumerate(nodes):
        for a in range(d):
            for c in range(d):
                slope[a, c] += velocity[node, a] * gradient[i, c]
    total = 0.0
    for a in range(d):
        for c in range(d):
            total += 0.5 * (slope[a, c] + slope[c, a]) ** 2
    return total
