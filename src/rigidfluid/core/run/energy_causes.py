"""Cause of the energy that a step left unaccounted for: it restarted, its mesh was new, or contacts pushed otherwise
than before."""

from __future__ import annotations

from dataclasses import replace

from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.energy import Cause
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.masses import Masses

_SHARE_OF_START = 0.3
"""Share of the time since a sudden start from which on a step belongs to the start: the layer is as young as that, and
steps so long or longer do not resolve it."""


def with_cause(system: System, clock: Clock, state: State, candidate: State) -> State:
    """The candidate, with what the residual has grown by in the step from ``state`` put to its cause.

    Without one of the causes below it is the error of the time scheme in smooth motion: on a mesh that stays the same,
    convection, pressure and viscosity neither make nor take energy that the ledger does not know of.
    """
    step = clock.time(candidate.tick) - clock.time(state.tick)
    ledger = candidate.ledger.attributed(state.ledger, step, _cause(system, clock, state, candidate))
    return replace(candidate, ledger=ledger)


def _cause(system: System, clock: Clock, state: State, candidate: State) -> Cause | None:
    assert candidate.past is not None
    if state.past is None or candidate.past.step >= _SHARE_OF_START * state.ledger.since_start:
        return Cause.START
    if _is_remeshed(clock, state):
        return Cause.REMESHING
    return Cause.CONTACTS if _is_impact(system, clock, state, candidate) else None


def _is_remeshed(clock: Clock, state: State) -> bool:
    """Tell whether the state or the one before was carried to a new mesh: BDF2 differences both."""
    if state.reference.tick == 0 or state.level is None:
        return False
    return state.reference.tick >= state.tick - clock.ticks(state.level)


def _is_impact(system: System, clock: Clock, state: State, candidate: State) -> bool:
    """Tell whether the only contacts begin or end, contacts change at once by more energy than the step leaves over, or
    an impact goes on in which they store or give back more than that. Contacts that push all the time and yield slowly
    are none."""
    before, after = state.ledger, candidate.ledger
    grown = abs(after.residual - before.residual)
    if (before.contact == 0.0) != (after.contact == 0.0):
        return True
    if before.in_impact and abs(after.contact - before.contact) >= grown > 0.0:
        return True
    return 0.0 < grown <= _energy_of_contacts(system, clock, state, candidate)


def _energy_of_contacts(system: System, clock: Clock, state: State, candidate: State) -> float:
    """½ ΔJ·M⁻¹ΔJ of what the contacts' impulses have changed by since the step before, were bodies alone [energy].

    An impact changes them at once, in its step and back in the next; contacts at rest, or that yield slowly, hardly.
    """
    assert candidate.past is not None
    impulse = candidate.past.step * (flat(candidate.motions.contact) - flat(state.motions.contact))
    if not impulse.any():
        return 0.0
    return float(Masses(system, clock.time(candidate.tick), candidate).energies_by(impulse).sum())
