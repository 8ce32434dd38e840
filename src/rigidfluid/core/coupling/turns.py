"""Energy that the fluid's time scheme creates as contacts turn bodies."""

from __future__ import annotations

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.reduced_model import ReducedModel

_OVER_FRICTION = 2.0
"""Δt/6 ΔU·RΔU of a body that is thrown back in the middle of a step, over the friction in its substeps [1]."""


def created_in_turn(model: ReducedModel, change: FloatArray, friction: float, size: float) -> float:
    """Energy max(Δt/6 ΔU·RΔU - 2 E_R, 0) that a step of this ``size`` Δt [time] creates, about [energy].

    ``change`` (c,) is the change ΔU of the model's velocities in the step, ``friction`` the energy E_R that drag takes
    in substeps. With BDF2 the viscous forces K act on u + Δt²/3 u'', and Δt²/3 ∫u'·Ku' of the dissipation is missing;
    Simpson's rule sees half of it as missing too. A contact that is short in the step throws bodies back within it:
    what friction takes then outweighs this.
    """
    turned = size / 6.0 * float(change @ model.friction_times(change))
    return max(turned - _OVER_FRICTION * friction, 0.0)
