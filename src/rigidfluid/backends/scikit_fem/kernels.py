"""Compiled loops over cells: the system matrix, the history's load, energies. Arrays in, arrays out.

Fields on nodes are (nodes, d). ``cells``, ``tables``, ``pattern`` and ``sparsity`` are those of `assembly`: straight
cells are mapped by one matrix each, curved ones at each quadrature point by another. Loops over the basis and over axes
go by the lengths of tuples, ``sizes``: known when they are compiled, so that they are unrolled.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from rigidfluid.core.geometry.arrays import FloatArray

if TYPE_CHECKING:
    from rigidfluid.backends.scikit_fem.assembly import Sizes


class CellMasses(NamedTuple):
    """The mass matrix ``scalar`` (b, b) of a cell and its ``flux`` (b d, d+1), -(∇·u, q)."""

    scalar: FloatArray
    flux: FloatArray
    sizes: Sizes


@njit(cache=True)
def neighbours(cell_nodes, nodes):
    """The pattern that nodes have with nodes, (nodes + 1,) and (entries,) sorted; and of each cell's nodes i and j the
    place of j among the neighbours of i, (M, b, b)."""
    cells, width = cell_nodes.shape
    first = np.zeros(nodes + 1, np.int64)
    for cell in range(cells):
        for i in range(width):
            first[cell_nodes[cell, i] + 1] += 1
    first = np.cumsum(first)
    around, filled = np.empty(cells * width, np.int64), first[:-1].copy()  # each node's places in ``cell_nodes``
    for cell in range(cells):
        for i in range(width):
            around[filled[cell_nodes[cell, i]]] = cell * width + i
            filled[cell_nodes[cell, i]] += 1
    indptr, indices = np.zeros(nodes + 1, np.int32), np.empty(cells * width * width, np.int32)
    ranks, rank = np.empty((cells, width, width), np.int16), np.full(nodes, -1, np.int16)
    for node in range(nodes):
        count = indptr[node]
        for place in around[first[node] : first[node + 1]]:
            for other in cell_nodes[place // width]:
                if rank[other] < 0:
                    rank[other] = 0
                    indices[count] = other
                    count += 1
        indptr[node + 1] = count
        found = indices[indptr[node] : count]
        found.sort()
        for number in range(len(found)):
            rank[found[number]] = number
        for place in around[first[node] : first[node + 1]]:
            for j in range(width):
                ranks[place // width, place % width, j] = rank[cell_nodes[place // width, j]]
        rank[found] = -1
    return indptr, indices[: indptr[-1]].copy(), ranks


@njit(cache=True)
def expand(indptr, indices, vertices, dimension):
    """The matrix' pattern in rows, (unknowns + 1,) and (entries,), of the pattern that nodes have with nodes."""
    nodes = len(indptr) - 1
    wide_indptr = np.empty(nodes * dimension + vertices + 1, np.int32)
    wide_indptr[0] = 0
    lengths = np.empty(nodes, np.int64)
    for node in range(nodes):
        around = indices[indptr[node] : indptr[node + 1]]
        lengths[node] = dimension * len(around) + np.searchsorted(around, vertices)
    for row in range(len(wide_indptr) - 1):
        node = row // dimension if row < nodes * dimension else row - nodes * dimension
        wide_indptr[row + 1] = wide_indptr[row] + lengths[node]
    wide = np.empty(wide_indptr[-1], np.int32)
    for row in range(len(wide_indptr) - 1):
        node = row // dimension if row < nodes * dimension else row - nodes * dimension
        place = wide_indptr[row]
        for slot in range(indptr[node], indptr[node + 1]):
            for axis in range(dimension):
                wide[place] = indices[slot] * dimension + axis
                place += 1
        for slot in range(indptr[node], indptr[node + 1]):
            if indices[slot] >= vertices:
                break
            wide[place] = nodes * dimension + indices[slot]
            place += 1
    return wide_indptr, wide


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
def straight_jacobian(points, nodes, jacobian, sizes):
    """Write ∂x/∂X of one straight cell into ``jacobian`` (d, d)."""
    for i in range(len(sizes.axes)):
        for j in range(len(sizes.axes)):
            jacobian[i, j] = points[nodes[j + 1], i] - points[nodes[0], i]


