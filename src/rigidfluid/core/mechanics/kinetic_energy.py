"""The kinetic energy of rigid bodies."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.rigid import lab_inertia
from rigidfluid.core.model.types import FloatArray, Pose, Twist


def kinetic_energy(mass: FloatArray, inertia: FloatArray, pose: Pose, twist: Twist) -> float:
    """Of the bodies, Σ ½ m|U|² + ½ ω·(R I Rᵀ)ω [energy]."""
    spin = np.einsum("nij,nj->ni", lab_inertia(inertia, pose.orientation), twist.angular_velocity)
    return 0.5 * float(mass @ np.sum(twist.velocity**2, axis=1) + np.sum(spin * twist.angular_velocity))
