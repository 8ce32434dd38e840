"""Coulomb's friction of a spring and a dashpot along surfaces, and the dashpot of a spring with a given restitution."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray


def held_displacement(
    stiffness: FloatArray, damped: FloatArray, most: FloatArray, displacement: FloatArray
) -> FloatArray:
    """Part ξ (m, d) of a ``displacement`` (m, d) that friction holds, with |k ξ + f| ≤ ``most`` (m,) and k ξ + f along
    that of the whole displacement [length]; ``stiffness`` k (m,) [force/length], f = ``damped`` (m, d) [force]."""
    column = stiffness[:, None]
    whole = column * displacement + damped
    held = _shortened(most, whole)
    slipped = np.divide(held - damped, column, out=np.zeros_like(displacement), where=column > 0.0)
    sticks = np.all(held == whole, axis=1, keepdims=True) & (column > 0.0)
    return np.where(sticks, displacement, slipped)


def sliding_friction(coefficient: FloatArray, most: FloatArray, velocity: FloatArray) -> FloatArray:
    """Force min(γ |v|, ``most``) v/|v|, zero at rest, (m, d) [force]; ``coefficient`` γ (m,) [force·time/length]."""
    speed = np.linalg.norm(velocity, axis=1)
    ratio = np.minimum(coefficient, np.divide(most, speed, out=np.full_like(speed, np.inf), where=speed > 0.0))
    return np.asarray(ratio[:, None] * velocity)


def dashpot_coefficient(restitution: float, stiffness: FloatArray | float, mass: FloatArray) -> FloatArray:
    """Coefficient γ = -2 ln e √(m k/(π² + ln² e)) of the dashpot beside a spring, (m,), with which half a swing leaves
    e times the speed [force·time/length]."""
    logarithm = np.log(restitution)
    return np.asarray(-2.0 * logarithm * np.sqrt(mass * stiffness / (np.pi**2 + logarithm**2)))


def _shortened(most: FloatArray, force: FloatArray) -> FloatArray:
    """Forces (m, d) shortened to ``most`` (m,) where they are longer."""
    size = np.linalg.norm(force, axis=1)
    part = np.divide(most, size, out=np.ones_like(size), where=size > most)
    return np.asarray(part[:, None] * force)
