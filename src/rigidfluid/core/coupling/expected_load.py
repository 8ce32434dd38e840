"""Load Φ of the reduced model that is expected of a step: at its start, and at its end."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import newly_applied, outer_load
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.reduced_model import ReducedModel, mean_load
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System


def load_before(system: System, state: State, model: ReducedModel) -> FloatArray:
    """Load Φ (c,) at the start of a step: that at the end of the one before, less R (Uⁿ - Uⁿ⁻¹), since drag counts from
    the velocities at the start of a step; NaN where unknown."""
    if state.coupling is None or state.past is None:
        return np.full(len(model.velocities), np.nan)
    latest, change = state.coupling.model, flat(state.motions.twist) - flat(state.past.twist)
    slowed = latest.friction_times(latest.components(change))
    added = model.components(flat(newly_applied(system, state)))
    return _carried_over(state.coupling.load - slowed, latest, model) + added


def expected_load(system: System, state: State, model: ReducedModel, before: FloatArray, size: float) -> FloatArray:
    """Load Φ (c,) expected at the end of a step of this ``size`` [time]: grown from its value ``before`` (c,) as fast
    as in the latest step, or the mean of that step where its growth is unknown; weight and applied wrenches in the
    first."""
    if state.past is None:
        return model.components(flat(outer_load(system, state)))
    change = model.components(flat(state.motions.twist) - flat(state.past.twist))
    pushed = flat(state.motions.contact) + state.link.wrench
    impulse = model.components(pushed) * state.past.step
    applied = model.components(flat(newly_applied(system, state)))
    mean = mean_load(model, change, impulse, state.past.step) + applied
    if state.coupling is None:
        return mean
    latest = state.coupling.load - state.coupling.load_before
    growth = size / state.past.step * _carried_over(latest, state.coupling.model, model)
    return np.where(np.isnan(growth), mean, before + growth)


def _carried_over(values: FloatArray, latest: ReducedModel, model: ReducedModel) -> FloatArray:
    """Values (c,) of the velocities of a model from those of the ``latest`` one, NaN where it has none."""
    found = np.full(len(model.velocities), np.nan)
    _, here, there = np.intersect1d(model.velocities, latest.velocities, return_indices=True)
    found[here] = values[there]
    return found
