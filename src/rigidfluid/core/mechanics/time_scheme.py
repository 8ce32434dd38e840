"""Second-order time stepping with a variable step: BDF2 for velocities, Adams–Bashforth 2 for poses.

The pair is for a spring at constant step the Störmer–Verlet method in disguise: with the force taken at the new pose
the positions obey xⁿ⁺¹ - (2 - k²) xⁿ + xⁿ⁻¹ = 0, k = ωΔt, so that nothing is damped and nothing grows while k < 2.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import angular_momentum, lab_inertia, rotate
from rigidfluid.core.model.types import Pose, Twist, Wrench


def derivative_weights(step: float, previous_step: float | None) -> FloatArray:
    """Weights (3,) of the backward difference ∂u/∂t(tⁿ⁺¹) ≈ d₀uⁿ⁺¹ + d₁uⁿ + d₂uⁿ⁻¹, newest first [1/time].

    The weights are d = (1 + 2r, -(1 + r)², r²) / ((1 + r) Δt) with r = step / previous_step: BDF2, exact for parabolas;
    if previous_step is None (1, -1, 0) / Δt: BDF1.
    """
    if previous_step is None:
        return np.array([1.0, -1.0, 0.0]) / step
    ratio = step / previous_step
    return np.array([1 + 2 * ratio, -((1 + ratio) ** 2), ratio**2]) / ((1 + ratio) * step)


def extrapolation_weights(step: float, previous_step: float | None) -> FloatArray:
    """Weights (2,) of the linear extrapolation uⁿ⁺¹ ≈ (1 + r) uⁿ - r uⁿ⁻¹, r = step / previous_step, newest first; uⁿ⁺¹
    ≈ uⁿ if previous_step is None [1]."""
    ratio = 0.0 if previous_step is None else step / previous_step
    return np.array([1 + ratio, -ratio])


def path_error_weight(step: float, previous_step: float) -> float:
    """Local error c of `predict_pose` per unit time over the difference of the twist from its linear extrapolation [1].

    Milne's device: Adams–Bashforth 2 integrates the extrapolation u*. The parabola through the three velocities exceeds
    it in the mean over the step by c (uⁿ⁺¹ - u*), c = (3 + 2r) / (6 (1 + r)) with r = step / previous_step: 5/12 for
    equal steps. The error is (2r + 3)/(12 r) Δt² ü to leading order for a smooth u.
    """
    ratio = step / previous_step
    return (3 + 2 * ratio) / (6 * (1 + ratio))


def predict_pose(
    pose: Pose, twist: Twist, previous_twist: Twist | None, step: float, previous_step: float | None
) -> Pose:
    """Pose at the new time by Adams–Bashforth 2, xⁿ⁺¹ = xⁿ + Δt[(1 + r/2) Uⁿ - (r/2) Uⁿ⁻¹], r = step / previous_step.

    The orientation is turned by the exponential of the same combination of the angular velocities. The scheme is
    forward Euler where the previous twist or step is None.
    """
    mean = twist
    if previous_twist is not None and previous_step is not None:
        mean = _mean(twist, previous_twist, step / previous_step)
    return Pose(pose.position + step * mean.velocity, rotate(pose.orientation, step * mean.angular_velocity))


def start_pose(pose: Pose, twist: Twist, end_twist: Twist, step: float) -> Pose:
    """Pose at the end of the first step from the twists at both ends: x¹ = x⁰ + Δt (U⁰ + U¹)/2.

    The mean keeps the balance of energy with BDF1 for a fluid at rest, where forward Euler leaves out half of the fall.
    """
    velocity = 0.5 * (twist.velocity + end_twist.velocity)
    spin = 0.5 * (twist.angular_velocity + end_twist.angular_velocity)
    return Pose(pose.position + step * velocity, rotate(pose.orientation, step * spin))


def newton_euler(
    mass: FloatArray,
    inertia: FloatArray,
    pose: Pose,
    poses: Sequence[Pose],
    twists: Sequence[Twist],
    weights: FloatArray,
    wrench: Wrench,
) -> tuple[FloatArray, FloatArray]:
    """Equations of motion in discrete form, mass_matrix · twist = load (+ the fluid's wrench): mass_matrix (n, d+k,
    d+k), block-diagonal [mass/time | mass·length²/time], and load (n, d+k) [force | force·length].

    The momentum (mU, R I Rᵀω) is differenced, each time with its own orientation: mass_matrix = d₀ diag(m, R I Rᵀ) at
    the new ``pose``, load = -d₁ momentumⁿ - d₂ momentumⁿ⁻¹ + wrench; so angular momentum is kept, gyroscopic terms and
    all. ``poses`` and ``twists`` are the past ones, newest first; ``weights`` (3,) are from `derivative_weights`;
    ``wrench`` is that of all but the fluid: weight, contact.
    """
    load = np.concatenate([wrench.force, wrench.torque], axis=1)
    for weight, old_pose, old_twist in zip(weights[1:], poses, twists, strict=False):
        load = load - weight * momentum(mass, inertia, old_pose, old_twist)
    return weights[0] * generalised_mass(mass, inertia, pose), load


def momentum(mass: FloatArray, inertia: FloatArray, pose: Pose, twist: Twist) -> FloatArray:
    """Momentum of each body (m U, R I Rᵀ ω), (n, d+k) [mass·length/time | mass·length²/time]."""
    spin = angular_momentum(inertia, pose.orientation, twist.angular_velocity)
    return np.concatenate([mass[:, None] * twist.velocity, spin], axis=1)


def _mean(twist: Twist, previous: Twist, ratio: float) -> Twist:
    new, old = 1 + ratio / 2, -ratio / 2
    return Twist(
        new * twist.velocity + old * previous.velocity,
        new * twist.angular_velocity + old * previous.angular_velocity,
    )


def generalised_mass(mass: FloatArray, inertia: FloatArray, pose: Pose) -> FloatArray:
    """Generalised mass of each body diag(m, R I Rᵀ), (n, d+k, d+k) [mass | mass·length²]."""
    count, dimension = pose.position.shape
    size = dimension + inertia.shape[-1]
    matrix = np.zeros((count, size, size))
    matrix[:, :dimension, :dimension] = mass[:, None, None] * np.eye(dimension)
    matrix[:, dimension:, dimension:] = lab_inertia(inertia, pose.orientation)
    return matrix
