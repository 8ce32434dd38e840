"""Runs scenes of stiff contacts in a fluid, and prints a line for each: energy created and lost, and other figures.

From the root of the project: python tests/support/fluid_contact_table.py dropped cradle --steps 4 2 1
"""

from __future__ import annotations

import argparse
import inspect
import time
from collections.abc import Callable
from functools import partial

import fluid_contacts as scenes
import numpy as np
from fluid_contacts import GRAVITY, RADIUS, created_and_lost, put_in, resting_gap

import rigidfluid
from rigidfluid.core.output.history import History
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import MeshError, StepError

Figures = Callable[[History], str]

ROW = "{:<20} {:>6} {:<9} {:>8} {:>8} {:>8} {:>8} {:>5} {:>5} {:>6}  {}"
HEADINGS = ("case", "Δt ms", "stepping", "created%", "lost%", "first%", "put in", "rej.", "mesh", "s", "figures")


def track(history: History, name: str) -> np.ndarray:
    """A column of the bodies' table, (steps, bodies)."""
    column = history.bodies[name]
    return column.reshape(-1, len(np.unique(history.bodies["body"])))


def numbers(values: np.ndarray, digits: int = 2) -> str:
    return " ".join(f"{value:.{digits}f}" for value in np.atleast_1d(values))


def rebounds(history: History) -> str:
    """Heights of the first three rebounds, above where the disk would rest on the floor."""
    height = track(history, "y")[:, 0]
    top = 1 + np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:]))
    return "rebounds " + numbers(height[top[:3]] - RADIUS - resting_gap(1e-9), 4)


def end_along(axis: str, history: History) -> str:
    """Where the bodies are along an axis at the end, and how fast they go along it."""
    place, speed = track(history, axis)[-1], track(history, f"v{axis}")[-1]
    return f"{axis} {numbers(place, 5)}  v{axis} {numbers(speed)}"


def end_velocity(history: History) -> str:
    """Velocities at the end, and the highest speed of all."""
    vx, vy = track(history, "vx"), track(history, "vy")
    return f"vx {numbers(vx[-1])}  vy {numbers(vy[-1])}  fastest {np.hypot(vx, vy).max():.1f}"


def quiet(history: History) -> str:
    """Speeds at the end, and in the last fifth the highest."""
    speed = np.hypot(track(history, "vx"), track(history, "vy"))
    return f"|v| {numbers(speed[-1])}  last fifth ≤ {speed[_last_fifth(history)].max():.2f}"


def borne(density: float, history: History) -> str:
    """In the last fifth: force of the contact over the weight and the speed; the highest speed, and the last gap."""
    weight = (density - 1.0) * np.pi * RADIUS**2 * GRAVITY
    late = _last_fifth(history)
    ratio, speed = track(history, "cfy")[late, 0] / weight, np.abs(track(history, "vy")[:, 0])
    force = f"F/W {ratio.mean():.5f} in {ratio.min():.4f} … {ratio.max():.4f}"
    return f"{force}  |v| ≤ {speed[late].max():.2g}, ever {speed.max():.3g}  gap {track(history, 'gap')[-1, 0]:.6f}"


def _last_fifth(history: History) -> slice:
    times = history.energy["time"]
    return slice(int(np.searchsorted(times, 0.8 * times[-1])), None)


ALONG_X, ALONG_Y = partial(end_along, "x"), partial(end_along, "y")
CASES: dict[str, tuple[Callable[..., Scene], Figures]] = {
    "dropped": (scenes.dropped, rebounds),
    "stacked": (scenes.stacked, quiet),
    "cradle": (scenes.cradle, ALONG_X),
    "cradle_light": (partial(scenes.cradle, density=0.2), ALONG_X),
    "heap": (scenes.heap, quiet),
    "light": (scenes.light, ALONG_X),
    "light_thin": (partial(scenes.light, viscosity=0.001), ALONG_X),
    "bounce": (scenes.bounce, ALONG_Y),
    "resting": (scenes.resting, partial(borne, 3.0)),
    "resting_stiff": (partial(scenes.resting, epsilon=1e-12), partial(borne, 3.0)),
    "settling": (scenes.settling, partial(borne, 3.0)),
    "stokes_floor": (scenes.stokes_pressed, partial(borne, 2.0)),
    "stokes_ceiling": (partial(scenes.stokes_pressed, density=0.1), partial(borne, 0.1)),
    "ellipse": (scenes.ellipse, end_velocity),
    "squeezed": (scenes.squeezed, end_velocity),
    "film": (scenes.film, ALONG_Y),
    "three_stacked": (scenes.three_stacked, quiet),
    "column": (scenes.column, quiet),
    "unlike_hit": (scenes.unlike_hit, end_velocity),
    "unlike_heap": (scenes.unlike_heap, quiet),
    "driven_hit": (scenes.driven_hit, end_velocity),
    "rough_fall": (scenes.rough_fall, end_velocity),
    "from_the_mesh": (scenes.from_the_mesh, ALONG_Y),
    "in_a_corner": (scenes.in_a_corner, end_velocity),
    "ball_dropped": (scenes.ball_dropped, partial(end_along, "z")),
    "head_on": (scenes.head_on, ALONG_X),
    "thin_film": (scenes.thin_film, ALONG_Y),
    "spun": (scenes.spun, end_velocity),
}


def made(case: str, step: float, stepping: str) -> Scene | None:
    """The scene, or None if it is not meant for this stepping."""
    make, _ = CASES[case]
    if "stepping" in inspect.signature(make).parameters:
        return make(step, stepping=stepping)
    return make(step) if stepping == "substeps" else None


def row(case: str, step: float, stepping: str) -> str | None:
    """The line of one run, or None if there is no such scene."""
    scene = made(case, step, stepping)
    if scene is None:
        return None
    run = f"{1e3 * step:g}", stepping
    start = time.perf_counter()
    try:
        history = rigidfluid.run(scene)
    except (StepError, MeshError) as error:
        seconds = f"{time.perf_counter() - start:.1f}"
        return ROW.format(case, *run, *[""] * 6, seconds, f"stops: {error.subject}: {error.found}")
    seconds = f"{time.perf_counter() - start:.1f}"
    shares = [f"{100.0 * share:.2f}" for share in created_and_lost(history)]
    counts = history.summary["rejected_steps"], history.summary["remeshes"]
    return ROW.format(case, *run, *shares, f"{put_in(history):.3f}", *counts, seconds, CASES[case][1](history))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("cases", nargs="*", help=f"all if none is given, of: {', '.join(CASES)}")
    parser.add_argument("--steps", nargs="+", type=float, default=[4.0, 2.0, 1.0], help="in ms")
    parser.add_argument("--stepping", nargs="+", choices=("substeps", "implicit"), default=["substeps"])
    arguments = parser.parse_args()
    if unknown := set(arguments.cases) - set(CASES):
        parser.error(f"no such case: {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")
    print(ROW.format(*HEADINGS))
    for case in arguments.cases or CASES:
        for stepping in arguments.stepping:
            for milliseconds in arguments.steps:
                line = row(case, 1e-3 * milliseconds, stepping)
                if line is not None:
                    print(line, flush=True)


if __name__ == "__main__":
    main()
