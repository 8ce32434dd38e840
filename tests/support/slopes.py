"""Blocks and balls on planes that friction holds, without a fluid: gravity is inclined, not the plane."""

from __future__ import annotations

from typing import Any

import numpy as np
from dry_scenes import ball, dry_scene

from rigidfluid.core.scene.scene import Scene

FRICTION, GRAVITY = 0.5, 10.0
RANGE = 0.02
STICKING = {
    **{"law": "spring-dashpot", "range": RANGE, "stiffness": 40.0, "restitution": 0.1},
    **{"friction": FRICTION, "tangential_stiffness": 30.0},
}
SIDE, RADIUS = 0.2, 0.1
SQUARE = (0.5 * SIDE * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])).tolist()


def block_on_slope(steepness: float, end: float, step: float = 2e-3, **keys: Any) -> Scene:
    """A square that lies on a plane whose slope is the coefficient of friction times ``steepness``; in the beginning
    it presses with its weight, and nothing holds it yet."""
    angle = np.arctan(steepness * FRICTION)
    gravity = GRAVITY * np.array([np.sin(angle), -np.cos(angle)])
    sag = SIDE**2 * GRAVITY * np.cos(angle) / (2.0 * STICKING["stiffness"])
    place = [0.5, 0.5 * SIDE + RANGE - sag]
    block = {"type": "polygon", "points": SQUARE, "density": 1.0, "position": place}
    return dry_scene(STICKING | keys, block, end=end, step=step, gravity=gravity.tolist(), upper=[3.0, 1.0])


def sliding_ball(end: float, step: float = 2e-3, speed: float = 1.0, **keys: Any) -> Scene:
    """A ball that starts to slide, without spin, on a level plane on which it rests."""
    contact, weight = STICKING | keys, np.pi * 4.0 / 3.0 * RADIUS**3 * GRAVITY
    height = RADIUS + RANGE - weight / contact["stiffness"]
    body = ball([0.2, 0.5, height], [speed, 0.0, 0.0])
    return dry_scene(contact, body, end=end, step=step, gravity=[0.0, 0.0, -GRAVITY], upper=[3.0, 1.0, 1.0])