@njit(cache=True)
def curved_jacobian(node_points, reference, jacobian, sizes):
    """Write ∂x/∂X of one cell with nodes at ``node_points`` (b, d) into ``jacobian`` (d, d), where the basis has the
    gradients ``reference`` (b, d)."""
    jacobian[:] = 0.0
    for node in range(len(sizes.basis)):
        for i in range(len(sizes.axes)):
            for j in range(len(sizes.axes)):
                jacobian[i, j] += node_points[node, i] * reference[node, j]


@njit(cache=True)
def physical_gradients(rule, q, inverse, gradient, sizes):
    """Write ∂φ/∂x = J⁻ᵀ ∂φ/∂X at point ``q`` of a ``rule`` into ``gradient`` (b, d)."""
    for i in range(len(sizes.basis)):
        for a in range(len(sizes.axes)):
            total = 0.0
            for r in range(len(sizes.axes)):
                total += rule.gradient[q, i, r] * inverse[r, a]
            gradient[i, a] = total


@njit(cache=True)
def along_reference(field, nodes, inverse, image, sizes):
    """Write J⁻¹ c into ``image`` (b, d), c being a ``field`` at one cell's ``nodes``: c·∇φ = J⁻¹c · ∂φ/∂X."""
    for i in range(len(sizes.basis)):
        for r in range(len(sizes.axes)):
            total = 0.0
            for a in range(len(sizes.axes)):
                total += inverse[r, a] * field[nodes[i], a]
            image[i, r] = total


@njit(cache=True)
def add_convection(scalar, rule, q, dx, advection, flow, room, sizes):
    """Add (a·∇u, v) + ½ ((∇·c) u, v) at point ``q`` of a ``rule`` to ``scalar`` (b, b).

    ``advection`` a and ``flow`` c (b, d) by `along_reference`; ``room`` (b,) is overwritten.
    """
    value, reference = rule.value, rule.gradient
    spread = 0.0
    for i in range(len(sizes.basis)):
        for r in range(len(sizes.axes)):
            spread += reference[q, i, r] * flow[i, r]
    for j in range(len(sizes.basis)):
        room[j] = 0.5 * dx * spread * value[q, j]
    for r in range(len(sizes.axes)):
        speed = 0.0
        for i in range(len(sizes.basis)):
            speed += value[q, i] * advection[i, r]
        for j in range(len(sizes.basis)):
            room[j] += dx * speed * reference[q, j, r]
    for i in range(len(sizes.basis)):
        for j in range(len(sizes.basis)):
            scalar[i, j] += value[q, i] * room[j]


@njit(cache=True)
def add_stress(stress, divergence, rule, q, gradient, viscosity, dx, sizes):
    """Add viscosity ∂φᵢ/∂xₐ ∂φⱼ/∂x_c at point ``q`` of a ``rule`` to ``stress`` (b d, b d) and -ψₖ ∂φᵢ/∂xₐ to
    ``divergence`` (b d, d+1)."""
    flat = gradient.ravel()
    for i in range(len(sizes.entries)):
        left = viscosity * dx * flat[i]
        for j in range(len(sizes.entries)):
            stress[i, j] += left * flat[j]
        for k in range(len(sizes.axes) + 1):
            divergence[i, k] -= dx * flat[i] * rule.linear[q, k]


@njit(cache=True)
def scatter(data, sparsity, cell, nodes, scalar, stress, grad_div, divergence, sizes):
    """Add one cell's matrix to the entries ``data``: ``scalar``, the stress of ∇u + ∇uᵀ, ``grad_div`` times that of
    (∇·u) 1, and the pressures'."""
    b, d = len(sizes.basis), len(sizes.axes)
    ranks = sparsity.ranks[cell]
    for i in range(b):
        for j in range(b):
            for a in range(d):
                scalar[i, j] += stress[i * d + a, j * d + a]
    for i in range(b):
        for a in range(d):
            row = nodes[i] * d + a
            first, last = sparsity.indptr[row], sparsity.indptr[row + 1]
            for j in range(b):
                place = first + d * ranks[i, j]
                for c in range(d):
                    entry = stress[i * d + c, j * d + a] + grad_div * stress[i * d + a, j * d + c]
                    data[place + c] += entry + (scalar[i, j] if a == c else 0.0)
            place = last - sparsity.vertices_around[nodes[i]]
            for k in range(d + 1):
                data[place + ranks[i, k]] += divergence[i * d + a, k]
    for k in range(d + 1):
        first = sparsity.indptr[sparsity.first_pressure + nodes[k]]
        for j in range(b):
            place = first + d * ranks[k, j]
            for a in range(d):
                data[place + a] += divergence[j * d + a, k]


