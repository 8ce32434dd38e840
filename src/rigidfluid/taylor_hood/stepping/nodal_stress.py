"""Stress of a solution at the nodes of its cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.fluid.material import Material
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.quadratic_cells import node_gradients


class NodalStress(NamedTuple):
    """Stress σ (M, b, d, d) [force/length^(d-1)] at the b nodes of M cells, with the ``viscosity`` (M, b) and
    ``gradient`` (M, b, d, d) of the velocity, index of the component first [1/time]."""

    gradient: FloatArray
    viscosity: FloatArray
    stress: FloatArray


def nodal_stress(points: FloatArray, velocity: FloatArray, pressure: FloatArray, material: Material) -> NodalStress:
    """Stress σ = -p 1 + μ(∇u + ∇uᵀ) of each cell by itself, of values at its b nodes: ``points`` and ``velocity`` (M,
    b, d), ``pressure`` (M, b)."""
    gradient = node_gradients(points, velocity)
    strain = gradient + gradient.swapaxes(2, 3)
    viscosity = material.viscosity(np.sqrt(0.5 * np.sum(strain**2, axis=(2, 3))).ravel()).reshape(pressure.shape)
    stress = viscosity[..., None, None] * strain
    stress -= pressure[..., None, None] * np.eye(points.shape[2])
    return NodalStress(gradient, viscosity, stress)
