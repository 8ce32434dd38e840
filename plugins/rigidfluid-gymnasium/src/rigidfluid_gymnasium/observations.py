"""Observations of a run by an agent: their interface, and those of bodies, joints and the fluid."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar, get_args

import numpy as np

from rigidfluid.api import ArgumentError, FloatArray, SceneError, Simulation, suggestion
from rigidfluid_gymnasium.bounds import Bounded, component_count

T = TypeVar("T")
BodyQuantity = Literal[
    "position",
    "orientation",
    "velocity",
    "angular_velocity",
    "force",
    "torque",
    "contact_force",
    "contact_torque",
    "gap",
]
JointQuantity = Literal["value", "rate"]
ProbeQuantity = Literal["velocity", "pressure"]


@dataclass(frozen=True)
class Observation(Bounded, ABC):
    """Numbers that an agent sees after each of its actions; the bounds are those of the observation space."""

    @abstractmethod
    def read(self, run: Simulation) -> FloatArray:
        """The numbers (m,) at present; raises SceneError where the run does not have them."""


@dataclass(frozen=True)
class BodyValue(Observation):
    """A ``quantity`` of a ``body`` or mechanism, as `BodyNow` has it: ``force`` and ``torque`` are the
    fluid's."""

    body: str
    quantity: BodyQuantity

    def __post_init__(self) -> None:
        _check_quantity(self.quantity, get_args(BodyQuantity), "BodyValue")

    def length(self, dimension: int) -> int:
        turns = component_count(dimension) - dimension
        lengths = {"orientation": 1 if dimension == 2 else 4, "gap": 1}
        lengths |= dict.fromkeys(("angular_velocity", "torque", "contact_torque"), turns)
        return lengths.get(self.quantity, dimension)

    def read(self, run: Simulation) -> FloatArray:
        return np.atleast_1d(getattr(_named(run.bodies, self.body, "body"), self.quantity))


@dataclass(frozen=True)
class JointValue(Observation):
    """Coordinate of a ``joint``, the angle of a hinge or the displacement of a slider, or its ``rate``."""

    joint: str
    quantity: JointQuantity = "value"

    def __post_init__(self) -> None:
        _check_quantity(self.quantity, get_args(JointQuantity), "JointValue")

    def length(self, dimension: int) -> int:
        return 1

    def read(self, run: Simulation) -> FloatArray:
        state = run.state
        readings = run.system.joints.readings(state.pose, state.twist, run.time, state.link.force)
        return np.atleast_1d(getattr(_named({one.name: one for one in readings}, self.joint, "joint"), self.quantity))


@dataclass(frozen=True)
class ProbeValue(Observation):
    """Velocity or pressure of the fluid at a ``point``; within a body what is near."""

    point: Sequence[float]
    quantity: ProbeQuantity

    def __post_init__(self) -> None:
        _check_quantity(self.quantity, get_args(ProbeQuantity), "ProbeValue")

    def length(self, dimension: int) -> int:
        return dimension if self.quantity == "velocity" else 1

    def read(self, run: Simulation) -> FloatArray:
        if not run.system.has_fluid:
            raise SceneError("ProbeValue", "a run without a fluid", "one with a fluid", "Leave the observation out.")
        points = np.array([self.point], dtype=np.float64)
        velocity, pressure = run.system.backend.probe(run.state.fluid, run.state.mesh, points)
        return velocity[0] if self.quantity == "velocity" else pressure


def _check_quantity(quantity: str, allowed: Sequence[str], kind: str) -> None:
    """Refuse, with ArgumentError, a quantity that such an observation does not have."""
    if quantity not in allowed:
        remedy = suggestion(str(quantity), allowed) or "Name one of them."
        raise ArgumentError(f"{kind}.quantity", repr(quantity), f"one of {', '.join(allowed)}", remedy)


def _named(parts: dict[str, T], name: str, kind: str) -> T:
    if name not in parts:
        raise SceneError(kind, repr(name), f"one that is there: {', '.join(parts) or 'none is'}", "Name another.")
    return parts[name]
