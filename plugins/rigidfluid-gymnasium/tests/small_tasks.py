"""Tasks that take next to no time: dry disks, joined disks, a channel."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid.api import FloatArray, Scene, Simulation, scene_from_dict
from rigidfluid_gymnasium import (
    AppliedWrench,
    BodyValue,
    BoundaryFactor,
    JointDrive,
    JointValue,
    Moment,
    PrescribedTwist,
    ProbeValue,
    Task,
)

DISK = {"name": "disk", "type": "sphere", "radius": 0.5, "density": 2.0, "position": [5.0, 5.0]}
MASS = 2.0 * np.pi * 0.25
STEP = 0.125


def dry_scene(end: float = 2.0, *bodies: dict[str, Any], **tables: Any) -> Scene:
    return scene_from_dict(
        {
            "scene": {"name": "dry", "dimension": 2},
            "fluid": {"backend": "dry"},
            "domain": {"lower": [0.0, 0.0], "upper": [10.0, 10.0]},
            "body": list(bodies) or [DISK],
            "time": {"end": end, "step": STEP},
            "output": {"every": end},
        }
        | tables
    )


def random_place(random: np.random.Generator) -> Scene:
    return dry_scene(2.0, DISK | {"position": random.uniform(4.0, 6.0, 2).tolist()})


def wind(before: Moment, run: Simulation) -> float:
    """Way to the right."""
    return float(run.bodies["disk"].position[0] - before.bodies["disk"].position[0])


def pushed(case: Any = None, **others: Any) -> Task:
    """A disk without a fluid, pushed in both directions and not turned."""
    given: dict[str, Any] = {
        "case": case or dry_scene(),
        "actions": [AppliedWrench("disk", low=(-2.0, -1.0, 0.0), high=(2.0, 1.0, 0.0))],
        "observations": [
            BodyValue("disk", "position", low=0.0, high=10.0),
            BodyValue("disk", "velocity", low=-9.0, high=9.0),
        ],
        "reward": wind,
        "steps_per_action": 4,
    }
    return Task(**given | others)


def joined(**others: Any) -> Task:
    """Two disks without a fluid, on a driven arm."""
    bodies = [DISK | {"position": [3.0, 5.0]}, DISK | {"name": "other", "position": [6.0, 5.0]}]
    slider = {"name": "arm", "type": "slider", "between": ["other", "disk"], "axis": [1.0, 0.0]}
    return pushed(
        dry_scene(4.0, *bodies, joint=[slider | others]),
        actions=[JointDrive("arm", low=-0.5, high=1.5)],
        observations=[JointValue("arm", low=-2.0, high=2.0), JointValue("arm", "rate", low=-9.0, high=9.0)],
        steps_per_action=8,
    )


def channel(**fluid: Any) -> Scene:
    return scene_from_dict(
        {
            "scene": {"name": "channel", "dimension": 2},
            "fluid": {"model": "stokes", "density": 1.0, "viscosity": 1.0} | fluid,
            "domain": {"lower": [0.0, 0.0], "upper": [3.0, 2.0]},
            "boundary": [
                {"on": "left", "type": "velocity", "velocity": [1.0, 0.0], "profile": "parabolic"},
                {"on": "right", "type": "pressure", "pressure": 0.0},
            ],
            "body": [{**DISK, "radius": 0.25, "position": [1.5, 1.0], "fixed": True}],
            "mesh": {"size": 0.6, "size_body": 0.3},
            "time": {"end": 1.0, "step": STEP},
            "output": {"every": 1.0},
        }
    )


def blown(**others: Any) -> Task:
    """A disk in a stream that is turned up and down, and a disk that is moved in it."""
    actions = [
        BoundaryFactor("left", low=0.0, high=2.0),
        PrescribedTwist("disk", low=(0.0, -0.2, 0.0), high=(0.0, 0.2, 0.0)),
    ]
    observations = [
        ProbeValue((0.0, 1.0), "velocity", low=-3.0, high=3.0),
        ProbeValue((0.0, 1.0), "pressure", low=-500.0, high=500.0),
        BodyValue("disk", "force", low=-200.0, high=200.0),
        BodyValue("disk", "gap", low=0.0, high=2.0),
    ]
    given: dict[str, Any] = {"actions": actions, "observations": observations, "reward": drag}
    return Task(**{"case": channel(), "steps_per_action": 2} | given | others)


def drag(before: Moment, run: Simulation) -> float:
    return float(run.bodies["disk"].force[0])


def sampled(task_actions: int, count: int = 1, seed: int = 0) -> FloatArray:
    """Actions (count, n) from -1 to 1."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, task_actions))
