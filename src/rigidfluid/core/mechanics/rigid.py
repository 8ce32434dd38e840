"""Rotations, cross products, inertia and kinetic energy of rigid bodies, the same calls in 2D and in 3D.

An orientation has one component in 2D, an angle, and four in 3D, a scalar-first unit quaternion; a rotational
quantity (angular velocity, torque) has k = 1 component in 2D and k = 3 in 3D. Everything is right-handed.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Pose, Twist

_IDENTITY = np.eye(3)


def rotation_matrices(orientation: FloatArray) -> FloatArray:
    """Matrices R that turn vectors of the bodies' frames into the lab frame, x_lab = R x_body.

    Parameters
    ----------
    orientation : (n, q) array
        Angles, counter-clockwise [rad] (q = 1), or scalar-first unit quaternions [1] (q = 4).

    Returns
    -------
    (n, d, d) array
        Proper rotation matrices [1].
    """
    if orientation.shape[-1] == 1:
        return _planar_matrices(orientation[:, 0])
    return _quaternion_matrices(orientation)


def rotate(orientation: FloatArray, rotation_vector: FloatArray) -> FloatArray:
    """Orientation (n, q) after a further rotation of the lab frame, R_new = exp([rotation_vector]×) R [rad | 1].

    The vector (n, k) is axis times angle in the lab frame [rad]. Angles add in 2D, so that whole turns are kept; the
    quaternion of 3D is normalised again.
    """
    if orientation.shape[-1] == 1:
        return orientation + rotation_vector
    product = _quaternion_product(_quaternion_exponential(rotation_vector), orientation)
    return np.asarray(product / np.linalg.norm(product, axis=-1, keepdims=True))


def compose(orientation: FloatArray, relative: FloatArray) -> FloatArray:
    """Orientation (n, q) in the lab frame of a frame turned by ``relative`` in one turned by ``orientation``, R
    R_relative [rad | 1]."""
    if orientation.shape[-1] == 1:
        return orientation + relative
    return _quaternion_product(orientation, relative)


def angle_between(start: FloatArray, end: FloatArray) -> FloatArray:
    """Angle (n,) of the rotation from one orientation (n, q) to another, whole turns included in 2D [rad]."""
    return np.asarray(np.linalg.norm(rotation_between(start, end), axis=1))


def rotation_between(start: FloatArray, end: FloatArray) -> FloatArray:
    """Rotation vector (n, k) in the lab frame that leads from one orientation (n, q) to another, the inverse of
    `rotate`: in 2D whole turns included, in 3D at most half a turn [rad]."""
    if start.shape[-1] == 1:
        return end - start
    turn = _quaternion_product(end, start * [1.0, -1.0, -1.0, -1.0])
    turn = np.where(turn[:, :1] < 0.0, -turn, turn)
    sine = np.linalg.norm(turn[:, 1:], axis=1, keepdims=True)
    half = np.arctan2(sine, turn[:, :1])
    return np.asarray(2.0 * turn[:, 1:] / np.sinc(half / np.pi))


def cross(angular_velocity: FloatArray, arm: FloatArray) -> FloatArray:
    """Velocity ω × r (..., d) of a point at ``arm`` r (..., d) from the centre of mass, ω (..., k) counter-clockwise in
    2D [length/time]."""
    if arm.shape[-1] == 2:
        return angular_velocity * np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
    return np.cross(angular_velocity, arm)


def moment(arm: FloatArray, force: FloatArray) -> FloatArray:
    """Moment r × F (..., k) about the centre of mass of a force (..., d) at ``arm`` r (..., d), counter-clockwise in 2D
    [force·length]."""
    if arm.shape[-1] == 2:
        return np.asarray(arm[..., :1] * force[..., 1:] - arm[..., 1:] * force[..., :1])
    return np.cross(arm, force)


def lab_inertia(inertia: FloatArray, orientation: FloatArray) -> FloatArray:
    """Inertia tensors in the lab frame R I Rᵀ (n, k, k), of ``inertia`` I in each body's frame [mass·length²]; so those
    of added mass (n, d, d) [mass]."""
    if is_isotropic(inertia):
        return inertia
    rotation = rotation_matrices(orientation)
    return np.asarray(rotation @ inertia @ rotation.swapaxes(-1, -2))


def is_isotropic(tensor: FloatArray) -> bool:
    """Tell whether all tensors (n, k, k) are multiples of the identity, as those of balls: no rotation changes them."""
    size = tensor.shape[1]
    return size == 1 or not bool((tensor != tensor[:, :1, :1] * _IDENTITY[:size, :size]).any())


def angular_momentum(inertia: FloatArray, orientation: FloatArray, angular_velocity: FloatArray) -> FloatArray:
    """Angular momenta R I Rᵀ ω (n, k), arguments as for `lab_inertia` [mass·length²/time]."""
    if is_isotropic(inertia):
        return np.asarray(inertia[:, 0, :1] * angular_velocity)
    return np.asarray(np.einsum("nij,nj->ni", lab_inertia(inertia, orientation), angular_velocity))


def turned(orientation: FloatArray, spin: FloatArray) -> FloatArray:
    """Rotational quantities (n, k) of the bodies' frames in the lab frame, R v; in 2D the scalar does not change."""
    if orientation.shape[-1] == 1:
        return spin
    return np.asarray(np.einsum("nij,nj->ni", rotation_matrices(orientation), spin))


