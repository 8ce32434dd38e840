"""From a normal that is nearly right to the gap and the points of two ellipsoids, to round-off.

The ellipsoid with the matrix Q = R diag(a²) Rᵀ reaches s(n) = √(n·Qn) from its centre in the direction n, at the point
Qn/s. For two of them, with c = x_a - x_b, the gap is the largest value over all unit normals n of

    g(n) = n·c - s_a(n) - s_b(n),

negative where they overlap. Newton's method on the sphere of normals finds it in two to four steps.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.api import FloatArray

_STEPS = 50
_SCALES = 0.5 ** np.arange(12)
_ROUND_OFF = 1e-14


def shape_matrices(rotation: FloatArray, semi_axes: FloatArray) -> FloatArray:
    """Q = R diag(a²) Rᵀ (n, d, d) [length²] of ``rotation`` (n, d, d) [1] and ``semi_axes`` (n, d) [length]."""
    return np.asarray((rotation * semi_axes[:, None, :] ** 2) @ rotation.transpose(0, 2, 1))


def extent(shape: FloatArray, normal: FloatArray) -> FloatArray:
    """s(n) (m,) [length] of ``shape`` Q (m, d, d) [length²] in directions ``normal`` (m, d) [1]."""
    return np.asarray(np.sqrt(np.einsum("mi,mij,mj->m", normal, shape, normal)))


def farthest(shape: FloatArray, normal: FloatArray) -> FloatArray:
    """Qn/s (m, d) [length]: the farthest point from the centre in the direction n; arguments as of `extent`."""
    return np.asarray(np.einsum("mij,mj->mi", shape, normal) / extent(shape, normal)[:, None])


def separation(normal: FloatArray, offset: FloatArray, shape_a: FloatArray, shape_b: FloatArray) -> FloatArray:
    """g(n) (m,) [length]; arguments as of `refined`."""
    along: FloatArray = np.sum(normal * offset, axis=1)
    return along - extent(shape_a, normal) - extent(shape_b, normal)


def refined(normal: FloatArray, offset: FloatArray, shape_a: FloatArray, shape_b: FloatArray) -> FloatArray:
    """The normals where g is largest.

    Parameters
    ----------
    normal : (m, d) array
        Unit normals from b to a to start from [1].
    offset : (m, d) array
        Centre of a minus centre of b [length].
    shape_a, shape_b : (m, d, d) arrays
        The matrices Q [length²].

    Returns
    -------
    (m, d) array
        Unit normals; g is nowhere less than at the start.
    """
    size = np.sqrt(np.trace(shape_a + shape_b, axis1=1, axis2=2))
    for _ in range(_STEPS):
        step = _newton_step(normal, offset, shape_a, shape_b)
        normal = _advanced(normal, step, offset, shape_a, shape_b, size)
        if np.all(np.abs(step) < _ROUND_OFF):
            break
    return normal


def _newton_step(normal: FloatArray, offset: FloatArray, shape_a: FloatArray, shape_b: FloatArray) -> FloatArray:
    """Newton's step (m, d), across the normal; curvatures of the wrong sign are turned, so that g grows along it."""
    gap = separation(normal, offset, shape_a, shape_b)
    slope = offset - farthest(shape_a, normal) - farthest(shape_b, normal) - gap[:, None] * normal
    along = normal[:, :, None] * normal[:, None, :]
    across = np.eye(normal.shape[1]) - along
    curvature = _curvature(shape_a, normal) + _curvature(shape_b, normal) + gap[:, None, None] * across + along
    values, axes = np.linalg.eigh(curvature)
    inverse = np.einsum("mij,mj,mkj->mik", axes, 1.0 / np.maximum(np.abs(values), _ROUND_OFF), axes)
    step = np.einsum("mij,mj->mi", inverse, slope)
    return np.asarray(step - np.sum(step * normal, axis=1, keepdims=True) * normal)


def _curvature(shape: FloatArray, normal: FloatArray) -> FloatArray:
    """The second derivative of s, (m, d, d): radii of curvature across the normal, nothing along it [length]."""
    point = farthest(shape, normal)
    return np.asarray((shape - point[:, :, None] * point[:, None, :]) / extent(shape, normal)[:, None, None])


def _advanced(
    normal: FloatArray,
    step: FloatArray,
    offset: FloatArray,
    shape_a: FloatArray,
    shape_b: FloatArray,
    size: FloatArray,
) -> FloatArray:
    """The normals after the longest part of the step, halved as often as needed, that does not lower g."""
    least = separation(normal, offset, shape_a, shape_b) - _ROUND_OFF * size
    waiting = np.ones(len(normal), dtype=bool)
    advanced = normal.copy()
    for scale in _SCALES:
        tried = normal + scale * step
        tried /= np.linalg.norm(tried, axis=1, keepdims=True)
        taken = waiting & (separation(tried, offset, shape_a, shape_b) >= least)
        advanced[taken] = tried[taken]
        waiting &= ~taken
        if not waiting.any():
            break
    return advanced
