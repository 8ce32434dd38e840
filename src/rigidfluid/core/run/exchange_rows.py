"""Rows of the bodies that an exchange lets enter and leave: what each one brings or takes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import angular_momentum, kinetic_energy, moment
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.output.records import Row
from rigidfluid.core.run.exchange import Exchange

ENTERED, GONE = "entered", "gone"


def exchange_rows(exchange: Exchange, before: State, after: State, time: float) -> list[Row]:
    """Rows of those that left a state ``before`` an exchange, and then of those that entered."""
    stamp = (time, before.count)
    gone = _rows(exchange.before, before, exchange.gone, (*stamp, GONE))
    return [*gone, *_rows(exchange.after, after, exchange.come, (*stamp, ENTERED))]


def _rows(system: System, state: State, bodies: IntArray, told: tuple[float, int, str]) -> Iterator[Row]:
    time, step, change = told
    for body in bodies.tolist():
        place = state.pose.position[body].tolist()
        yield (time, step, system.surfaces[body], change, *place, *_content(system, state, body))


def _content(system: System, state: State, body: int) -> list[float]:
    """Mass, momentum, angular momentum about the origin, and kinetic energy as the ledger has it, of one body."""
    one = np.array([body])
    mass, inertia = system.mass[one], system.inertia[one]
    pose = Pose(state.pose.position[one], state.pose.orientation[one])
    twist = Twist(state.twist.velocity[one], state.twist.angular_velocity[one])
    momentum = mass[:, None] * twist.velocity
    spin = angular_momentum(inertia, pose.orientation, twist.angular_velocity)
    angular: FloatArray = spin + moment(pose.position, momentum)
    kinetic = 0.0 if system.prescribed[body] else kinetic_energy(mass, inertia, pose, twist)
    return [*mass.tolist(), *momentum[0].tolist(), *angular[0].tolist(), kinetic]
