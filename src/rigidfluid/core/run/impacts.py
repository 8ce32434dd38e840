"""Length of steps in an impact that they do not resolve, and after one."""

from __future__ import annotations

from rigidfluid.core.contact.body_step import BodyStep
from rigidfluid.core.model.state import State
from rigidfluid.core.run.clock import Clock

TOLERATED = 3e-5
"""Friction loss on the bodies' path of one step, over the energy put in since the start, above which the step is
halved: it would lose several times as much, since its fluid answers to the impact by one thick layer."""

HALVINGS = 5
"""An impact halves a step so many times at most: it may last a millionth of it."""

YOUNGEST = 4
"""Least age of an impact over the step that is taken then."""


def is_unresolved(state: State, path: BodyStep, level: int) -> bool:
    """Whether a step of this ``level`` is to be halved for what an impact on its ``path`` would lose.

    Halvings count from the nominal step, or from what a tolerance made of it before the impact.
    """
    before = 0 if state.estimate is None else state.estimate.level
    return level < before + HALVINGS and path.friction > TOLERATED * state.ledger.put_in


def level_after_impact(state: State, clock: Clock, level: int) -> int:
    """The first level, from ``level`` on, of a step not longer than the one before or a quarter of the time since an
    impact.

    The layer that an impact leaves in the fluid decays over times as long as it is old.
    """
    if state.impact is None or state.level is None:
        return level
    age = state.tick - state.impact
    while level < state.level and YOUNGEST * clock.ticks(level) > age:
        level += 1
    return level
