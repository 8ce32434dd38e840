"""A swimmer of three disks learns its stroke in Stokes flow by the cross-entropy method.

    python plugins/rigidfluid-gymnasium/examples/learn_stroke.py out/stroke

Nothing tells it how to swim: its arms may be short or long, and what counts is how far it gets, in radii. An action
lasts 1; both arms are somewhere between short and long at its end, where the agent sends them by what it sees, their
present lengths: targets = tanh(W · lengths + b), with six numbers that are learned. The best stroke known moves one arm
at a time, without going back the same way (Najafi and Golestanian, Phys. Rev. E 69, 062901, 2004).
"""

from __future__ import annotations

import argparse
import csv
import resource
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from gymnasium.vector import AsyncVectorEnv

from rigidfluid.api import FloatArray, Simulation, load_scene
from rigidfluid_gymnasium import FluidEnv, JointDrive, JointValue, Moment, Task, parallel_envs

SCENE = Path(__file__).with_name("swimmer.toml")
RADIUS, STEPS_PER_ACTION = 0.5, 4
ARMS = ("rear arm", "front arm")
KNOWN = np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
"""The known stroke, forwards: targets of the arms, one action after the other."""
POPULATION, ELITE = 16, 4


def progress(before: Moment, run: Simulation) -> float:
    """Way of the three disks' centre to the front since an action began, in radii."""
    ways = [body.position[0] - before.bodies[name].position[0] for name, body in run.bodies.items()]
    return float(np.mean(ways)) / RADIUS


def swimming(*assignments: str) -> Task:
    """The task, with keys of the scene set otherwise, as ``time.end=8``."""
    return Task(
        case=load_scene(SCENE, assignments),
        actions=[JointDrive(arm, low=0.0, high=1.0) for arm in ARMS],
        observations=[JointValue(arm, low=-0.1, high=1.1) for arm in ARMS],
        reward=progress,
        steps_per_action=STEPS_PER_ACTION,
    )


def targets(policies: FloatArray, lengths: FloatArray) -> FloatArray:
    """Actions (n, 2) of n ``policies`` (n, 6) that see arms of these ``lengths`` (n, 2)."""
    weights, offsets = policies[:, :4].reshape(-1, 2, 2), policies[:, 4:]
    return np.tanh(np.einsum("nij,nj->ni", weights, 2.0 * lengths - 1.0) + offsets)


def returns(envs: AsyncVectorEnv, policies: FloatArray) -> FloatArray:
    """Sum of rewards (n,) of each of n policies over an episode, as many at a time as there are environments."""
    found = []
    for some in np.split(policies, len(policies) // envs.num_envs):
        lengths, _ = envs.reset(seed=0)
        total, over = np.zeros(len(some)), np.zeros(len(some), dtype=bool)
        while not over.all():
            lengths, reward, _, truncated, _ = envs.step(targets(some, lengths))
            total += np.where(over, 0.0, reward)
            over |= truncated
        found.append(total)
    return np.concatenate(found)


def learn(envs: AsyncVectorEnv, generations: int, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    """The mean of the last elite (6,), and all returns (generations, population)."""
    random, mean, width, curve = np.random.default_rng(seed), np.zeros(6), np.ones(6), []
    for generation in range(generations):
        policies = mean + width * random.standard_normal((POPULATION, len(mean)))
        curve.append(returns(envs, policies))
        elite = policies[np.argsort(curve[-1])[-ELITE:]]
        mean, width = elite.mean(axis=0), elite.std(axis=0) + 0.3 * 0.8**generation
        print(f"generation {generation + 1}: mean {curve[-1].mean():.4f}, best {curve[-1].max():.4f} radii", flush=True)
    return mean, np.array(curve)


def swim(env: FluidEnv, policy: FloatArray | None) -> tuple[float, FloatArray]:
    """Sum of rewards over an episode, and the arms' lengths (a+1, 2) after each of a actions, by a ``policy`` (6,) or,
    without one, by the known stroke."""
    lengths, total, over = [env.reset(seed=0)[0]], 0.0, False
    while not over:
        known = KNOWN[(len(lengths) - 1) % len(KNOWN)]
        action = known if policy is None else targets(policy[None], lengths[-1][None])[0]
        seen, reward, _, over, _ = env.step(action)
        total += reward
        lengths.append(seen)
    return total, np.array(lengths)


def draw(file: Path, curve: FloatArray, learned: FloatArray, known: tuple[float, FloatArray]) -> None:
    """Returns over generations, and the arms' lengths in the episode of what was ``learned``."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
    generation = np.arange(1, len(curve) + 1)
    left.plot(np.repeat(generation, curve.shape[1]), curve.ravel(), ".", color="0.75", label=f"each of {POPULATION}")
    left.plot(generation, np.sort(curve)[:, -ELITE:].mean(axis=1), label=f"mean of the best {ELITE}")
    left.plot(generation, curve.mean(axis=1), label="mean")
    left.axhline(known[0], color="k", linestyle="--", label="known stroke")
    left.set(xlabel="generation", ylabel="way in an episode [radii]")
    left.legend(fontsize="small", loc="lower right")
    right.plot(*known[1].T, "k--", label="known stroke")
    right.plot(*learned.T, "o-", label="learned")
    right.set(xlabel="displacement of the rear arm", ylabel="displacement of the front arm", aspect="equal")
    right.legend(fontsize="small", loc="center")
    figure.savefig(file, dpi=110)
    plt.close(figure)


def cpu_minutes() -> float:
    """CPU time of this process and of those that it has waited for [min]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used) / 60.0


def main() -> None:
    """Learn, and write curve, policy and figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where stroke.csv and stroke.png go")
    parser.add_argument("--generations", type=int, default=12)
    parser.add_argument("--processes", type=int, default=2, choices=[1, 2, 4, 8, 16])
    given = parser.parse_args()
    task = swimming()
    envs = parallel_envs(task, given.processes)
    policy, curve = learn(envs, given.generations)
    envs.close()
    env = FluidEnv(task)
    known, (way, learned) = swim(env, None), swim(env, policy)
    given.folder.mkdir(parents=True, exist_ok=True)
    with (given.folder / "stroke.csv").open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["generation", "mean", "elite", "best"])
        for number, row in enumerate(np.sort(curve), start=1):
            rows.writerow([number, *(f"{value:.5f}" for value in (row.mean(), row[-ELITE:].mean(), row[-1]))])
    draw(given.folder / "stroke.png", curve, learned, known)
    print(f"learned: {way:.4f} radii, known stroke: {known[0]:.4f}; policy {policy.round(2).tolist()}")
    print(f"{cpu_minutes():.1f} CPU minutes")


if __name__ == "__main__":
    main()