def inverse_lab_inertia(inertia: FloatArray, orientation: FloatArray) -> FloatArray:
    """Inverse inertia in the lab frame, (R I Rᵀ)⁻¹ = R I⁻¹ Rᵀ, (n, k, k), arguments as for `lab_inertia`."""
    return lab_inertia(np.asarray(np.linalg.inv(inertia), dtype=np.float64), orientation)


def kinetic_energy(mass: FloatArray, inertia: FloatArray, pose: Pose, twist: Twist) -> float:
    """Kinetic energy of the bodies, Σ ½ m|U|² + ½ ω·(R I Rᵀ)ω [energy]."""
    spin = angular_momentum(inertia, pose.orientation, twist.angular_velocity)
    return 0.5 * float(mass @ (twist.velocity**2).sum(axis=1) + (spin * twist.angular_velocity).sum())


def _planar_matrices(angle: FloatArray) -> FloatArray:
    matrices, sine = np.empty((len(angle), 2, 2)), np.sin(angle)
    matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(angle)
    matrices[:, 0, 1], matrices[:, 1, 0] = -sine, sine
    return matrices


def _quaternion_matrices(quaternion: FloatArray) -> FloatArray:
    w, x, y, z = quaternion.T
    xx, yy, zz, xy, xz, yz, wx, wy, wz = x * x, y * y, z * z, x * y, x * z, y * z, w * x, w * y, w * z
    matrices = np.empty((len(quaternion), 3, 3))
    matrices[:, 0, 0], matrices[:, 0, 1], matrices[:, 0, 2] = 1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)
    matrices[:, 1, 0], matrices[:, 1, 1], matrices[:, 1, 2] = 2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)
    matrices[:, 2, 0], matrices[:, 2, 1], matrices[:, 2, 2] = 2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)
    return matrices


def _quaternion_exponential(rotation_vector: FloatArray) -> FloatArray:
    half = 0.5 * rotation_vector
    angle = np.linalg.norm(half, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle), np.sinc(angle / np.pi) * half], axis=-1)


def _quaternion_product(left: FloatArray, right: FloatArray) -> FloatArray:
    product = np.empty(np.broadcast_shapes(left.shape, right.shape))
    (w, *one), (v, *other) = left.T, right.T
    product[:, 0] = w * v - (one[0] * other[0] + one[1] * other[1] + one[2] * other[2])
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        product[:, 1 + i] = w * other[i] + v * one[i] + (one[j] * other[k] - one[k] * other[j])
    return product
