"""Load Φ of the reduced model that is expected of a step: at its start, and at its end."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import newly_applied, outer_load
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.reduced_model import ReducedModel, expected_load
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System

SLOW = 0.1
"""Largest relative growth of a load in a step that is expected to go on: that of contacts that rest or press slowly."""


def load_before(system: System, state: State, model: ReducedModel) -> FloatArray:
    """Load Φ (c,) at the start of a step: that at the end of the one before, less R (Uⁿ - Uⁿ⁻¹), since drag counts from
    the velocities at the start of a step; NaN where unknown."""
    before = np.full(len(model.velocities), np.nan)
    if state.coupling is None or state.past is None:
        return before
    latest = state.coupling.model.velocities
    _, here, there = np.intersect1d(model.velocities, latest, return_indices=True)
    change = flat(state.motions.twist) - flat(state.past.twist)
    slowed = state.coupling.model.friction_times(state.coupling.model.components(change))
    added = model.components(flat(newly_applied(system, state)))
    before[here] = (state.coupling.load - slowed)[there] + added[here]
    return before


def expected_load_of(system: System, state: State, model: ReducedModel, size: float) -> FloatArray:
    """Load Φ (c,) expected at the end of a step of this ``size`` [time]: grown from its start as fast as in the latest
    step where it grew slowly, else the mean of that step; weight and applied wrenches in the first."""
    if state.past is None:
        return model.components(flat(outer_load(system, state)))
    change = model.components(flat(state.motions.twist) - flat(state.past.twist))
    pushed = flat(state.motions.contact) + state.link.wrench
    impulse = model.components(pushed) * state.past.step
    applied = model.components(flat(newly_applied(system, state)))
    mean = expected_load(model, change, impulse, state.past.step) + applied
    before, growth = load_before(system, state, model), size / state.past.step * _growth(state, model)
    return np.where(np.abs(growth) < SLOW * np.abs(before), before + growth, mean)


def _growth(state: State, model: ReducedModel) -> FloatArray:
    """Growth of the load Φ (c,) in the latest step, NaN where unknown."""
    growth = np.full(len(model.velocities), np.nan)
    if state.coupling is not None:
        _, here, there = np.intersect1d(model.velocities, state.coupling.model.velocities, return_indices=True)
        growth[here] = (state.coupling.load - state.coupling.load_before)[there]
    return growth
