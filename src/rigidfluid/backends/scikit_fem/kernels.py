"""Compiled loops over cells: the system matrix, the history's load, energies. Arrays in, arrays out.

``points`` (N, d) vertices, ``cell_vertices`` (M, d+1), ``cell_nodes`` (M, b); fields on nodes are (nodes, d).
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
def inverse_jacobian(points, vertices, inverse):
    """Write the inverse of ∂x/∂X of one cell into ``inverse`` (d, d) and return |det ∂x/∂X|."""
    d = points.shape[1]
    a = np.empty((d, d))
    for i in range(d):
        for j in range(d):
            a[i, j] = points[vertices[j + 1], i] - points[vertices[0], i]
    if d == 2:
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
def assemble(points, cell_vertices, cell_nodes, slots, size, inertia, viscosity, advection, flow,
             value, reference_gradient, weight, flat_gradient, flat_linear, flat_weight, mass):  # fmt: skip
    """Entries (size,) of the matrix of

    inertia (u, v) + (a·∇u, v) + ½ ((∇·c) u, v) + viscosity (∇u + ∇uᵀ, ∇v) - (p, ∇·v) - (∇·u, q).

    ``advection`` a and ``flow`` c, (nodes, d), already hold the density.
    """
    cells, b = cell_nodes.shape
    d = points.shape[1]
    data = np.zeros(size)
    inverse = np.empty((d, d))
    gradient = np.empty((b, d))
    scalar = np.empty((b, b))
    stress = np.empty((b, b, d, d))
    divergence = np.empty((b, d, d + 1))
    moving = np.any(advection) or np.any(flow)
    for cell in range(cells):
        det = inverse_jacobian(points, cell_vertices[cell], inverse)
        scalar[:] = inertia * det * mass
        if moving:
            for q in range(len(weight)):
                physical_gradients(reference_gradient[q], inverse, gradient)
                spread = 0.0
                for i in range(b):
                    for a in range(d):
                        spread += gradient[i, a] * flow[cell_nodes[cell, i], a]
                for j in range(b):
                    along = 0.5 * spread * value[q, j]
                    for a in range(d):
                        speed = 0.0
                        for i in range(b):
                            speed += value[q, i] * advection[cell_nodes[cell, i], a]
                        along += speed * gradient[j, a]
                    along *= weight[q] * det
                    for i in range(b):
                        scalar[i, j] += along * value[q, i]
        stress[:] = 0.0
        divergence[:] = 0.0
        for q in range(len(flat_weight)):
            physical_gradients(flat_gradient[q], inverse, gradient)
            dx = flat_weight[q] * det
            for i in range(b):
                for a in range(d):
                    left = viscosity * dx * gradient[i, a]
                    for j in range(b):
                        for c in range(d):
                            stress[i, j, a, c] += left * gradient[j, c]
                    for k in range(d + 1):
                        divergence[i, a, k] -= dx * gradient[i, a] * flat_linear[q, k]
        for i in range(b):
            for j in range(b):
                diagonal = scalar[i, j]
                for a in range(d):
                    diagonal += stress[i, j, a, a]
                for a in range(d):
                    for c in range(d):
                        data[slots[cell, i * d + a, j * d + c]] += stress[i, j, c, a] + (diagonal if a == c else 0.0)
            for a in range(d):
                for k in range(d + 1):
                    data[slots[cell, i * d + a, b * d + k]] += divergence[i, a, k]
                    data[slots[cell, b * d + k, i * d + a]] += divergence[i, a, k]
    return data


@njit(cache=True)
def apply_mass(points, cell_vertices, cell_nodes, mass, field):
    """(field, v) for every nodal test function v, (nodes, d)."""
    d = points.shape[1]
    inverse = np.empty((d, d))
    result = np.zeros_like(field)
    for cell in range(len(cell_nodes)):
        det = inverse_jacobian(points, cell_vertices[cell], inverse)
        for i, row in enumerate(cell_nodes[cell]):
            for j, column in enumerate(cell_nodes[cell]):
                for a in range(d):
                    result[row, a] += det * mass[i, j] * field[column, a]
    return result


@njit(cache=True)
def strain_square(points, cell_vertices, cell_nodes, flat_gradient, flat_weight, velocity):
    """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) over the mesh; times the viscosity it is the dissipation."""
    d = points.shape[1]
    b = cell_nodes.shape[1]
    inverse = np.empty((d, d))
    gradient = np.empty((b, d))
    slope = np.empty((d, d))
    total = 0.0
    for cell in range(len(cell_nodes)):
        det = inverse_jacobian(points, cell_vertices[cell], inverse)
        for q in range(len(flat_weight)):
            physical_gradients(flat_gradient[q], inverse, gradient)
            slope[:] = 0.0
            for i, node in enumerate(cell_nodes[cell]):
                for a in range(d):
                    for c in range(d):
                        slope[a, c] += velocity[node, a] * gradient[i, c]
            for a in range(d):
                for c in range(d):
                    total += 0.5 * det * flat_weight[q] * (slope[a, c] + slope[c, a]) ** 2
    return total
