"""Rotation of rigid bodies that nothing turns, with angular momentum and energy kept to rounding."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.rigid import rotate
from rigidfluid.core.types import FloatArray

LARGEST_TURN = 0.1
"""Angle turned in one application of the fourth-order scheme [rad]: a period is then right to 1e-8."""

_SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
_STAGES = np.array([_SUZUKI, _SUZUKI, 1.0 - 4.0 * _SUZUKI, _SUZUKI, _SUZUKI])


def rotate_freely(
    orientation: FloatArray, angular_momentum: FloatArray, inertia: FloatArray, time: float
) -> FloatArray:
    """Orientation after a torque-free rotation, dR/dt = [ω]× R with R I Rᵀ ω = L constant.

    In 3D the midpoint rule in the body's frame, l' - l = h m × I⁻¹m with m = (l + l')/2, is a rotation by the Cayley
    transform of h I⁻¹m; so the angular momentum and the energy are kept exactly. Suzuki's composition of five such
    maps is of fourth order.

    Parameters
    ----------
    orientation : (n, q) array
        Orientation before [rad | 1].
    angular_momentum : (n, k) array
        L in the lab frame [mass·length²/time].
    inertia : (n, k, k) array
        I in each body's frame [mass·length²].
    time : float
        How long they turn [time].

    Returns
    -------
    (n, q) array
        Orientation after [rad | 1].

    Notes
    -----
    Suzuki 1990, DOI 10.1016/0375-9601(90)90962-N; the midpoint rule: Austin, Krishnaprasad & Wang 1993,
    DOI 10.1006/jcph.1993.1128.
    """
    if orientation.shape[1] == 1:
        return orientation + time * angular_momentum / inertia[:, 0]
    result = orientation.copy()
    moments = np.einsum("nii->ni", inertia)
    is_round = np.all(inertia == moments[:, :1, None] * np.eye(3), axis=(1, 2))
    result[is_round] = rotate(orientation[is_round], time * angular_momentum[is_round] / moments[is_round, :1])
    other = np.flatnonzero(~is_round)
    if len(other):
        _tumble(result, angular_momentum, np.linalg.inv(inertia), other, time, LARGEST_TURN, _STAGES)
    return result


@njit(cache=True)
def _tumble(orientation, angular_momentum, inverse, bodies, time, largest_turn, stages):
    for body in bodies:
        quaternion, momentum = orientation[body], angular_momentum[body]
        length = np.sqrt(momentum[0] ** 2 + momentum[1] ** 2 + momentum[2] ** 2)
        fastest = length * np.sqrt((inverse[body] ** 2).sum())
        steps = int(np.ceil(abs(time) * fastest / largest_turn))
        for _ in range(steps):
            for stage in stages:
                _midpoint(quaternion, momentum, inverse[body], stage * time / steps)


@njit(cache=True)
def _midpoint(quaternion, momentum, inverse, step):
    """Turn one quaternion in place by the Cayley transform of ``step`` times the angular velocity in mid-step."""
    start = _to_body(quaternion, momentum)
    middle = start.copy()
    for _ in range(20):
        spin = inverse @ middle
        residual = middle - start - 0.5 * step * _cross(middle, spin)
        slope = np.eye(3) + 0.5 * step * (_matrix(spin) - _matrix(middle) @ inverse)
        change = np.linalg.solve(slope, residual)
        middle -= change
        if np.abs(change).max() <= 1e-15 * np.abs(start).max():
            break
    half = 0.5 * step * (inverse @ middle)
    w, x, y, z = quaternion
    a, b, c = half
    quaternion[0] = w - x * a - y * b - z * c
    quaternion[1] = x + w * a + y * c - z * b
    quaternion[2] = y + w * b + z * a - x * c
    quaternion[3] = z + w * c + x * b - y * a
    quaternion /= np.sqrt((quaternion**2).sum())


@njit(cache=True)
def _to_body(quaternion, vector):
    """Rᵀ v."""
    w, axis = quaternion[0], quaternion[1:]
    twice = 2.0 * _cross(vector, axis)
    return vector + w * twice + _cross(twice, axis)


@njit(cache=True)
def _cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@njit(cache=True)
def _matrix(a):
    """[a]×, so that [a]× b = a × b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
