"""The forces in joints from what they have to take out of a motion."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import StepRejected


def joint_forces(delassus: FloatArray, missing: FloatArray) -> FloatArray:
    """Solve (C W Cᵀ + κ) λ = ``missing`` (c,) or (c, m) for the joint forces λ; ``delassus`` (c, c) is C W Cᵀ + κ of
    joint rows C, inverse masses W and compliances κ, if there are any.

    Raises StepRejected where two joints hold the same in this pose.
    """
    try:
        return np.asarray(np.linalg.solve(delassus, missing), dtype=np.float64)
    except np.linalg.LinAlgError:
        found, allowed = "a pose in which two of them hold the same", "poses in which their forces are determined"
        raise StepRejected("joints", found, allowed, "Shorten time.step, or move the bodies apart.") from None
