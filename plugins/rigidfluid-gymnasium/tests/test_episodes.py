"""Episodes: how they begin, end, branch and repeat themselves, and the same in processes of their own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from small_tasks import DISK, STEP, blown, dry_scene, joined, pushed, random_place, sampled
from threadpoolctl import threadpool_info

from rigidfluid.api import FloatArray, SceneError, Simulation
from rigidfluid_gymnasium import AppliedWrench, FluidEnv, Observation, Task, parallel_envs

TASKS = {"pushed": pushed(), "joined": joined(), "blown": blown(), "random": pushed(random_place)}


def played(env: FluidEnv, actions: FloatArray) -> list[Any]:
    """All that the steps return, and where the bodies are."""
    found: list[Any] = []
    for action in actions:
        seen, *others = env.step(action)
        found += [seen.tolist(), *others, env.run.state.pose.position.tolist()]
    return found


@pytest.mark.parametrize("task", TASKS.values(), ids=TASKS)
def test_a_branch_and_a_reset_repeat_the_same_to_the_last_bit(task: Task) -> None:
    env = FluidEnv(task)
    assert env.action_space.shape is not None
    actions = sampled(*env.action_space.shape, count=2)
    env.reset(seed=3)
    first = played(env, actions[:1])
    saved = env.save()
    rest = played(env, actions[1:])
    env.restore(saved)
    assert played(env, -actions[1:]) != rest
    env.restore(saved)
    assert played(env, actions[1:]) == rest
    env.reset(seed=3)
    assert played(env, actions) == first + rest
    other = FluidEnv(task)
    other.reset(seed=3)
    assert played(other, actions) == first + rest


def test_seeds_make_cases_and_restoring_gives_their_random_numbers_back() -> None:
    env = FluidEnv(pushed(random_place))
    starts = [env.reset(seed=seed)[0].tolist() for seed in (1, 2, 1)]
    assert starts[0] == starts[2] != starts[1]
    saved, following = env.save(), env.reset()[0].tolist()
    assert following != starts[0]
    assert env.restore(saved)[0].tolist() == starts[0]
    assert env.reset()[0].tolist() == following


def test_a_run_settles_before_the_episode() -> None:
    env = FluidEnv(pushed(dry_scene(2.0, DISK | {"velocity": [1.0, 0.0]}), settle=0.5))
    for _ in range(2):
        seen, info = env.reset(seed=0)
        assert seen[0] == pytest.approx(5.5)
        assert info == {"time": 0.5}
        env.step(np.zeros(2))


def test_the_scenes_end_truncates() -> None:
    env = FluidEnv(pushed(dry_scene(end=6 * STEP)))
    env.reset(seed=0)
    assert env.step(np.zeros(2))[2:] == (False, False, {"time": 0.5})
    *_, terminated, truncated, info = env.step(np.zeros(2))
    assert (terminated, truncated) == (False, True)
    assert info == {"time": 0.75, "cause": "the scene's end, 0.75, is reached"}
    with pytest.raises(ResetNeeded, match="over"):
        env.step(np.zeros(2))
    env.reset(seed=0)
    assert env.step(np.zeros(2))[3] is False


def test_a_step_that_fails_truncates_and_is_told() -> None:
    """Nothing keeps the disk from the wall that it is driven into."""
    push = AppliedWrench("disk", low=(0.0, 0.0, 0.0), high=(50.0, 0.0, 0.0))
    env = FluidEnv(pushed(dry_scene(9.0), actions=[push], steps_per_action=40))
    env.reset(seed=0)
    seen, reward, terminated, truncated, info = env.step(np.array([1.0]))
    assert (terminated, truncated) == (False, True)
    assert "disk" in info["cause"]
    assert info["time"] == env.run.time < 5.0
    assert seen[0] == env.run.bodies["disk"].position[0] == pytest.approx(5.0 + reward)
    assert seen[0] > 8.0


def test_the_tasks_own_rules_terminate() -> None:
    env = FluidEnv(pushed(terminated=lambda run: run.bodies["disk"].position[0] > 5.1))
    env.reset(seed=0)
    assert env.step(np.array([1.0, 0.0]))[2:4] == (True, False)
    with pytest.raises(ResetNeeded):
        env.step(np.zeros(2))


def test_work_is_part_of_the_moment_before() -> None:
    """What a force does is the kinetic energy that it gives."""
    works: list[float] = []
    env = FluidEnv(pushed(reward=lambda before, run: works.append(before.work) or 0.0))
    env.reset(seed=0)
    env.step(np.array([1.0, 0.0]))
    speed = env.run.bodies["disk"].velocity[0]
    env.step(np.array([1.0, 0.0]))
    mass = 2.0 * np.pi * 0.25
    assert works == [0.0, pytest.approx(0.5 * mass * speed**2)]


def test_before_the_first_reset_there_is_nothing() -> None:
    env = FluidEnv(pushed())
    for call in (env.save, lambda: env.run, lambda: env.step(np.zeros(2))):
        with pytest.raises(ResetNeeded):
            call()


def test_a_state_of_another_environment_is_refused() -> None:
    one, other = FluidEnv(pushed()), FluidEnv(pushed())
    one.reset(seed=0)
    other.reset(seed=0)
    with pytest.raises(SceneError, match="restore: found a state of another environment"):
        other.restore(one.save())


@dataclass(frozen=True)
class Threads(Observation):
    """Most threads of any library."""

    def length(self, dimension: int) -> int:
        return 1

    def read(self, run: Simulation) -> FloatArray:
        return np.array([max(one["num_threads"] for one in threadpool_info())], dtype=float)


def test_processes_repeat_what_one_does_each_with_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.setenv(name, "2")
    task = blown(observations=[*blown().observations, Threads(low=0.0, high=99.0)])
    envs, env = parallel_envs(task, 2), FluidEnv(task)
    actions = sampled(2, count=2)
    try:
        envs.reset(seed=0)
        seen, rewards, *_ = envs.step(actions)
    finally:
        envs.close()
    for row, action in enumerate(actions):
        env.reset(seed=0)
        alone, reward, *_ = env.step(action)
        assert seen[row, :-1].tolist() == alone[:-1].tolist()
        assert rewards[row] == reward
    assert seen[:, -1].tolist() == [1.0, 1.0]
