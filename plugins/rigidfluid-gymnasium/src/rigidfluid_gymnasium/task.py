"""Task of an agent, and the scene in which it acts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.api import ArgumentError, BodyNow, Model, Scene, Simulation, model_of
from rigidfluid_gymnasium.actions import Action
from rigidfluid_gymnasium.observations import Observation


@dataclass(frozen=True)
class Moment:
    """A run before an action: ``time`` [time], all ``bodies`` by name, and ``work`` that forces applied, prescribed
    motions and drives have done until then [energy]."""

    time: float
    bodies: Mapping[str, BodyNow]
    work: float


def present_moment(run: Simulation) -> Moment:
    """The moment that a run has reached."""
    return Moment(run.time, run.bodies, run.state.ledger.control)


def never(run: Simulation) -> bool:
    """False: nothing ends the episode before the scene's end."""
    return False


@dataclass(frozen=True)
class Task:
    """A scene, what an agent sets and sees in it, and what it is rewarded for.

    Parameters
    ----------
    case : Scene, Model or callable
        What runs in each episode, or a function that makes it of a random generator.
    actions : sequence of Action
        What the agent sets, one for each part.
    observations : sequence of Observation
        What it sees.
    reward : callable
        ``reward(before, run)``, of the `Moment` before the action and the run after it.
    steps_per_action : int
        Steps of `time.step` from one action to the next.
    terminated : callable
        ``terminated(run)``: whether the episode is over by its own rules; never, if not given.
    settle : float
        How long the run goes on by itself before an episode begins [time].

    Raises
    ------
    ArgumentError
        Where a value is not allowed.
    """

    case: Scene | Model | Callable[[np.random.Generator], Scene | Model]
    actions: Sequence[Action]
    observations: Sequence[Observation]
    reward: Callable[[Moment, Simulation], float]
    steps_per_action: int
    terminated: Callable[[Simulation], bool] = never
    settle: float = 0.0

    def __post_init__(self) -> None:
        fewest = max((action.fewest_steps for action in self.actions), default=1)
        if self.steps_per_action < fewest:
            raise ArgumentError("Task.steps_per_action", self.steps_per_action, f"at least {fewest}", "Take more.")
        if not (self.actions and self.observations):
            found = f"{len(self.actions)} actions and {len(self.observations)} observations"
            raise ArgumentError("Task", found, "at least one of each", "Add what is missing.")
        targets = [(type(action), action.name) for action in self.actions]
        for target in targets:
            if targets.count(target) > 1:
                found = f"{targets.count(target)} of type {target[0].__name__} on {target[1]!r}"
                raise ArgumentError("Task.actions", found, "one, with bounds for each component", "Make them one.")

    @property
    def varies(self) -> bool:
        """Whether each episode has a case of its own."""
        return not isinstance(self.case, Scene | Model)

    def model(self, random: np.random.Generator) -> Model:
        """The model of an episode."""
        return model_of(self.case if isinstance(self.case, Scene | Model) else self.case(random))
