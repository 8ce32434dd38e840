"""The forces in joints from what they have to take out of a motion."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import FloatArray
from rigidfluid.errors import StepRejected


def joint_forces(answer: FloatArray, missing: FloatArray) -> FloatArray:
    """λ of (C W Cᵀ + κ) λ = missing.

    Parameters
    ----------
    answer : (c, c) array
        C W Cᵀ + κ of joint rows C, what motions answer to impulses or forces, W, and compliances κ, if there are any.
    missing : (c,) or (c, m) array
        What the joints have to change.

    Returns
    -------
    array
        As ``missing``.

    Raises
    ------
    StepRejected
        Where two joints hold the same in this pose.
    """
    try:
        return np.asarray(np.linalg.solve(answer, missing), dtype=np.float64)
    except np.linalg.LinAlgError:
        found, allowed = "a pose in which two of them hold the same", "poses in which their forces are determined"
        raise StepRejected("joints", found, allowed, "Shorten time.step, or move the bodies apart.") from None
