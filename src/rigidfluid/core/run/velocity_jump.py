"""Length of the steps after the velocity of a prescribed body has jumped in a fluid."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.initial_state import START_LEVEL
from rigidfluid.core.run.step import bodies_energy


def halvings_after(system: System, state: State, row: int, twist: FloatArray, step: float) -> int:
    """Number of times that ``step`` is to be halved after body ``row`` takes a ``twist`` (d+k,) at once: log₂ of its
    jump over a step's own change, at least none and at most `START_LEVEL`.

    A step's own change is what the body's velocity would change by in two ``step`` at its latest acceleration, or a
    64th of the speed of the body, before and after, or of the fluid, whichever is most: so a start from rest has the
    most halvings.
    """
    radius, d, now = system.bodies[row].bounding_radius, system.dimension, flat(state.motions.twist)[row]
    jump, accelerated = _speed(twist - now, radius, d), 0.0
    if state.past is not None:
        accelerated = _speed(now - flat(state.past.twist)[row], radius, d) * step / state.past.step
    fastest = max(_speed(now, radius, d), _speed(twist, radius, d), _fluid_speed(system, state))
    own = max(_LONGER * accelerated, fastest / 2.0**START_LEVEL)
    needed = math.ceil(math.log2(jump / own) - _ROUNDING) if jump > own else 0
    return min(needed, START_LEVEL)


def halvings_within(halvings: int, step: float, over: float | None) -> int:
    """Number of ``halvings`` that is left where a motion changes ``over`` a time and does not jump, which None says: a
    step then passes no more than that time."""
    return halvings if over is None else max(min(halvings, math.ceil(math.log2(step / over))), 0)


def shortened(state: State, clock: Clock, halvings: int) -> State:
    """The state from which the next step is halved so many times, or as it would be without if that is shorter; it
    restarts then, see `restarted`."""
    if halvings == 0:
        return state
    level = max(state.level or 0, min(halvings + 1, clock.levels))
    estimate = state.estimate and state.estimate.restarted
    return replace(state, level=level, estimate=estimate, jumped=state.tick)


def _fluid_speed(system: System, state: State) -> float:
    """Root of the mean square of the fluid's speed [length/time]."""
    if system.fluid is None:
        return 0.0
    energy = state.ledger.kinetic - bodies_energy(system, state.pose, state.twist)
    mass = system.fluid.density * system.meshed(state.pose).volume
    return math.sqrt(max(2.0 * energy, 0.0) / mass)


def _speed(twist: FloatArray, radius: float, dimension: int) -> float:
    """Bound of a surface's speed [length/time]."""
    return float(np.linalg.norm(twist[:dimension]) + radius * np.linalg.norm(twist[dimension:]))


_LONGER = 2.0
"""Largest ratio of the next step to the latest; a controller answers to twice the way then."""

_ROUNDING = 1e-9
"""Rounding of a number of halvings."""
