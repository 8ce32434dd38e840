"""Extreme scenes in a fluid that the table of extreme cases runs with several steps and ways through contacts."""

from __future__ import annotations

from typing import Any

import fluid_contacts as contacts
from extreme_scenes import ellipsoid, wet, wet_hit
from fluid_contacts import Stepping, Table

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene


def floor_hit(
    step: float,
    stepping: Stepping,
    epsilon: float = 1e-10,
    range: float = 0.05,
    detector: Table | None = None,
    **keys: Any,
) -> Scene:
    """A ball thrown onto the floor, by the law `centre`."""
    return wet_hit(contacts.repulsion(stepping, epsilon, range=range) | (detector or {}), step=step, **keys)


def blade(step: float, stepping: Stepping) -> Scene:
    """A thin ellipse thrown at the floor at a slant."""
    body = ellipsoid((0.5, 0.145), (0, -5), (0.3, 0.015), density=3.0, angle=0.3)
    return wet(contacts.repulsion(stepping, 1e-9, "normal", range=0.05), body, end=0.04, step=step)


def corner_hit(step: float, stepping: Stepping) -> Scene:
    """A square thrown onto the floor, a corner ahead."""
    corners = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]
    start = {"position": [0.5, 0.24], "velocity": [0.0, -5.0], "angle": 0.3}
    body = {"type": "polygon", "points": corners, "density": 3.0} | start
    return wet(contacts.repulsion(stepping, 1e-10, "normal", range=0.05), body, end=0.06, step=step)


def stepped(scene: Scene, stepping: Stepping) -> Scene:
    """The scene with another way through contacts."""
    tables = scene.to_dict()
    return scene_from_dict(tables | {"contact": tables["contact"] | {"stepping": stepping}})


def let_go(step: float, stepping: Stepping, gap: float, refinements: int) -> Scene:
    """A disk at rest so many radii from the floor, which pushes it away."""
    return stepped(contacts.film(step, gap, refinements), stepping)


def squeezed(step: float, stepping: Stepping) -> Scene:
    """A disk between two walls that both push it from the start."""
    return stepped(contacts.squeezed(step), stepping)


def settling(step: float, stepping: Stepping) -> Scene:
    """A disk that is let fall a little way, and comes to rest."""
    return stepped(contacts.settling(step), stepping)


def resting(step: float, stepping: Stepping) -> Scene:
    """A disk whose weight the floor bears from the start."""
    return stepped(contacts.resting(step), stepping)


def stokes_pressed(step: float, stepping: Stepping, density: float = 2.0) -> Scene:
    """Without inertia of the fluid, a disk that sinks or rises, and is pressed onto a wall."""
    return stepped(contacts.stokes_pressed(step, density), stepping)
