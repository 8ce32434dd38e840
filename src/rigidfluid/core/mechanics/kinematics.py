"""Map from the motions that carry bodies to the bodies, and back: component twist = G u + g, free wrench = Gᵀ wrench.

Bodies without kinematics move each by itself: G = 1, g = 0; arguments are returned unchanged.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.mechanics.rigid import cross, moment
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Kinematics, Step, Twist, Wrench


def component_twist(kinematics: Kinematics | None, motion: Twist) -> Twist:
    """Twists of the bodies, Uᵢ = U + ω × armᵢ + gᵢ, ωᵢ = ω + gᵢ.

    Parameters
    ----------
    kinematics : Kinematics or None
        Of n bodies on N motions.
    motion : Twist
        Of the motions, N rows.

    Returns
    -------
    Twist
        Of the bodies, n rows.
    """
    if kinematics is None:
        return motion
    d, spin = kinematics.arm.shape[1], motion.angular_velocity[kinematics.carrier]
    velocity = motion.velocity[kinematics.carrier] + cross(spin, kinematics.arm)
    return Twist(velocity + kinematics.given[:, :d], spin + kinematics.given[:, d:])


def given_twist(step: Step) -> tuple[Twist, BoolArray]:
    """Prescribed part of the body twists, n rows, and whether a body has one (n,)."""
    kinematics, d = step.kinematics, step.pose.position.shape[1]
    held = np.where(step.controlled[:, None], step.controlled_twist, 0.0)
    given = component_twist(kinematics, Twist(held[:, :d], held[:, d:]))
    if kinematics is None:
        return given, step.controlled
    return given, np.any(given.velocity, axis=1) | np.any(given.angular_velocity, axis=1)


def motion_twist(kinematics: Kinematics | None, twist: FloatArray) -> FloatArray:
    """Twists (N, d+k) of the motions that give the bodies this ``twist`` (n, d+k), read from the first body of each."""
    if kinematics is None:
        return twist
    d, first = kinematics.arm.shape[1], np.unique(kinematics.carrier, return_index=True)[1]
    free = twist[first] - kinematics.given[first]
    free[:, :d] -= cross(free[:, d:], kinematics.arm[first])
    return free


def free_wrench(kinematics: Kinematics | None, wrench: Wrench) -> Wrench:
    """Wrench on the motions by wrenches on the bodies, F = Σ Fᵢ, T = Σ (armᵢ × Fᵢ + Tᵢ).

    Parameters
    ----------
    kinematics : Kinematics or None
        Of n bodies on N motions.
    wrench : Wrench
        On the bodies, n rows.

    Returns
    -------
    Wrench
        On the motions, about their centres of mass, N rows.
    """
    if kinematics is None:
        return wrench
    torque = wrench.torque + moment(kinematics.arm, wrench.force)
    return Wrench(*(carried_sum(kinematics.carrier, rows, len(kinematics.centre)) for rows in (wrench.force, torque)))


def carried_sum(carrier: IntArray, rows: FloatArray, motions: int) -> FloatArray:
    """Sum of ``rows`` (n, …) over the bodies that each motion carries, (N, …)."""
    total = np.zeros((motions, *rows.shape[1:]))
    np.add.at(total, carrier, rows)
    return total


def jacobian(kinematics: Kinematics) -> sparse.csr_matrix:
    """Matrix G (n·(d+k), N·(d+k)) from velocities of the motions to those of the bodies."""
    count, d = kinematics.arm.shape
    width = kinematics.given.shape[1]
    block = np.tile(np.eye(width), (count, 1, 1))
    block[:, :d, d:] = levers(kinematics.arm)
    rows = (width * np.arange(count)[:, None, None] + np.arange(width)[:, None] + np.zeros(width, dtype=int)).ravel()
    columns = (width * kinematics.carrier[:, None, None] + np.zeros((width, 1), dtype=int) + np.arange(width)).ravel()
    shape = count * width, len(kinematics.centre) * width
    return sparse.csr_matrix((block.ravel(), (rows, columns)), shape=shape)


def levers(arm: FloatArray) -> FloatArray:
    """Lever matrices X (n, d, k) with X ω = ω × arm, for arms (n, d) [length]."""
    k = 1 if arm.shape[1] == 2 else 3
    return np.stack([cross(np.broadcast_to(axis, (len(arm), k)), arm) for axis in np.eye(k)], axis=-1)
