"""Torque-free rotation of rigid bodies, with angular momentum and energy kept to rounding."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import StepRejected

LARGEST_TURN = 0.1
"""Angle turned in one application of the fourth-order scheme [rad]: a period is then right to 1e-8."""

MOST_TURNED = 1000.0
"""Largest rotation allowed in one call [rad]: the computing time grows with the turns."""

SMALL = 1e-3
"""Square of the angle up to which cosine and sine are computed by their series [rad²]."""

_SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
_STAGES = np.array([_SUZUKI, _SUZUKI, 1.0 - 4.0 * _SUZUKI, _SUZUKI, _SUZUKI])


def rotate_freely(
    orientation: FloatArray, angular_momentum: FloatArray, inertia: FloatArray, time: float
) -> FloatArray:
    """Orientation (n, q) after a torque-free rotation for ``time``, dR/dt = [ω]× R with R I Rᵀ ω = L constant [rad |
    1]; raises StepRejected if a body that is not round turns by too many turns.

    The midpoint rule in the body's frame in 3D, l' - l = h m × I⁻¹m with m = (l + l')/2, is a rotation by the Cayley
    transform of h I⁻¹m; so the angular momentum and the energy are kept exactly (Austin, Krishnaprasad & Wang 1993, DOI
    10.1006/jcph.1993.1128). Suzuki's composition of five such maps is of fourth order (1990, DOI
    10.1016/0375-9601(90)90962-N). L (n, k) is in the lab frame [mass·length²/time], ``inertia`` I (n, k, k) in each
    body's frame [mass·length²].
    """
    if orientation.shape[1] == 1:
        return orientation + time * angular_momentum / inertia[:, 0]
    result = orientation.copy()
    body, turned = _turn(result, angular_momentum, inertia, time)
    if turned > MOST_TURNED:
        raise StepRejected(
            f"body.{body}.angular_velocity",
            f"a spin that may turn it by {turned:.3g} rad in a step",
            f"at most {MOST_TURNED:g} rad",
            "Shorten time.step, or let it spin slower.",
        )
    return result


@njit(cache=True)
def _turn(orientation, angular_momentum, inertia, time):
    """Turn all in place, but stop at a body that may turn by too much; return that one, or the last, and its angle
    [rad]."""
    body, turned = 0, 0.0
    for body in range(len(orientation)):
        if _is_round(inertia, body):
            turn_ball(orientation, angular_momentum, body, time / inertia[body, 0, 0])
            continue
        inverse = np.linalg.inv(inertia[body])
        turned = abs(time) * (np.sqrt((angular_momentum[body] ** 2).sum()) * np.sqrt((inverse**2).sum()))
        if turned > MOST_TURNED:
            break
        _tumble(orientation[body], angular_momentum[body], inverse, time, int(np.ceil(turned / LARGEST_TURN)))
    return body, turned


@njit(cache=True, error_model="numpy")
def turn_balls(orientation, angular_momentum, inverse_inertia, time):
    """Orientation (n, 4) after ``time`` of bodies that are all round: as by `rotate_freely`, with the inverse of each
    one's moment of inertia (n,) [1/(mass·length²)]."""
    turned = orientation.copy()
    for body in range(len(orientation)):
        turn_ball(turned, angular_momentum, body, time * inverse_inertia[body])
    return turned


@njit(cache=True)
def _is_round(inertia, body):
    for i in range(3):
        for j in range(3):
            if inertia[body, i, j] != (inertia[body, 0, 0] if i == j else 0.0):
                return False
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def turn_ball(orientation, momentum, body, factor):
    """Turn one angle or quaternion in place by exp([factor · momentum]×)."""
    if orientation.shape[1] == 1:
        orientation[body, 0] += factor * momentum[body, 0]
        return
    half = 0.5 * factor
    x, y, z = half * momentum[body, 0], half * momentum[body, 1], half * momentum[body, 2]
    if x == y == z == 0.0:
        return
    w, ratio = _cosine_and_ratio(x * x + y * y + z * z)
    x, y, z = ratio * x, ratio * y, ratio * z
    a, b, c, d = orientation[body, 0], orientation[body, 1], orientation[body, 2], orientation[body, 3]
    e, f = w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c
    g, h = w * c + y * a + z * b - x * d, w * d + z * a + x * c - y * b
    scale = 1.0 / np.sqrt(e * e + f * f + g * g + h * h)
    orientation[body, 0], orientation[body, 1] = scale * e, scale * f
    orientation[body, 2], orientation[body, 3] = scale * g, scale * h


@njit(cache=True, nogil=True, error_model="numpy")
def _cosine_and_ratio(square):
    """cos φ and sin φ/φ for a ``square`` φ² of an angle [1]: by their series where the fifth term is below rounding."""
    if square < SMALL:
        cosine = 1.0 + square * (-1 / 2 + square * (1 / 24 + square * (-1 / 720 + square * (1 / 40320))))
        return cosine, 1.0 + square * (-1 / 6 + square * (1 / 120 + square * (-1 / 5040 + square * (1 / 362880))))
    angle = np.sqrt(square)
    return np.cos(angle), np.sin(angle) / angle


@njit(cache=True)
def _tumble(quaternion, momentum, inverse, time, steps):
    for _ in range(steps):
        for stage in _STAGES:
            _midpoint(quaternion, momentum, inverse, stage * time / steps)


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
    """Vector of the lab frame in the body's, Rᵀ v."""
    w, axis = quaternion[0], quaternion[1:]
    twice = 2.0 * _cross(vector, axis)
    return vector + w * twice + _cross(twice, axis)


@njit(cache=True)
def _cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@njit(cache=True)
def _matrix(a):
    """Matrix [a]× of the cross product, [a]× b = a × b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
