"""Fluid–contact coupling of one step: reduced mass and resistance, and the non-contact load Φ."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.answers import updated_model
from rigidfluid.core.contact.contact_path import BodyStep, near_contacts
from rigidfluid.core.mechanics.fluid_step import step_to
from rigidfluid.core.mechanics.motions import newly_applied, outer_load, round_motions, twist_arms
from rigidfluid.core.mechanics.time_scheme import derivative_weights
from rigidfluid.core.mechanics.wrenches import flat, nothing
from rigidfluid.core.model.reduced_model import Coupling, ReducedModel, expected_load, load_within
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, FloatArray, IntArray, Step

SETTLED = 1e-3
"""Relative change of the bodies' velocities below which the iteration of a step has converged."""

SETTLED_SHARED = 1e-2
"""Relative change of velocities for convergence where bodies share questions, whose responses are no better."""

STEADY = 1e-2
"""Relative change of the contacts' impulses below which one fluid solve may be enough."""


def expected_coupling(system: System, state: State, time: float, size: float) -> Coupling | None:
    """Coupling of a step from ``time`` over ``size`` [time] with the present mesh and the latest step's loads, and the
    state's own model where it has one; None where nothing can touch."""
    if not system.has_fluid:
        return None
    near = near_contacts(system, state, time, size)
    if len(near) == 0:
        return None
    velocities = _velocities(system, near)
    step = step_to(system, state, time + size, size, state.motions.pose, nothing(state.motions.pose), None)
    known = None if state.coupling is None else state.coupling.model
    model = updated_model(system, state, step, state.contacts, flat(state.motions.twist), velocities, known)
    before, expected = _load_before(system, state, model), _expected_load(system, state, model)
    if system.quasi_steady:  # the fluid remembers nothing: Φ is its force on the bodies now, and what pulls them
        now = _components(model, flat(outer_load(system, state)) + flat(state.motions.hydrodynamic))
        before = expected = np.where(np.isnan(before), now, before)
    return Coupling(model, expected, before, np.zeros(len(velocities)))


def shown_coupling(system: System, state: State, candidate: State, path: BodyStep, step: Step) -> Coupling:
    """Coupling by the fluid solve of a ``step`` from ``state`` to ``candidate`` along ``path``: responses on the mesh
    at its end, and loads in it, of the same velocities."""
    assert path.coupling is not None
    used = path.coupling
    twist, velocities = flat(candidate.motions.twist), used.model.velocities
    model = updated_model(system, state, step, candidate.contacts, twist, velocities, used.model)
    past = state.past_twist or state.motions.twist
    twists = tuple(_components(model, flat(twist)) for twist in (candidate.motions.twist, state.motions.twist, past))
    before = (flat(state.motions.contact) + _applied(state)) * (state.past_step or 0.0)
    applied = _applied(candidate)
    impulses = _components(model, step.impulse + (candidate.past_step or 0.0) * applied), _components(model, before)
    load = load_within(model, step.derivative, (twists[0], twists[1], twists[2]), impulses) - used.correction
    load = load + _components(model, applied)
    load = load - _components(model, candidate.link.wrench)
    missed = _components(model, flat(path.motions.twist)) - twists[0]
    return Coupling(model, load, used.load_before, used.correction + _correction(system, model, step, missed))


def unforeseen(system: System, state: State, candidate: State) -> bool:
    """Whether a contact is in range at the end of a step that was beyond the detector's reach at its start, or a pair
    has more of them than were seen.

    A detector that needs no mesh is asked on the way, and misses none.
    """
    if system.law is None or not system.detector.needs_mesh:
        return False
    count = len(system.surfaces)
    seen, found = (now.contacts.body_a * count + now.contacts.body_b for now in (state, candidate))
    pairs, met = np.unique(found[candidate.contacts.gap < system.law.range], return_counts=True)
    return bool(np.any(met > np.count_nonzero(seen == pairs[:, None], axis=1)))


def _correction(system: System, model: ReducedModel, step: Step, missed: FloatArray) -> FloatArray:
    """Force (d₀M + R) U (c,) of the velocities ``missed`` U (c,) by the solve; zero in a fluid with inertia."""
    if not system.quasi_steady:
        return np.zeros_like(missed)
    return np.asarray(step.derivative[0] * model.mass_times(missed) + model.friction_times(missed))


