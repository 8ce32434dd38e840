"""Scenes of stiff contacts in a fluid, and what energy their contacts created or lost; cm, g, s throughout."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from dry_scenes import ball
from extreme_scenes import dashpot, driven, ellipsoid, law, wet, wet_hit
from touching import contact as one_contact

from rigidfluid.core.case.load import load_scene, scene_from_dict
from rigidfluid.core.output.history import History
from rigidfluid.core.scene.scene import Scene
from rigidfluid.forces.centre import CentreLaw, CentreOptions

Table = dict[str, Any]
Stepping = Literal["substeps", "implicit"]

RADIUS, RANGE, GRAVITY, SIDE = 0.1, 0.03, 981.0, 0.8
REST: tuple[float, float] = (0.0, 0.0)
MESH = {"size": 0.05, "size_body": 0.03, "quality": 0.1, "refinements": 3, "cells_per_gap": 1}
SCENES = Path(__file__).parents[2] / "scenes"


def in_fluid(
    contact: Table,
    *bodies: Table,
    end: float,
    step: float,
    upper: Sequence[float] = (SIDE, SIDE),
    gravity: float = GRAVITY,
    fluid: Table | None = None,
    mesh: Table | None = None,
    mechanism: Sequence[Table] = (),
) -> Scene:
    """Bodies in a box full of fluid of density 1 and viscosity .01, from the origin to ``upper``."""
    dimension = len(upper)
    downward = [0.0] * (dimension - 1) + [-gravity]
    return scene_from_dict(
        {
            "scene": {"name": "fluid_contacts", "dimension": dimension},
            "fluid": {"density": 1.0, "viscosity": 0.01, "gravity": downward} | (fluid or {}),
            "domain": {"lower": [0.0] * dimension, "upper": list(upper)},
            "body": list(bodies),
            "mechanism": list(mechanism),
            "contact": contact,
            "mesh": MESH | (mesh or {}),
            "time": {"end": end, "step": step},
            "output": {"every": end},
        }
    )


def repulsion(stepping: Stepping, epsilon: float, name: str = "centre", range: float = RANGE) -> Table:
    """A law without losses, and how bodies go through its contacts."""
    return law(name, epsilon, range) | {"stepping": stepping}


def heavy(x: float, y: float, velocity: Sequence[float] = REST, **keys: Any) -> Table:
    """A disk of radius .1 and density 3, unless ``keys`` say otherwise."""
    return ball((x, y), velocity, density=3.0) | keys


def resting_gap(epsilon: float, density: float = 3.0) -> float:
    """The gap of a disk to the floor where the contact bears its submerged weight, by bisection."""
    centre = CentreLaw(CentreOptions(epsilon=epsilon), RANGE)
    weight = abs(density - 1.0) * np.pi * RADIUS**2 * GRAVITY
    low, high = 0.0, RANGE
    while low < (gap := 0.5 * (low + high)) < high:
        force = np.linalg.norm(centre.force(one_contact(gap, RADIUS, np.inf)))
        low, high = (gap, high) if force > weight else (low, gap)
    return gap


# The scenes by which the scheme is judged.


def dropped(step: float, stepping: Stepping = "substeps") -> Scene:
    """A disk falls onto the floor from a gap of its radius, and bounces at least three times."""
    return in_fluid(repulsion(stepping, 1e-9), heavy(0.4, 0.2), end=0.16, step=step)


def stacked(step: float, stepping: Stepping = "substeps") -> Scene:
    """Two disks, one above the other, fall onto the floor and onto each other."""
    return in_fluid(repulsion(stepping, 1e-9), heavy(0.4, 0.14), heavy(0.4, 0.65), end=0.2, step=step)


def cradle(step: float, stepping: Stepping = "substeps", density: float = 3.0) -> Scene:
    """Three disks in a row; the first hits the second, and that the third."""
    row = [heavy(0.2, 0.35, (10.0, 0.0)), heavy(0.49, 0.35), heavy(0.73, 0.35)]
    disks = [disk | {"density": density} for disk in row]
    return in_fluid(repulsion(stepping, 1e-8), *disks, end=0.032, step=step, upper=(1.2, 0.7), gravity=0.0)


def heap(step: float, stepping: Stepping = "substeps") -> Scene:
    """Seven disks in two rows fall into a heap."""
    places = [(0.13, 0.16), (0.31, 0.15), (0.49, 0.16), (0.67, 0.15), (0.22, 0.32), (0.4, 0.33), (0.58, 0.32)]
    disks = [heavy(x, y, radius=0.06) for x, y in places]
    return in_fluid(repulsion(stepping, 1e-9), *disks, end=0.24, step=step)


def light(step: float, stepping: Stepping = "substeps", viscosity: float = 0.02) -> Scene:
    """A disk hundred times lighter than the fluid is thrown at a wall, and comes back towards the other."""
    disk = heavy(0.3, 0.3, (10.0, 0.0), density=0.01)
    fluid = {"viscosity": viscosity}
    box = (0.6, 0.6)
    return in_fluid(repulsion(stepping, 1e-8), disk, end=0.06, step=step, upper=box, gravity=0.0, fluid=fluid)


def bounce(step: float, stepping: Stepping = "substeps") -> Scene:
    """The scene `bounce_in_fluid` that is shipped."""
    return load_scene(SCENES / "bounce_in_fluid.toml", [f"time.step={step}", f"contact.stepping={stepping}"])


def resting(step: float, epsilon: float = 1e-8) -> Scene:
    """A disk at rest on the floor, where the contact bears its weight from the start."""
    disk = heavy(0.4, RADIUS + resting_gap(epsilon))
    return in_fluid(repulsion("substeps", epsilon), disk, end=max(0.1, 20 * step), step=step)


def settling(step: float) -> Scene:
    """A disk is let fall .002 onto a very stiff contact, and comes to rest."""
    disk = heavy(0.4, RADIUS + resting_gap(1e-10) + 0.002)
    return in_fluid(repulsion("substeps", 1e-10), disk, end=0.4, step=step)


STOKES: Table = {"model": "stokes", "viscosity": 0.3}


def stokes_pressed(
    step: float, density: float = 2.0, epsilon: float = 1e-8, stepping: Stepping = "substeps", steps: int = 10
) -> Scene:
    """Without inertia of the fluid, a disk sinks onto the floor, or rises to the ceiling if it is light."""
    disk = heavy(0.4, 0.14 if density > 1.0 else SIDE - 0.14, density=density)
    end = max(0.3, 10.0 * step)
    return in_fluid(repulsion(stepping, epsilon), disk, end=end, step=step, fluid=STOKES)


def ellipse(step: float, stepping: Stepping = "substeps") -> Scene:
    """A tilted ellipse falls onto the floor, tip first."""
    body = ellipsoid((0.4, 0.25), REST, (0.12, 0.06), density=3.0, angle=0.5)
    return in_fluid(repulsion(stepping, 1e-9, "normal"), body, end=0.12, step=step)


def squeezed(step: float) -> Scene:
    """A disk between two walls that both push it from the start: the case `range wider than the free gaps`."""
    between = ball((0.5, 0.15), REST, density=3.0, radius=0.125)
    return wet(law("normal", 1e-8, range=0.06), between, end=0.04, step=step, height=0.32)


def film(step: float, gap: float = 1e-3, refinements: int = 5) -> Scene:
    """A disk is let go from a gap of so many radii: the case `gap of 1e-3 radius`."""
    near = ball((0.5, 0.125 * (1.0 + gap)), REST, density=3.0, radius=0.125)
    fine = {"quality": 0.25, "refinements": refinements}
    return wet(law("normal", 1e-7), near, end=0.02, step=step, mesh=fine)


# Scenes of other kinds.


def three_stacked(step: float, stepping: Stepping = "substeps") -> Scene:
    """Three disks, one above the other, fall onto the floor and onto each other."""
    disks = [heavy(0.4, y) for y in (0.17, 0.43, 0.69)]
    return in_fluid(repulsion(stepping, 1e-9), *disks, end=0.2, step=step, upper=(SIDE, 1.0))


def column(step: float, stepping: Stepping = "substeps") -> Scene:
    """Ten small disks, one above the other, fall a little way onto the floor and onto each other."""
    disks = [heavy(0.2, 0.065 + 0.125 * i, radius=0.04) for i in range(10)]
    contact = repulsion(stepping, 1e-9, range=0.02)
    return in_fluid(contact, *disks, end=0.1, step=step, upper=(0.4, 1.4))


def unlike_hit(step: float, stepping: Stepping = "substeps") -> Scene:
    """A disk of density 10 flies into one of density .3, beside its centre, far from all walls."""
    flies, there = heavy(0.35, 0.5, (10.0, 0.0), density=10.0), heavy(0.62, 0.57, density=0.3)
    return in_fluid(repulsion(stepping, 1e-9), flies, there, end=0.04, step=step, upper=(1.2, 1.0), gravity=0.0)


def unlike_heap(step: float, stepping: Stepping = "substeps") -> Scene:
    """Disks of six radii fall into a heap."""
    places = [(0.15, 0.17), (0.37, 0.14), (0.6, 0.2), (0.22, 0.42), (0.42, 0.36), (0.68, 0.44)]
    radii = (0.1, 0.06, 0.12, 0.08, 0.07, 0.05)
    disks = [heavy(x, y, radius=radius) for (x, y), radius in zip(places, radii, strict=True)]
    return in_fluid(repulsion(stepping, 1e-9), *disks, end=0.2, step=step)


def driven_hit(step: float, stepping: Stepping = "substeps") -> Scene:
    """A disk that swings, whatever pushes it, hits a free one."""
    swings = driven((0.3, 0.4), amplitude=[0.15, 0.0], frequency=10.0)
    return in_fluid(
        repulsion(stepping, 1e-8), swings, heavy(0.6, 0.41), end=0.1, step=step, upper=(1.2, SIDE), gravity=0.0
    )


def rough_fall(step: float, stepping: Stepping = "substeps") -> Scene:
    """A disk with a spring, a dashpot and friction falls onto the floor at a slant."""
    contact = dashpot(1e6, 0.7, RANGE) | {"stepping": stepping}
    return in_fluid(contact, heavy(0.3, 0.2, (8.0, -5.0)), end=0.12, step=step, upper=(1.2, SIDE))


def from_the_mesh(step: float, stepping: Stepping = "substeps") -> Scene:
    """A disk thrown onto the floor, its contacts found from the mesh."""
    contact = repulsion(stepping, 1e-9) | {"detector": "narrow_band"}
    return in_fluid(contact, heavy(0.4, 0.2, (0.0, -8.0)), end=0.06, step=step)


def in_a_corner(step: float, stepping: Stepping = "substeps") -> Scene:
    """An ellipse that spins is thrown into a corner."""
    body = ellipsoid((0.25, 0.25), (-8.0, -6.0), (0.12, 0.06), density=3.0, angular_velocity=[60.0])
    return in_fluid(repulsion(stepping, 1e-9, "normal"), body, end=0.06, step=step, gravity=0.0)


def ball_dropped(step: float, stepping: Stepping = "substeps") -> Scene:
    """A ball falls onto the floor of a cube, with a coarse mesh."""
    body = ball((0.4, 0.4, 0.19), (0.0, 0.0, -5.0), density=3.0)
    coarse = {"size": 0.25, "size_body": 0.1, "refinements": 2}
    contact = repulsion(stepping, 1e-8)
    return in_fluid(contact, body, end=0.06, step=step, upper=(SIDE, SIDE, SIDE), mesh=coarse)


def head_on(step: float, stepping: Stepping = "substeps") -> Scene:
    """Two disks fly at each other."""
    disks = [heavy(0.3, 0.4, (10.0, 0.0)), heavy(0.7, 0.4, (-10.0, 0.0))]
    return in_fluid(repulsion(stepping, 1e-9), *disks, end=0.04, step=step, upper=(1.0, SIDE), gravity=0.0)


def thin_film(step: float) -> Scene:
    """A disk is let go from a gap of 1e-5 radius, about the smallest that the mesher keeps open."""
    return film(step, gap=1e-5, refinements=12)


def spun(step: float, stepping: Stepping = "substeps") -> Scene:
    """A disk that spins at 1e4 rad/s is thrown onto the floor."""
    contact = repulsion(stepping, 1e-10, range=0.05)
    scene = wet_hit(contact, angular_velocity=[1e4]).to_dict()
    return scene_from_dict(scene | {"time": {"end": 0.06, "step": step}})


def put_in(history: History) -> float:
    """Energy stored at the start, and the most that gravity, and faces and prescribed bodies, had worked by any
    time."""
    energy = history.energy
    driven_by = energy["boundary"] + energy["control"]
    start = energy["kinetic"][0] + energy["contact"][0]
    return float(start + max(energy["gravity"].max(), 0.0) + max(driven_by.max(), 0.0))


def created_and_lost(history: History) -> tuple[float, float, float]:
    """Energy that came from nowhere, that vanished, and that the first step created, all over what was put in.

    The first two are the extremes of the balance's residual after the first step, less the first step's own.
    """
    residual, put = history.energy["residual"], put_in(history)
    after = residual[1:] - residual[1]
    return max(-float(after.min()), 0.0) / put, max(float(after.max()), 0.0) / put, -float(residual[1]) / put
