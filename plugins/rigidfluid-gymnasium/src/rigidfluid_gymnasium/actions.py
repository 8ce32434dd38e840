"""Actions of an agent on a run: their interface, and those on a body by name."""

from __future__ import annotations

from abc import ABC
from dataclasses import dataclass
from typing import ClassVar

from rigidfluid.api import FloatArray, Model, Simulation
from rigidfluid_gymnasium.bounds import Bounded, component_count
from rigidfluid_gymnasium.course import Course


@dataclass(frozen=True)
class Action(Bounded, ABC):
    """Something that an agent sets, anew at each of its actions; ``name`` is that of the part it acts on.

    An entry of the action space, from -1 to 1, stands for each component, and goes linearly from ``low`` to ``high``; a
    component whose bounds are the same is constant and has none. A kind of one's own overrides `act`, or `followed_by`
    where the model has to follow the ``course`` of the values.
    """

    name: str

    start: ClassVar[float] = 0.0
    """All values before the first action."""
    fewest_steps: ClassVar[int] = 1
    """Fewest steps of the run that an action has to last."""

    def followed_by(self, model: Model, course: Course) -> Model:
        """The model with a part that follows a ``course`` of the values; the same model unless said otherwise."""
        return model

    def act(self, run: Simulation, values: FloatArray, over: float) -> None:
        """Give the ``values`` (m,) to a run whose next action comes ``over`` a time; nothing unless said otherwise."""


@dataclass(frozen=True)
class AppliedWrench(Action):
    """Force on a free body and torque about its centre of mass, (d+k,), constant until the next action
    [force, force·length]."""

    def length(self, dimension: int) -> int:
        return component_count(dimension)

    def act(self, run: Simulation, values: FloatArray, over: float) -> None:
        d = run.model.dimension
        run.apply(self.name, force=values[:d].tolist(), torque=values[d:].tolist())


@dataclass(frozen=True)
class PrescribedTwist(Action):
    """Velocity and angular velocity of a fixed or prescribed body, (d+k,), that it reaches linearly by the next action
    [length/time, rad/time]."""

    def length(self, dimension: int) -> int:
        return component_count(dimension)

    def act(self, run: Simulation, values: FloatArray, over: float) -> None:
        d = run.model.dimension
        velocity, angular_velocity = values[:d].tolist(), values[d:].tolist()
        run.prescribe(self.name, velocity, angular_velocity, over)