@njit(cache=True)
def assemble(data, cells, sparsity, terms, tables):
    """Add to the entries ``data``, in the order of ``sparsity``, those of the matrix of

    inertia (u, v) + (a·∇u, v) + ½ ((∇·c) u, v) + viscosity ((∇u + ∇uᵀ, ∇v) + (r ∇·u, ∇·v)) - (p, ∇·v) - (∇·u, q),

    whose coefficients are the ``terms``.
    """
    inertia, viscosity, advection, flow, grad_div = terms
    sizes = tables.sizes
    b, d = len(sizes.basis), len(sizes.axes)
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((b, d))
    advected, flowing, room = np.empty((b, d)), np.empty((b, d)), np.empty(b)
    scalar, stress, divergence = np.empty((b, b)), np.empty((b * d, b * d)), np.empty((b * d, d + 1))
    moving = np.any(advection) or np.any(flow)
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, sizes)
        det = inverted(jacobian, inverse)
        for i in range(b):
            for j in range(b):
                scalar[i, j] = inertia * det * tables.mass[i, j]
        if moving:
            rule = tables.cubic
            along_reference(advection, nodes, inverse, advected, sizes)
            along_reference(flow, nodes, inverse, flowing, sizes)
            for q in range(len(rule.weight)):
                dx = rule.weight[q] * det
                add_convection(scalar, rule, q, dx, advected, flowing, room, sizes)
        stress[:] = 0.0
        divergence[:] = 0.0
        rule = tables.flat
        for q in range(len(rule.weight)):
            physical_gradients(rule, q, inverse, gradient, sizes)
            add_stress(stress, divergence, rule, q, gradient, viscosity, rule.weight[q] * det, sizes)
        scatter(data, sparsity, cell, nodes, scalar, stress, grad_div[cell], divergence, sizes)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        nodes = cells.nodes[cell]
        scalar[:] = 0.0
        stress[:] = 0.0
        divergence[:] = 0.0
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, tables.sizes)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            for i in range(b):
                for j in range(b):
                    scalar[i, j] += inertia * dx * rule.value[q, i] * rule.value[q, j]
            if moving:
                along_reference(advection, nodes, inverse, advected, sizes)
                along_reference(flow, nodes, inverse, flowing, sizes)
                add_convection(scalar, rule, q, dx, advected, flowing, room, sizes)
            physical_gradients(rule, q, inverse, gradient, sizes)
            add_stress(stress, divergence, rule, q, gradient, viscosity, dx, sizes)
        scatter(data, sparsity, cell, nodes, scalar, stress, grad_div[cell], divergence, sizes)


@njit(cache=True)
def assemble_masses(mass, divergence, cells, pattern, tables):
    """Add (φⱼ, φᵢ) to ``mass`` and -(∇·u, q) to ``divergence``, on the ``pattern`` of the nodes; the divergence has d
    columns for each neighbour."""
    sizes = tables.sizes
    b, d = len(sizes.basis), len(sizes.axes)
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((b, d))
    scalar, flux = np.empty((b, b)), np.empty((b * d, d + 1))
    masses = CellMasses(scalar, flux, sizes)
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, sizes)
        det = inverted(jacobian, inverse)
        for i in range(b):
            for j in range(b):
                scalar[i, j] = det * tables.mass[i, j]
        for i in range(len(sizes.basis)):
            for a in range(len(sizes.axes)):
                for k in range(len(sizes.axes) + 1):
                    total = 0.0
                    for r in range(len(sizes.axes)):
                        total += inverse[r, a] * tables.flux[i, r, k]
                    flux[i * d + a, k] = det * total
        scatter_masses(mass, divergence, pattern, cell, masses)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        scalar[:] = 0.0
        flux[:] = 0.0
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, tables.sizes)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            for i in range(len(sizes.basis)):
                left = dx * rule.value[q, i]
                for j in range(len(sizes.basis)):
                    scalar[i, j] += left * rule.value[q, j]
            physical_gradients(rule, q, inverse, gradient, sizes)
            for i in range(len(sizes.basis)):
                for a in range(len(sizes.axes)):
                    for k in range(len(sizes.axes) + 1):
                        flux[i * d + a, k] -= dx * gradient[i, a] * rule.linear[q, k]
        scatter_masses(mass, divergence, pattern, cell, masses)


