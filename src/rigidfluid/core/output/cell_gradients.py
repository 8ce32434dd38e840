"""Quadratic fields within their cells: velocity gradients, vorticity and shear rate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.curl import curl
from rigidfluid.core.geometry.quadratic_cells import node_gradients
from rigidfluid.core.model.types import Fields

_AT_ONCE = 20_000
"""Cells whose gradients are in memory at a time."""


def velocity_gradients(fields: Fields) -> FloatArray:
    """∂u_i/∂x_j at the b nodes of each of M cells, (M, b, d, d), index i before j [1/time].

    Each cell is differentiated by itself, and its sides may be curved: u and x are both quadratic in the cell's own
    coordinates. A node has one gradient for each cell around it.
    """
    return node_gradients(fields.points[fields.cells], fields.velocity[fields.cells])


def vorticity(fields: Fields) -> FloatArray:
    """ω = ∇ × u at the nodes of each cell, (M, b, k), in 2D its one component [1/time]."""
    return curl(velocity_gradients(fields))


def nodal_vorticity(fields: Fields) -> FloatArray:
    """ω at the nodes, (N, k), the mean over the cells around each, in 2D its one component [1/time]."""
    return _nodal_means(fields, vorticity, (1 if fields.points.shape[1] == 2 else 3,))


def nodal_shear_rate(fields: Fields) -> FloatArray:
    """γ̇ = √(½|∇u + ∇uᵀ|²) at the nodes, (N,), of the mean gradient over the cells around each [1/time]."""
    gradient = _nodal_means(fields, velocity_gradients, (fields.points.shape[1],) * 2)
    return np.asarray(np.linalg.norm(gradient + gradient.swapaxes(1, 2), axis=(1, 2)) * np.sqrt(0.5))


def _nodal_means(fields: Fields, quantity: Callable[[Fields], FloatArray], shape: tuple[int, ...]) -> FloatArray:
    """Mean at the nodes (N, …) of what cells have at their nodes (M, b, …), of that ``shape``."""
    count = len(fields.points)
    around = np.bincount(fields.cells.ravel(), minlength=count)
    total = np.zeros((count, *shape))
    for start in range(0, len(fields.cells), _AT_ONCE):
        some = replace(fields, cells=fields.cells[start : start + _AT_ONCE])
        np.add.at(total, some.cells, quantity(some))
    return total / around.reshape(-1, *(1 for _ in shape))
