"""Scenes of contacts in a fluid without inertia, and what their runs must show; cm, g, s throughout."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from dry_scenes import ball
from extreme_scenes import ellipsoid
from fluid_contact_table import track
from fluid_contacts import (
    GRAVITY,
    RADIUS,
    REST,
    SIDE,
    STOKES,
    Stepping,
    created_and_lost,
    heavy,
    in_fluid,
    repulsion,
    resting_gap,
    stokes_pressed,
)

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import StepError

COARSE = {"size": 0.2, "size_body": 0.06}


def column(step: float, stepping: Stepping, epsilon: float = 1e-8) -> Scene:
    """Four disks of density 2 in a chimney sink onto the floor and onto each other."""
    disks = [heavy(0.2, 0.14 + 0.24 * i, density=2.0) for i in range(4)]
    contact, end = repulsion(stepping, epsilon), max(2.0, 10.0 * step)
    return in_fluid(contact, *disks, end=end, step=step, upper=(0.4, 1.16), fluid=STOKES)


def ellipse(step: float, stepping: Stepping) -> Scene:
    """A tilted ellipse of density 2 sinks onto the floor and lies down."""
    body = ellipsoid((0.4, 0.25), REST, (0.12, 0.06), density=2.0, angle=0.5)
    contact, end = repulsion(stepping, 1e-9, "normal"), max(0.6, 10.0 * step)
    return in_fluid(contact, body, end=end, step=step, fluid=STOKES)


def ball_in_cube(step: float, stepping: Stepping) -> Scene:
    """A ball of density 2 sinks onto the floor of a cube, with a coarse mesh."""
    coarse, contact = {"size": 0.25, "size_body": 0.1, "refinements": 2}, repulsion(stepping, 1e-8)
    body, end = ball((0.4, 0.4, 0.14), (0.0, 0.0, 0.0), density=2.0), max(0.2, 10.0 * step)
    return in_fluid(contact, body, end=end, step=step, upper=(SIDE, SIDE, SIDE), fluid=STOKES, mesh=coarse)


def swimmer(step: float, stepping: Stepping) -> Scene:
    """A three-sphere swimmer of density 2 sinks onto the floor and crawls there, four strokes in .4."""
    contact, end, box = repulsion(stepping, 1e-8), max(1.6, 10.0 * step), (1.6, SIDE)
    keys = {"radius": RADIUS, "arms": 0.5, "amplitude": 0.2, "speed": 2.0, "density": 2.0, "position": [0.8, 0.16]}
    swims = {"name": "swimmer", "type": "three_sphere_swimmer"} | keys
    return in_fluid(contact, end=end, step=step, upper=box, fluid=STOKES, mechanism=[swims])


def last_fifth(history: History) -> slice:
    """Of the steps."""
    times = history.energy["time"]
    return slice(int(np.searchsorted(times, 0.8 * times[-1])), None)


def disk_weight(density: float) -> float:
    """Submerged, without its sign [force]."""
    return abs(density - 1.0) * float(np.pi) * RADIUS**2 * GRAVITY


def mean_over_time(history: History, force: np.ndarray) -> float:
    """Of a force that is a mean over each step, in the last fifth."""
    late, lasted = last_fifth(history), np.diff(history.energy["time"], prepend=0.0)
    return float(np.sum((force * lasted)[late]) / np.sum(lasted[late]))


def pressed_figures(density: float, epsilon: float, history: History) -> tuple[str, str, str]:
    """Force over weight, its extremes too; the highest speed late and ever; the gap less the exact one."""
    late = last_fifth(history)
    ratio, speed = np.abs(track(history, "cfy")[:, 0]) / disk_weight(density), np.abs(track(history, "vy")[:, 0])
    off = track(history, "gap")[-1, 0] - resting_gap(epsilon, density)
    return _force(ratio, history), f"{speed[late].max():.0e}, ever {speed.max():.2f}", f"{off:.0e}"


def sum_figures(weight: float, axis: str, history: History) -> tuple[str, str, str]:
    """The same of all bodies together, whose forces on each other cancel; the smallest gap."""
    late, count = last_fifth(history), np.sum(np.unique(history.bodies["body"]) != "swimmer")
    ratio = track(history, f"cf{axis}")[:, :count].sum(axis=1) / weight
    speed = np.abs(track(history, f"v{axis}"))
    return (
        _force(ratio, history),
        f"{speed[late].max():.0e}, ever {speed.max():.2f}",
        f"least {track(history, 'gap').min():.4f}",
    )


def _force(ratio: np.ndarray, history: History) -> str:
    late = ratio[last_fifth(history)]
    return f"{mean_over_time(history, ratio):.5f} ({late.min():.3f} … {late.max():.3f})"


Figures = Callable[[History], tuple[str, str, str]]
DISKS = tuple((density, epsilon) for density in (2.0, 0.1, 1e-3) for epsilon in (1e-8, 1e-10))
BALL_WEIGHT = 4.0 / 3.0 * np.pi * RADIUS**3 * GRAVITY
ELLIPSE_WEIGHT = np.pi * 0.12 * 0.06 * GRAVITY


def cases() -> Iterator[tuple[str, Callable[[float, Stepping], Scene], Figures, tuple[float, ...]]]:
    """Name, scene by step and stepping, figures, and steps."""
    for density, epsilon in DISKS:

        def disk(step: float, stepping: Stepping, density: float = density, epsilon: float = epsilon) -> Scene:
            return stokes_pressed(step, density, epsilon, stepping)

        figures = partial(pressed_figures, density, epsilon)
        yield f"disk, density {density:g}, ε {epsilon:g}", disk, figures, (0.01, 0.1)
    for epsilon in (1e-8, 1e-10):
        four = partial(sum_figures, 4.0 * disk_weight(2.0), "y")
        yield f"column, ε {epsilon:g}", partial(column, epsilon=epsilon), four, (0.01, 0.1)
    yield "ellipse", ellipse, partial(sum_figures, ELLIPSE_WEIGHT, "y"), (0.01, 0.1)
    yield "swimmer", swimmer, partial(sum_figures, 3.0 * disk_weight(2.0), "y"), (0.01, 0.1)
    yield "ball, 3D", ball_in_cube, partial(sum_figures, BALL_WEIGHT, "z"), (0.01, 0.1)


def rows(named: str = "", steppings: tuple[Stepping, ...] = ("substeps", "implicit")) -> Iterator[tuple[str, ...]]:
    """A row of figures for each case whose name has ``named`` in it, each stepping, each step."""
    for name, scene, figures, steps in cases():
        for stepping in steppings:
            for step in steps:
                if named in name:
                    yield name, stepping, f"{step:g}", *_row(scene(step, stepping), figures)


def _row(scene: Scene, figures: Figures) -> tuple[str, ...]:
    start = time.process_time()
    try:
        history = rigidfluid.run(scene)
    except StepError as error:
        return "", "", "", "", "", "", f"stops: {error.found}"
    created, lost, _ = created_and_lost(history)
    shares, spent = (f"{100.0 * created:.2f}", f"{100.0 * lost:.2f}"), time.process_time() - start
    return *figures(history), *shares, str(len(history.energy["time"]) - 1), f"{spent:.0f}"


def released(step: float, stepping: Stepping = "substeps") -> Scene:
    """A disk at rest that a contact throws off the floor; the fluid stops it a few radii from there."""
    disk = heavy(0.4, RADIUS + 0.02, density=2.0)
    return in_fluid(
        repulsion(stepping, 1e-8, "normal"), disk, end=0.004, step=step, gravity=0.0, fluid=STOKES, mesh=COARSE
    )


def hinged(step: float, stepping: Stepping = "substeps") -> Scene:
    """Two ellipses at rest, joined by a hinge with a spring that is bent, that contacts throw off the floor."""
    axes = 0.1, 0.06
    pair = [ellipsoid((x, 0.08), REST, axes, density=2.0, name=name) for x, name in ((0.28, "one"), (0.52, "two"))]
    contact = repulsion(stepping, 1e-8, "normal")
    tables = in_fluid(contact, *pair, end=0.01, step=step, gravity=0.0, fluid=STOKES, mesh=COARSE).to_dict()
    knee = {"name": "knee", "type": "hinge", "between": ["one", "two"], "at": [0.4, 0.08]}
    return scene_from_dict(tables | {"joint": [knee | {"stiffness": 0.3, "rest_angle": 1.0}]})
