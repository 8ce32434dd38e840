"""Times at which what is given of a relative motion changes its rate at once: a step ends there, and the next is as a
first one."""

from __future__ import annotations

import math
from dataclasses import replace

from rigidfluid.core.coupling.scheme import Scheme
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.initial_state import start_level


def level_to_corner(system: System, clock: Clock, tick: int, level: int) -> int:
    """The first level, from ``level`` on, of a step from a ``tick`` that passes no corner."""
    corner = _corner_after(system, clock, tick)
    while level < clock.levels and tick + clock.ticks(level) > corner:
        level += 1
    return level


def restarted(system: System, scheme: Scheme, clock: Clock, state: State) -> State:
    """State without its past, from which nothing can be extrapolated, at a corner or jump and one step after it; else
    the same.

    The fluid, if there is one, is in motion with bodies that change theirs at once, as at a start. After a jump that a
    caller has prescribed the level is known already.
    """
    if state.past is None:
        return state
    if state.jumped is not None and state.jumped in (state.tick, state.tick - clock.tick_from(state.past.step)):
        return replace(state, past=None)
    if _is_corner(system, clock, state.tick):
        estimate = state.estimate and state.estimate.restarted
        return scheme.restarted(replace(state, past=None, estimate=estimate), start_level(clock))
    if _is_corner(system, clock, state.tick - clock.tick_from(state.past.step)):
        return replace(state, past=None)
    return state


def _is_corner(system: System, clock: Clock, tick: int) -> bool:
    """Tell whether there is one at this tick; a start is none."""
    return tick > 0 and _corner_after(system, clock, tick - 1) == tick


def _corner_after(system: System, clock: Clock, tick: int) -> float:
    """First tick after this at which there is a corner; infinite without any.

    A corner between two ticks is at the earlier one, so that the rate there is still that before the corner.
    """
    corner = _next_corner(system, clock.time(tick))
    while math.isfinite(corner) and clock.tick_until(corner) <= tick:
        corner = _next_corner(system, corner)
    return clock.tick_until(corner) if math.isfinite(corner) else math.inf


def _next_corner(system: System, time: float) -> float:
    return min(system.motions.next_corner(time), system.joints.next_corner(time))
