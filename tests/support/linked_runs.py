"""Dry scenes of linked bodies, and what is read from their runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import lab_inertia, moment
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene

Table = dict[str, Any]


def linked_scene(
    bodies: Sequence[Table],
    joints: Sequence[Table] = (),
    contact: Table | None = None,
    gravity: Sequence[float] | None = None,
    end: float = 1.0,
    step: float = 1e-2,
    upper: float = 4.0,
    **tables: Any,
) -> Scene:
    """In a box from the origin on."""
    dimension = len(bodies[0]["position"])
    fluid = {"backend": "dry"} if gravity is None else {"backend": "dry", "gravity": list(gravity)}
    return scene_from_dict(
        {
            "scene": {"name": "linked", "dimension": dimension},
            "fluid": fluid,
            "domain": {"lower": [0.0] * dimension, "upper": [upper] * dimension},
            "body": list(bodies),
            "joint": list(joints),
            "contact": contact or {},
            "time": {"end": end, "step": step},
            "output": {"every": end},
        }
        | tables
    )


def body(*position: float, **keys: Any) -> Table:
    """A ball of radius 0.1 and density 1, unless ``keys`` say otherwise."""
    return {"type": "sphere", "radius": 0.1, "density": 1.0, "position": list(position)} | keys


def bar(*position: float, **keys: Any) -> Table:
    """Of length 0.5 along x."""
    axes = [0.25, 0.05, 0.08][: len(position)]
    return {"type": "ellipsoid", "semi_axes": axes, "density": 1.0, "position": list(position)} | keys


def hinge(*between: str, at: Sequence[float], **keys: Any) -> Table:
    """In 3D about an axis that is none of the box's, unless ``keys`` say otherwise."""
    axis = {"axis": [0.48, 0.6, 0.64]} if len(at) == 3 else {}
    return {"type": "hinge", "between": list(between), "at": list(at)} | axis | keys


def momenta(it: Simulation) -> FloatArray:
    """Of all bodies, momentum and angular momentum about the origin (d+k,)."""
    system, pose, twist = it.system, it.state.pose, it.state.twist
    linear = system.mass[:, None] * twist.velocity
    spin = np.einsum("nij,nj->ni", lab_inertia(system.inertia, pose.orientation), twist.angular_velocity)
    return np.concatenate([linear.sum(axis=0), (spin + moment(pose.position, linear)).sum(axis=0)])


def misfit(it: Simulation) -> float:
    """The greatest of its joints [length | rad]."""
    assert it.system.joints is not None
    return float(np.abs(it.system.joints.misfit(it.state.motions.pose, it.time)).max())
