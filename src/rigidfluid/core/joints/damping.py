"""Dampers over a time in which they alone change how fast they are stretched, and a constant push."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

_SMALL = 1e-3


def damper_impulse(
    delassus: FloatArray, compliance: FloatArray, before: FloatArray, undamped: FloatArray, time: float
) -> FloatArray:
    """Impulse (c,) -∫ s/compliance of ds/dt = a - delassus · s/compliance over ``time`` [force·time |
    force·length·time].

    a is the rate that leads from the rates of stretch ``before`` (c,) to ``undamped`` (c,) without dampers,
    ``delassus`` (c, c) the inverse mass C W Cᵀ between dampers, ``compliance`` (c,) 1/damping. In the modes of
    delassus/compliance it is exact: so dampers of any strength give no energy.
    """
    root = 1.0 / np.sqrt(compliance)
    decay, modes = np.linalg.eigh(root[:, None] * delassus * root)
    first, second = _phi(np.maximum(decay, 0.0) * time)
    start, gained = modes.T @ (root * before), modes.T @ (root * (undamped - before))
    return np.asarray(-time * root * (modes @ (first * start + second * gained)), dtype=np.float64)


def _phi(z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """φ₁ = (1 - e⁻ᶻ)/z and φ₂ = (1 - φ₁)/z."""
    small, safe = z < _SMALL, np.where(z < _SMALL, 1.0, z)
    first = np.where(small, 1.0 - z / 2.0 + z**2 / 6.0 - z**3 / 24.0, -np.expm1(-safe) / safe)
    return first, np.where(small, 0.5 - z / 6.0 + z**2 / 24.0 - z**3 / 120.0, (1.0 - first) / safe)