def unsteady(system: System, state: State, path: BodyStep, size: float) -> bool:
    """Whether contact impulses changed by more than STEADY, so that a second iteration is certain."""
    if path.coupling is None:
        return False
    arms = twist_arms(system)
    now, before = flat(path.motions.contact) / arms, size * flat(state.motions.contact) / arms
    return bool(np.linalg.norm(now - before) > STEADY * np.linalg.norm(now))


def settled(system: System, found: Coupling, path: BodyStep, state: State, candidate: State) -> bool:
    """Whether the fixed-point iteration between contact path and fluid solve has converged, with the coupling
    ``found``.

    Changes are those of velocities. They are the response over the step in a fluid without inertia: by its end friction
    has damped the response of the bodies' mass alone.
    """
    assert path.coupling is not None
    used, model, size = path.coupling, found.model, (candidate.past_step or 0.0)
    if len(model.velocities) == 0:
        return True
    impulse, d0 = _components(model, flat(path.motions.contact)), float(derivative_weights(size, state.past_step)[0])

    def given(answering: ReducedModel, force: FloatArray) -> FloatArray:
        return answering.answer(d0, force) if system.quasi_steady else answering.mobility @ force

    gained = given(model, impulse)
    before, after = (_components(model, flat(twist)) for twist in (state.motions.twist, candidate.motions.twist))
    by_load = size * (given(model, found.load) - given(used.model, used.load))
    by_answer = gained - given(used.model, impulse)
    missed = model.answer(d0, found.correction - used.correction) / d0
    arm = _components(model, twist_arms(system))
    scale = max(float(np.linalg.norm(arm * each)) for each in (before, after, gained))
    enough = SETTLED_SHARED if model.shared else SETTLED
    return max(float(np.linalg.norm(arm * each)) for each in (by_load, by_answer, missed)) <= enough * scale


def _velocities(system: System, near: Contacts) -> IntArray:
    """Numbers of the velocity components of free motions that contacts can change: balls turn by friction alone.

    Motions that joints hold are always among them, as joint forces are found from the responses of all.
    """
    count, d, carrier = len(system.bodies), system.dimension, system.motions.carrier
    width = d + (1 if d == 2 else 3)
    touching = np.zeros(len(system.motions.controlled), dtype=bool)
    touching[carrier[near.body_a]] = True
    touching[carrier[near.body_b[near.body_b < count]]] = True
    moves = np.repeat((touching & ~system.motions.controlled)[:, None], width, axis=1)
    if system.law is not None and not system.law.dissipative:
        moves[round_motions(system), d:] = False
    moves[system.joints.linked & ~system.motions.controlled] = True
    return np.flatnonzero(moves)


def _load_before(system: System, state: State, model: ReducedModel) -> FloatArray:
    """Load Φ (c,) at the start of a step: at the end of the one before, less the friction that came up in that step;
    NaN where unknown."""
    before = np.full(len(model.velocities), np.nan)
    if state.coupling is None or state.past is None:
        return before
    latest = state.coupling.model.velocities
    _, here, there = np.intersect1d(model.velocities, latest, return_indices=True)
    change = flat(state.motions.twist) - flat(state.past.twist)
    slowed = state.coupling.model.friction_times(_components(state.coupling.model, change))
    added = _components(model, flat(newly_applied(system, state)))
    before[here] = (state.coupling.load - slowed)[there] + added[here]
    return before


def _expected_load(system: System, state: State, model: ReducedModel) -> FloatArray:
    if state.past is None:
        return _components(model, flat(outer_load(system, state)))
    change = _components(model, flat(state.motions.twist) - flat(state.past.twist))
    pushed = flat(state.motions.contact) + state.link.wrench
    impulse = _components(model, pushed) * state.past.step
    applied = _components(model, flat(newly_applied(system, state)))
    return expected_load(model, change, impulse, state.past.step) + applied


def _applied(state: State) -> FloatArray:
    """Mean applied wrench on the motions in the step that led to a ``state``, (N, d+k)."""
    if state.past is None or state.past.applied is None:
        return np.zeros_like(flat(state.motions.contact))
    return flat(state.past.applied)


def _components(model: ReducedModel, field: FloatArray) -> FloatArray:
    """Components (c,) of a field (n, d+k) that the model has."""
    return np.asarray(field.ravel()[model.velocities])
