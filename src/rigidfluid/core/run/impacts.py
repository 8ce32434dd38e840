"""Length of steps in an impact that they do not resolve, and after one."""

from __future__ import annotations

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.model.state import State
from rigidfluid.core.run.clock import Clock

TOLERATED_FRICTION = 3e-5
"""Greatest energy that friction takes on the bodies' path in a step, over the energy put in since the start [1].

The step loses several times as much: in the fluid an impact makes one viscous layer as thick as the whole step allows.
"""

MOST_HALVINGS = 5
"""Number of times at most that an impact, which may last a millionth of a step, halves it."""

TOLERATED_CREATION = 1e-3
"""Energy that a run and its contacts may have created, over that put in, before steps follow contacts closely."""

MOST_CLOSE_HALVINGS = 8
"""Number of times at most that a step is halved then."""

_SMOOTH = 0.1
"""Share of the drag left out below which the path's friction is that of velocities that turn smoothly in the step."""

_LEAST_AGE = 4
"""Least time since an impact, in steps of the length that is taken then."""


def is_unresolved(state: State, path: BodyStep, level: int) -> bool:
    """Tell whether a step of this ``level`` is to be halved, for the energy that an impact on its ``path`` would lose,
    or that a contact that turns velocities smoothly would create where the run has created some.

    Halvings count from the nominal step, or with a tolerance from the latest step without an impact.
    """
    halvings = level - (0 if state.estimate is None else state.estimate.level)
    tolerated = TOLERATED_FRICTION * state.ledger.put_in
    if halvings < MOST_HALVINGS and path.friction > tolerated:
        return True
    too_much = path.friction < _SMOOTH * path.drag_left_out and path.drag_left_out > tolerated
    return too_much and halvings < MOST_CLOSE_HALVINGS and _has_created(state)


def _has_created(state: State) -> bool:
    """Tell whether the run has created more energy than is tolerated, and its contacts have."""
    ledger = state.ledger
    return -max(ledger.residual, ledger.residual_contacts) > TOLERATED_CREATION * ledger.put_in


def level_after_impact(state: State, clock: Clock, level: int) -> int:
    """The first level from ``level`` on whose step is no longer than the longer of the step before and a quarter of the
    time since the latest impact.

    The layer that an impact leaves in the fluid decays over times as long as it is old.
    """
    if state.impact is None or state.level is None:
        return level
    age = state.tick - state.impact
    while level < state.level and _LEAST_AGE * clock.ticks(level) > age:
        level += 1
    return level
