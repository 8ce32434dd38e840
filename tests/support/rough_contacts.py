"""Scenes of contacts whose friction has springs along the surfaces, without a fluid and in one."""

from __future__ import annotations

from typing import Any

from dry_scenes import ball, dry_scene
from extreme_scenes import dashpot, law
from flat_bodies import brick_wall, domino_row, gear_pair, rectangle
from fluid_contacts import RANGE, Stepping, heavy, in_fluid

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene

TURNING = {"rolling_friction": 0.1, "twisting_friction": 0.1}
SPRINGS = {"law": "spring-dashpot", "range": 0.02, "stiffness": 1e4, "restitution": 0.8, "friction": 0.3}
LAWS: dict[str, dict[str, Any]] = {
    "spring-dashpot": SPRINGS | {"tangential_stiffness": 6e3},
    **{
        name: {"law": name, "range": 0.02, "epsilon": "auto", "restitution": 0.8, "friction": 0.3}
        for name in ("normal", "centre", "barrier", "contact")
    },
}
"""Laws that repel, with friction."""


def hits(name: str, step: float, stepping: Stepping) -> Scene:
    """A ball that spins about all axes hits another beside its centre; both then hit the floor."""
    thrown = ball((0.3, 0.35, 0.5), (3.0, -2.0, 0.5), angular_velocity=[5.0, 10.0, 20.0])
    there = ball((0.6, 0.25, 0.5), (0.0, 0.0, 0.0), density=2.0)
    contact = LAWS[name] | TURNING | {"stepping": stepping}
    return dry_scene(contact, thrown, there, end=0.2, step=step, gravity=[0.0, -10.0, 0.0])


def bricks(step: float, stepping: Stepping) -> Scene:
    """Three bricks settle on each other."""
    return _stepped(brick_wall(0.08, (2, 1)), step, stepping)


def dominoes(step: float, stepping: Stepping) -> Scene:
    """A domino leans over and falls on the next."""
    return _stepped(domino_row(2, 0.3), step, stepping)


def gears(step: float, stepping: Stepping) -> Scene:
    """A wheel drives another by its teeth, which have friction."""
    rough = {"friction": 0.3, "tangential_stiffness": 8e4}
    return _stepped(gear_pair((8, 10), 3.0, 0.12), step, stepping, **rough)


def wet_disk(step: float, stepping: Stepping) -> Scene:
    """A disk falls at a slant onto the floor of a box full of fluid."""
    sticking = {"tangential_stiffness": 6e5, "rolling_friction": 0.1}
    return _disk_in_fluid(dashpot(1e6, 0.7, RANGE) | sticking, step, stepping)


def wet_rolling(step: float, stepping: Stepping) -> Scene:
    """The same disk by `normal`, which yields as far in the first impact."""
    rough = {"restitution": 0.7, "friction": 0.5, "rolling_friction": 0.1}
    return _disk_in_fluid(law("normal", 1e-9, RANGE) | rough, step, stepping)


def wet_block(step: float, stepping: Stepping) -> Scene:
    """A block falls at a slant onto the floor of a box full of fluid, corner first."""
    contact = dashpot(1e6, 0.7, RANGE) | {"tangential_stiffness": 6e5, "stepping": stepping}
    block = rectangle(0.24, 0.14, [0.4, 0.22], 0.2) | {"density": 3.0, "velocity": [8.0, -5.0]}
    return in_fluid(contact, block, end=0.024, step=step, upper=(1.2, 0.8))


def _disk_in_fluid(contact: dict[str, Any], step: float, stepping: Stepping) -> Scene:
    """A disk of radius .1 that falls at a slant onto the floor."""
    disk = heavy(0.3, 0.2, (8.0, -5.0))
    return in_fluid(contact | {"stepping": stepping}, disk, end=0.024, step=step, upper=(1.2, 0.8))


def _stepped(scene: Scene, step: float, stepping: Stepping, **contact: float) -> Scene:
    """The scene in other steps, with further keys of `[contact]`; implicit ones have no substeps."""
    data = scene.to_dict()
    data["time"]["step"] = step
    data["contact"] |= {"stepping": stepping, **contact}
    if stepping == "implicit":
        data["contact"].pop("substeps")
    return scene_from_dict(data)
