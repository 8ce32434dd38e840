"""Points of ellipsoids that touch a round hollow around them: those farthest from its centre."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.secular_equation import secular_image

_SMALLEST = 1e-60
_MOST_STEPS = 100


def farthest_points(offset: FloatArray, half: FloatArray) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Points y = d + S u (N, d) of ellipsoids with largest |y|, |u| = 1, further local maxima (N, d), and which exist
    (N,).

    Both are u_i = b_i/(λ - a_i²) along the axes, with b = Sᵀd and |u(λ)| = 1. The largest has λ above all a_i²; another
    maximum, there is one at most, has λ between the two largest a_i², and is on the other side of the longest axis.
    ``offset`` (N, d) are the centres d from the hollow's, ``half`` (N, d, d) is S = R diag(a) [length].

    Notes
    -----
    There is at most one further maximum: J. M. Martínez, SIAM J. Optim. 4 (1994) 159, doi:10.1137/0804009.
    """
    rows, squares = np.arange(len(offset)), np.sum(half**2, axis=1)
    longest = np.argmax(squares, axis=1)
    along = np.einsum("nij,ni->nj", half, offset)
    shift = squares[rows, longest][:, None] - squares
    numerator = np.abs(along)
    # a centre across the longest axis has two farthest points: a tiny offset finds one of them as a limit
    least = _SMALLEST * squares[rows, longest]
    numerator[rows, longest] = np.maximum(numerator[rows, longest], least)
    image = np.copysign(secular_image(numerator, shift), along)
    image /= np.linalg.norm(image, axis=1, keepdims=True)
    other, there = _other_maximum(numerator, shift, longest)
    turned = np.copysign(other, along)
    turned[rows, longest] *= -1.0
    points = (offset + np.einsum("nij,nj->ni", half, each) for each in (image, turned))
    return *points, there


def _other_maximum(numerator: FloatArray, shift: FloatArray, longest: np.ndarray) -> tuple[FloatArray, BoolArray]:
    """|u| (N, d) at the first root σ of (b/σ)² + Σ (b_i/(c_i - σ))² = 1 below all c_i, and whether there is one (N,).

    Newton's method from σ = b grows to it, since the left side is convex and falls as far as there.
    """
    rows = np.arange(len(numerator))
    first = numerator[rows, longest]
    others, gaps = numerator.copy(), shift.copy()
    others[rows, longest], gaps[rows, longest] = 0.0, np.inf
    nearest, root = gaps.min(axis=1), first.copy()
    there = root < nearest
    for _ in range(_MOST_STEPS):
        left = np.where(there[:, None], gaps - root[:, None], 1.0)
        square = (first / root) ** 2 + np.sum((others / left) ** 2, axis=1) - 1.0
        slope = 2.0 * np.sum(others**2 / left**3, axis=1) - 2.0 * first**2 / root**3
        step = np.where(there & (slope < 0.0), -square / np.where(slope < 0.0, slope, -1.0), 0.0)
        there &= (slope < 0.0) & (root + step < nearest)
        root = np.where(there, root + np.maximum(step, 0.0), root)
        if not np.any(there & (step > 4.0 * np.finfo(float).eps * root)):
            break
    else:
        there &= step <= 4.0 * np.finfo(float).eps * root
    image = others / np.where(there[:, None], gaps - root[:, None], 1.0)
    image[rows, longest] = first / root
    return image / np.linalg.norm(image, axis=1, keepdims=True), there
