"""A task as an environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.error import ResetNeeded

from rigidfluid.api import FloatArray, SavedRun, SceneError, Simulation, StepError
from rigidfluid_gymnasium.course import Course, Row
from rigidfluid_gymnasium.spaces import ActionSpace, ObservationSpace
from rigidfluid_gymnasium.task import Task, present_moment


@dataclass(frozen=True)
class _Episode:
    """A run, and the ``courses`` of values that actions set in it."""

    run: Simulation
    courses: Sequence[Course]


@dataclass(frozen=True)
class EnvState:
    """An environment as `FluidEnv.save` kept it."""

    owner: FluidEnv
    episode: _Episode
    run: SavedRun
    rows: tuple[tuple[Row, ...], ...]
    ended: bool
    random: Mapping[str, Any]


class FluidEnv(gym.Env[FloatArray, FloatArray]):
    """Rigid bodies in a fluid, or without one, that an agent acts on.

    The action space is a box from -1 to 1, the observation space a box of the bounds that the ``task`` names. An
    episode is truncated at the scene's end, or where a step fails: `info["cause"]` says why. What is observed beyond
    its bounds is clipped, and `info["clipped"]` names it.

    Parameters
    ----------
    task : Task
        Scene, actions, observations and reward.

    Raises
    ------
    SceneError
        Where the scene, or bounds, cannot be used.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  as in the class it derives from

    def __init__(self, task: Task) -> None:
        self.task = task
        model = task.model(np.random.default_rng(0))
        self._over = model.time.step * task.steps_per_action
        self._actions = ActionSpace(task.actions, model.dimension)
        self._observations = ObservationSpace(task.observations, model.dimension)
        self.action_space, self.observation_space = self._actions.box, self._observations.box
        self._episode: _Episode | None = None
        self._first: EnvState | None = None
        self._ended = True

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begin an episode: where the case is always the same, by going back to where the first one began."""
        super().reset(seed=seed)
        if self._first is None or self.task.varies:
            self._episode = self._begin()
            self._first = self.save()
        else:
            self._go_back(self._first)
        self._ended = False
        return self._observation()

    def step(self, action: FloatArray) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        """Set what the agent wants, and go on until its next action; raises ArgumentError for an action outside the
        space, ResetNeeded after an episode's end."""
        if self._episode is None or self._ended:
            raise ResetNeeded("The episode is over, or has not begun: call reset() before step().")
        run, values = self._episode.run, self._actions.values(action)
        before, cause = present_moment(run), None
        try:
            self._set(self._episode, values)
            run.go(run.time + self._over)
        except StepError as error:
            cause = str(error)
        if cause is None and run.ended:
            cause = f"the scene's end, {run.time:g}, is reached"
        terminated, reward = bool(self.task.terminated(run)), float(self.task.reward(before, run))
        self._ended = terminated or cause is not None
        observed, info = self._observation()
        return observed, reward, terminated, cause is not None, info | ({} if cause is None else {"cause": cause})

    @property
    def run(self) -> Simulation:
        """The run of the present episode; raises ResetNeeded before the first."""
        return self._present.run

    def save(self) -> EnvState:
        """Keep the environment as it is now, in memory: what follows equals what follows `restore` to the last bit."""
        episode = self._present
        rows = tuple(course.rows for course in episode.courses)
        return EnvState(self, episode, episode.run.save(), rows, self._ended, self.np_random.bit_generator.state)

    def restore(self, state: EnvState) -> tuple[FloatArray, dict[str, Any]]:
        """Go back to where it was saved, with the random numbers of then, and observe; raises SceneError where another
        environment was saved."""
        if state.owner is not self:
            found, allowed = "a state of another environment", "one that this environment has saved"
            raise SceneError("restore", found, allowed, "Restore it where it was saved.")
        self._go_back(state)
        self.np_random.bit_generator.state = state.random
        return self._observation()

    @property
    def _present(self) -> _Episode:
        if self._episode is None:
            raise ResetNeeded("No episode has begun: call reset() first.")
        return self._episode

    def _begin(self) -> _Episode:
        model, courses = self.task.model(self.np_random), []
        for action, length in zip(self.task.actions, self._actions.lengths, strict=True):
            courses.append(Course(np.full(length, action.start)))
            model = action.followed_by(model, courses[-1])
        run = Simulation(model)
        run.go(self.task.settle)
        return _Episode(run, courses)

    def _go_back(self, state: EnvState) -> None:
        self._episode, self._ended = state.episode, state.ended
        for course, rows in zip(state.episode.courses, state.rows, strict=True):
            course.rows = rows
        state.episode.run.restore(state.run)

    def _set(self, episode: _Episode, values: Sequence[FloatArray]) -> None:
        for action, course, own in zip(self.task.actions, episode.courses, values, strict=True):
            course.turn(episode.run.time, own, self._over)
            action.act(episode.run, own, self._over)

    def _observation(self) -> tuple[FloatArray, dict[str, Any]]:
        """Present observation, and the information with it."""
        run = self._present.run
        observed, clipped = self._observations.clipped([one.read(run) for one in self.task.observations])
        return observed, {"time": run.time} | ({"clipped": clipped} if clipped else {})
