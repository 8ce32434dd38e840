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

_LEAST_AGE = 4
"""Least time since an impact, in steps of the length that is taken then."""


def is_unresolved(state: State, path: BodyStep, level: int) -> bool:
    """Tell whether a step of this ``level`` is to be halved, for the energy that an impact on its ``path`` would lose.

    Halvings count from the nominal step, or with a tolerance from the latest step without an impact.
    """
    level_before = 0 if state.estimate is None else state.estimate.level
    return level < level_before + MOST_HALVINGS and path.friction > TOLERATED_FRICTION * state.ledger.put_in


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
