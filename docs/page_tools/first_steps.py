"""The first steps of a run in a few numbers, by which it is seen whether the same scene still has the same results."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rigidfluid.core.output.history import History
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene

KEPT, STEPS = (1, 2, 4, 8, 16, 32), 4
"""Steps of which numbers are kept, and up to which they are made again."""

ROUND_OFF = 1e-8
"""Difference, over the largest of a quantity, that is another machine's rounding and no other result."""

QUANTITIES = {"position": ("x", "y", "z"), "velocity": ("vx", "vy", "vz"), "force": ("fx", "fy", "fz")}

Steps = dict[str, dict[str, float]]
"""By the number of a step: root mean square over all bodies and axes, by quantity."""


def steps_of(history: History) -> Steps:
    """Numbers after those steps of `KEPT` that a run has made, to 12 digits."""
    bodies = history.bodies
    times = np.unique(bodies["time"])
    return {str(number): _means(bodies, times[number]) for number in KEPT if number < len(times)}


def first_steps(scene: Scene, last: int) -> Steps:
    """Run a scene until the step ``last``, and give the same numbers."""
    run = Simulation(scene)
    for _ in range(last):
        if run.ended:
            break
        run.step()
    return steps_of(run.history)


def difference(known: Steps, found: Steps) -> float:
    """Largest difference of any quantity in the steps of both, over the largest that is known of it; infinite where
    one has no such number."""
    shared = known.keys() & found.keys()
    if not shared:
        return float("inf")
    return max(_apart([known[step] for step in shared], [found[step] for step in shared], name) for name in QUANTITIES)


def _apart(known: list[dict[str, float]], found: list[dict[str, float]], name: str) -> float:
    if known == found:
        return 0.0
    scale = max(abs(one[name]) for one in known)
    off = max(abs(one[name] - other[name]) for one, other in zip(known, found, strict=True))
    return off / scale if scale > 0.0 else float("inf") * (off > 0.0)


def _means(bodies: Mapping[str, np.ndarray], time: float) -> dict[str, float]:
    now = bodies["time"] == time
    found = {}
    for name, axes in QUANTITIES.items():
        values = [bodies[axis][now] for axis in axes if axis in bodies]
        found[name] = float(f"{np.sqrt(np.mean(np.square(values))):.11e}")
    return found
