"""Vectors and rotations of the plane as those of space, for loops that are compiled for triples alone."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray


def in_space(vectors: FloatArray) -> FloatArray:
    """Vectors (…, d) as triples (…, 3), in the plane with zeros."""
    if vectors.shape[-1] == 3:
        return np.ascontiguousarray(vectors)
    padded = np.zeros((*vectors.shape[:-1], 3))
    padded[..., :2] = vectors
    return padded


def rotations_in_space(rotation: FloatArray) -> FloatArray:
    """Rotations (n, d, d) as those of space (n, 3, 3), in the plane about the third axis."""
    if rotation.shape[-1] == 3:
        return np.ascontiguousarray(rotation)
    turned = np.zeros((len(rotation), 3, 3))
    turned[:, :2, :2], turned[:, 2, 2] = rotation, 1.0
    return turned


def axes_in_space(semi_axes: FloatArray) -> FloatArray:
    """Semi-axes (n, d) as three, in the plane with a third as long as the longest."""
    if semi_axes.shape[1] == 3:
        return semi_axes
    return np.column_stack([semi_axes, semi_axes.max(axis=1)])