@njit(cache=True)
def scatter_masses(mass, divergence, pattern, cell, masses):
    """Add one cell's ``masses`` to the entries of `assemble_masses`."""
    scalar, flux, sizes = masses
    b, d = len(sizes.basis), len(sizes.axes)
    starts, nodes, ranks = pattern.starts, pattern.nodes[cell], pattern.ranks[cell]
    for i in range(b):
        for j in range(b):
            mass[starts[nodes[i]] + ranks[i, j]] += scalar[i, j]
    for k in range(d + 1):
        for j in range(b):
            place = d * (starts[nodes[k]] + ranks[k, j])
            for a in range(d):
                divergence[place + a] += flux[j * d + a, k]


@njit(cache=True)
def apply_mass(cells, tables, field):
    """(field, v) for every nodal test function v, (nodes, d)."""
    d = cells.points.shape[1]
    jacobian, inverse, mass = np.empty((d, d)), np.empty((d, d)), np.empty_like(tables.mass)
    result = np.zeros_like(field)
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, tables.sizes)
        add_product(result, inverted(jacobian, inverse), tables.mass, nodes, field, tables.sizes)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        mass[:] = 0.0
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, tables.sizes)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            for i in range(len(mass)):
                for j in range(len(mass)):
                    mass[i, j] += dx * rule.value[q, i] * rule.value[q, j]
        add_product(result, 1.0, mass, cells.nodes[cell], field, tables.sizes)
    return result


@njit(cache=True)
def add_product(result, factor, mass, nodes, field, sizes):
    """Add ``factor`` times one cell's ``mass`` (b, b) times the field at its ``nodes``."""
    for a in range(len(sizes.axes)):
        for i in range(len(sizes.basis)):
            total = 0.0
            for j in range(len(sizes.basis)):
                total += mass[i, j] * field[nodes[j], a]
            result[nodes[i], a] += factor * total


@njit(cache=True)
def strain_square(cells, tables, velocity):
    """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) over the mesh; times the viscosity it is the dissipation."""
    d = cells.points.shape[1]
    jacobian, inverse, slope = np.empty((d, d)), np.empty((d, d)), np.empty((d, d))
    gradient = np.empty((cells.nodes.shape[1], d))
    total = 0.0
    rule = tables.flat
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, tables.sizes)
        det = inverted(jacobian, inverse)
        for q in range(len(rule.weight)):
            physical_gradients(rule, q, inverse, gradient, tables.sizes)
            total += det * rule.weight[q] * strain_square_at(velocity, nodes, gradient, slope, tables.sizes)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, tables.sizes)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            physical_gradients(rule, q, inverse, gradient, tables.sizes)
            total += dx * strain_square_at(velocity, cells.nodes[cell], gradient, slope, tables.sizes)
    return total


@njit(cache=True)
def divergence_square(cells, tables, velocity, weight):
    """∫ w (∇·u)² over the mesh, with the ``weight`` w (M,) of each cell."""
    d = cells.points.shape[1]
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((cells.nodes.shape[1], d))
    total = 0.0
    rule = tables.flat
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, tables.sizes)
        dx = weight[cell] * inverted(jacobian, inverse)
        for q in range(len(rule.weight)):
            physical_gradients(rule, q, inverse, gradient, tables.sizes)
            total += dx * rule.weight[q] * divergence_at(velocity, nodes, gradient, tables.sizes) ** 2
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, tables.sizes)
            dx = weight[cell] * rule.weight[q] * inverted(jacobian, inverse)
            physical_gradients(rule, q, inverse, gradient, tables.sizes)
            total += dx * divergence_at(velocity, cells.nodes[cell], gradient, tables.sizes) ** 2
    return total


@njit(cache=True)
def divergence_at(velocity, nodes, gradient, sizes):
    """∇·u at one quadrature point of a cell."""
    total = 0.0
    for i in range(len(sizes.basis)):
        for a in range(len(sizes.axes)):
            total += velocity[nodes[i], a] * gradient[i, a]
    return total


@njit(cache=True)
def strain_square_at(velocity, nodes, gradient, slope, sizes):
    """½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) at one quadrature point of a cell; ``slope`` (d, d) is room for ∇u."""
    slope[:] = 0.0
    for i in range(len(sizes.basis)):
        for a in range(len(sizes.axes)):
            for c in range(len(sizes.axes)):
                slope[a, c] += velocity[nodes[i], a] * gradient[i, c]
    total = 0.0
    for a in range(len(sizes.axes)):
        for c in range(len(sizes.axes)):
            total += 0.5 * (slope[a, c] + slope[c, a]) ** 2
    return total
