"""Compiled loop over cells for the matrix of a transported scalar; its arrays are those of `kernels`."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.backends.scikit_fem.kernels import (
    along_reference,
    curved_jacobian,
    inverted,
    physical_gradients,
    straight_jacobian,
)


@njit(cache=True)
def add_transport(scalar, rule, q, dx, flow, sizes):
    """Add -(c φⱼ, ∇φᵢ) at point ``q`` of a ``rule`` to ``scalar`` (b, b); ``flow`` c (b, d) by `along_reference`."""
    for i in range(len(sizes.basis)):
        along = 0.0
        for r in range(len(sizes.axes)):
            speed = 0.0
            for k in range(len(sizes.basis)):
                speed += rule.value[q, k] * flow[k, r]
            along += speed * rule.gradient[q, i, r]
        for j in range(len(sizes.basis)):
            scalar[i, j] -= dx * along * rule.value[q, j]


@njit(cache=True)
def add_diffusion(scalar, gradient, factor, sizes):
    """Add ``factor`` ∇φⱼ·∇φᵢ to ``scalar`` (b, b), of gradients (b, d)."""
    for i in range(len(sizes.basis)):
        for j in range(len(sizes.basis)):
            total = 0.0
            for a in range(len(sizes.axes)):
                total += gradient[i, a] * gradient[j, a]
            scalar[i, j] += factor * total


@njit(cache=True)
def assemble_scalar(data, cells, pattern, terms, tables):
    """Add to the entries ``data``, in the order of the nodes' ``pattern``, those of inertia (T, v) - (c T, ∇v) +
    diffusivity (∇T, ∇v), whose coefficients are the ``terms``."""
    inertia, diffusivity, flow = terms
    sizes = tables.sizes
    b, d = len(sizes.basis), len(sizes.axes)
    jacobian, inverse, gradient = np.empty((d, d)), np.empty((d, d)), np.empty((b, d))
    flowing, scalar = np.empty((b, d)), np.empty((b, b))
    moving = np.any(flow)
    for cell in cells.straight:
        nodes = cells.nodes[cell]
        straight_jacobian(cells.points, nodes, jacobian, sizes)
        det = inverted(jacobian, inverse)
        for i in range(b):
            for j in range(b):
                scalar[i, j] = inertia * det * tables.mass[i, j]
        if moving:
            rule = tables.cubic
            along_reference(flow, nodes, inverse, flowing, sizes)
            for q in range(len(rule.weight)):
                add_transport(scalar, rule, q, rule.weight[q] * det, flowing, sizes)
        rule = tables.flat
        for q in range(len(rule.weight)):
            physical_gradients(rule, q, inverse, gradient, sizes)
            add_diffusion(scalar, gradient, diffusivity * rule.weight[q] * det, sizes)
        scatter_scalar(data, pattern, cell, scalar, sizes)
    rule = tables.curved
    for number, cell in enumerate(cells.curved):
        nodes = cells.nodes[cell]
        scalar[:] = 0.0
        for q in range(len(rule.weight)):
            curved_jacobian(cells.curved_points[number], rule.gradient[q], jacobian, sizes)
            dx = rule.weight[q] * inverted(jacobian, inverse)
            for i in range(b):
                for j in range(b):
                    scalar[i, j] += inertia * dx * rule.value[q, i] * rule.value[q, j]
            if moving:
                along_reference(flow, nodes, inverse, flowing, sizes)
                add_transport(scalar, rule, q, dx, flowing, sizes)
            physical_gradients(rule, q, inverse, gradient, sizes)
            add_diffusion(scalar, gradient, diffusivity * dx, sizes)
        scatter_scalar(data, pattern, cell, scalar, sizes)


@njit(cache=True)
def scatter_scalar(data, pattern, cell, scalar, sizes):
    """Add one cell's matrix ``scalar`` (b, b) to the entries ``data``."""
    nodes, ranks = pattern.nodes[cell], pattern.ranks[cell]
    for i in range(len(sizes.basis)):
        for j in range(len(sizes.basis)):
            data[pattern.starts[nodes[i]] + ranks[i, j]] += scalar[i, j]
