"""Gaps of balls and ellipsoids, from their support functions: what detectors are compared with."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.unit_sphere import unit_sphere_points
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.types import Pose

FINEST = 1e-9
"""Step of the directions at the end; the gap's error goes with its square."""


def true_gap(semi_axes: FloatArray, pose: Pose, a: int, b: int) -> float:
    """gap = max over unit n of (c_a - c_b)·n - |D_a R_aᵀ n| - |D_b R_bᵀ n|, for balls |c_a - c_b| - r_a - r_b [length].

    ``semi_axes`` (n, d) of all bodies are the diagonals of D [length], centres c and rotations R their ``pose``. The
    bodies a and b must be disjoint, so that the maximum is the only one; the result is exact to rounding.
    """
    offset = pose.position[a] - pose.position[b]
    pair = [a, b]
    if np.all(semi_axes[pair] == semi_axes[pair, :1]):
        return float(np.linalg.norm(offset) - semi_axes[pair, 0].sum())
    shapes = semi_axes[pair, :, None] * rotation_matrices(pose.orientation[pair]).transpose(0, 2, 1)
    return _highest_separation(offset, shapes)


def _highest_separation(offset: FloatArray, shapes: FloatArray) -> float:
    """Search over directions: move to the best of those around, and halve their spread if none is better."""
    around = unit_sphere_points(8 if len(offset) == 2 else 40, len(offset))
    directions = unit_sphere_points(200, len(offset))
    best, width = -np.inf, 0.1
    while width > FINEST:
        values = directions @ offset - np.linalg.norm(np.einsum("sij,nj->sni", shapes, directions), axis=2).sum(axis=0)
        top = int(np.argmax(values))
        if values[top] > best:
            best, direction = float(values[top]), directions[top]
        else:
            width /= 2
        directions = direction + width * around
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return best
