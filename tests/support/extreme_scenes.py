"""Scenes at the edge of what contacts can take, made on the spot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from dry_scenes import ball, dry_scene

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene

Table = dict[str, Any]

RADIUS, RANGE = 0.1, 0.02
WET_MESH = {"size": 0.1, "size_body": 0.05, "quality": 0.01, "refinements": 3, "cells_per_gap": 1}


def law(name: str, epsilon: float, range: float = RANGE) -> Table:
    """A law without losses."""
    return {"law": name, "range": range, "epsilon": epsilon}


def dashpot(stiffness: float, restitution: float, range: float = RANGE) -> Table:
    """A spring, a dashpot and friction."""
    keys = {"stiffness": stiffness, "restitution": restitution, "friction": 0.5}
    return {"law": "spring-dashpot", "range": range} | keys


def ellipsoid(position: Sequence[float], velocity: Sequence[float], axes: Sequence[float], **keys: Any) -> Table:
    """An ellipsoid of density 1, unless ``keys`` say otherwise."""
    table = {"type": "ellipsoid", "semi_axes": list(axes), "density": 1.0}
    return table | {"position": list(position), "velocity": list(velocity)} | keys


def driven(position: Sequence[float], **motion: Any) -> Table:
    """A ball of radius 0.1 that moves as ``motion`` says, whatever pushes it."""
    table = {"type": "sphere", "radius": RADIUS, "density": 1.0, "position": list(position)}
    return table | {"prescribed": motion}


def three_disks(contact: Table, step: float = 0.02) -> Scene:
    """Three disks that cross a box of side 1, hit its walls and each other."""
    disks = [ball((0.2, 0.3), (3, 1)), ball((0.5, 0.6), (-2, 2)), ball((0.8, 0.3), (0, -1))]
    return dry_scene(contact, *disks, end=1.0, step=step)


def oblique_hit(ratio: float, dimension: int) -> Scene:
    """A ball of so many times the density of another flies into it, a little beside its centre."""
    rest = [0.5] * (dimension - 1)
    first = ball([0.2, *rest], [2.0] + [0.0] * (dimension - 1), density=ratio)
    second = ball([0.7, 0.55, *rest[1:]], [0.0] * dimension)
    return dry_scene(law("normal", 1e-9), first, second, end=0.15, step=0.01)


def squeezed_by_the_heavy(ratio: float, contact: Table) -> Scene:
    """A ball of so many times the density presses a light one at rest onto the wall."""
    return dry_scene(contact, ball((0.5, 0.5), (1.0, 0.0), density=ratio), ball((0.85, 0.5), (0, 0)), end=1, step=0.01)


def almost_touching(contact: Table, dimension: int) -> Scene:
    """Two balls at rest, 1e-6 of a radius apart, that the stored energy throws apart; it ends before a wall is hit."""
    rest = [0.5] * (dimension - 1)
    balls = [ball([x, *rest], [0.0] * dimension) for x in (0.4 - 0.5e-6 * RADIUS, 0.6 + 0.5e-6 * RADIUS)]
    return dry_scene(contact, *balls, end=0.02, step=0.01)


def spinning(axes: Sequence[float], end: float) -> Scene:
    """An ellipsoid of 1e4 rad/s that drifts towards a corner, at first in the middle."""
    dimension = len(axes)
    spin = [1e4] if dimension == 2 else [1e4, 3e3, 2e3]
    body = ellipsoid([0.76] * dimension, [4.0, 2.0, 1.0][:dimension], axes, angular_velocity=spin)
    return dry_scene(law("normal", 1e-9), body, end=end, step=0.005)


def thrown(axes: Sequence[float], count: int) -> Scene:
    """One or two ellipsoids that tumble between walls, and meet if they are two."""
    dimension = len(axes)
    spin: list[list[float]] = [[3.0], [-3.0]] if dimension == 2 else [[1.0, 2.0, 3.0], [-3.0, 0.0, 1.0]]
    rest = [0.5] * (dimension - 1)
    first = ellipsoid([0.27, *rest], [1.0, 0.2, 0.1][:dimension], axes, angular_velocity=spin[0])
    second = ellipsoid([0.73, *rest], [-1.0, 0.0, 0.0][:dimension], axes, angular_velocity=spin[1])
    return dry_scene(law("normal", 1e-7), *[first, second][:count], end=1.0, step=0.01)


def heap(count: int, contact: Table, end: float, dimension: int = 3) -> Scene:
    """Balls of five sizes on a grid, shaken a little, that fall into a heap in a box of side 1."""
    random = np.random.default_rng(0)
    side = int(np.ceil(count ** (1.0 / dimension)))
    grid = np.stack(np.meshgrid(*[np.arange(side)] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    places = (grid[np.argsort(grid[:, -1], kind="stable")][:count] + 0.5) / side
    places += random.uniform(-0.05, 0.05, places.shape) / side
    still = [0.0] * dimension
    balls = [
        ball(place, still, radius=(0.36 + 0.01 * (number % 5)) / side) for number, place in enumerate(places.tolist())
    ]
    return dry_scene(contact, *balls, end=end, step=0.005, gravity=[*still[1:], -10.0])


def wet(
    contact: Table, *bodies: Table, end: float, step: float, height: float = 1.0, mesh: Table | None = None
) -> Scene:
    """A box of side 1, or lower, full of fluid of density 1, without gravity, with a coarse mesh."""
    dimension = len(bodies[0]["position"])
    upper = [1.0] * (dimension - 1) + [height]
    coarse = {"size": 0.3, "size_body": 0.15, "refinements": 2}
    return scene_from_dict(
        {
            "scene": {"name": "wet", "dimension": dimension},
            "fluid": {"density": 1.0, "viscosity": 0.1},
            "domain": {"lower": [0.0] * dimension, "upper": upper},
            "body": list(bodies),
            "contact": contact,
            "mesh": WET_MESH | (coarse if dimension == 3 else {}) | (mesh or {}),
            "time": {"end": end, "step": step},
            "output": {"every": end},
        }
    )


def wet_hit(contact: Table, density: float = 3.0, dimension: int = 2, step: float = 0.004, **keys: Any) -> Scene:
    """A ball thrown onto the floor of a box of fluid."""
    position, velocity = [0.5] * (dimension - 1) + [0.22], [0.0] * (dimension - 1) + [-5.0]
    body = ball(position, velocity, density=density, radius=0.125) | keys
    return wet(contact, body, end=0.06, step=step)
