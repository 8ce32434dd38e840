"""Figures of a suspension at one time, of the bodies in it that move, and of contacts between them."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.shear import Shear


def mean_velocity(velocity: FloatArray) -> FloatArray:
    """Mean (…, d) of velocities (…, n, d) over the bodies [length/time]."""
    return np.asarray(velocity.mean(axis=-2))


def velocity_fluctuations(velocity: FloatArray, position: FloatArray, shear: Shear | None) -> FloatArray:
    """Standard deviation (…, d) of velocities (…, n, d) from their mean over the bodies, and from a shear at their
    positions (…, n, d) [length/time]."""
    own = velocity if shear is None else velocity - shear.velocity(position)
    return np.asarray(own.std(axis=-2))


def mean_gap(gap: FloatArray) -> FloatArray:
    """Mean (…) of gaps (…, n) over the bodies that have something near, not a number where none has [length]."""
    known = np.isfinite(gap)
    count, total = known.sum(axis=-1), np.where(known, gap, 0.0).sum(axis=-1)
    return np.asarray(np.divide(total, count, out=np.full(np.shape(count), np.nan), where=count > 0))


def touching_pairs(a: IntArray, b: IntArray) -> IntArray:
    """Pairs (p, 2) of bodies that touch, each once however many contacts it has; of numbers (m,), -1 of what does not
    move."""
    both = (a >= 0) & (b >= 0)
    return np.unique(np.sort(np.stack([a[both], b[both]], axis=1), axis=1), axis=0)


def coordination(count: int, a: IntArray, b: IntArray) -> float:
    """Mean number of bodies that one of ``count`` touches, by the numbers (m,) in contacts as in `touching_pairs`
    [1]."""
    return 2.0 * len(touching_pairs(a, b)) / count


def contact_stress(force: FloatArray, arm: FloatArray, volume: float) -> FloatArray:
    """Stress -Σ F (x_a - x_b)ᵀ/V (d, d) of forces F (m, d) on a in contacts between bodies, whose centres are an
    ``arm`` (m, d) apart, in a ``volume`` [force/length^(d-1)]."""
    return np.asarray(force.T @ -arm) / volume


def symmetric(stress: FloatArray) -> FloatArray:
    """Symmetric part of stresses (…, d, d)."""
    return 0.5 * (stress + stress.swapaxes(-1, -2))
