"""Scenes of bodies with flat sides that lie, lean and turn on each other, without a fluid."""

from __future__ import annotations

from typing import Any

import numpy as np
from dry_scenes import dry_scene

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene

GRAVITY = 10.0
LENGTH, HEIGHT = 0.4, 0.2
"""Sides of a brick [length]."""

SHELL = 0.02
"""Range of the law between bricks [length]."""

COURSES = 3, 2, 3, 2
"""Bricks in each course of a wall in running bond."""

GAP, THICKNESS = 0.28, 0.12
"""Gap between dominoes of height 1, and their thickness [length]."""

ON_THE_FLOOR = 2.0
"""Friction that keeps the lower edges of dominoes in their places [1]."""

DOMINO_SHELL, DOMINO_STEP, LEAN = 0.01, 2e-3, 0.25
"""Range of the law between dominoes [length], step [time] where the gravity is 10, angle of the first one [rad]."""

PITCH_RADIUS, TOOTH_HEIGHT, PLAY = 0.145 / 6, 0.05, 0.006
"""Radius of the pitch circle of a wheel for each tooth, height of teeth, and play between wheels [length]."""

TOOTH = (0.0, -0.5), (0.25, -0.5), (0.38, 0.5), (0.62, 0.5), (0.75, -0.5)
"""Corners of a tooth: part of the turn to the next, and height from the pitch circle over that of the tooth."""


def rectangle(length: float, height: float, position: list[float], angle: float = 0.0) -> dict[str, Any]:
    """A rectangle of density 1."""
    corners = [
        [-length / 2, -height / 2],
        [length / 2, -height / 2],
        [length / 2, height / 2],
        [-length / 2, height / 2],
    ]
    return {"type": "polygon", "points": corners, "density": 1.0, "position": position, "angle": angle}


def brick_wall(end: float, courses: tuple[int, ...] = COURSES, friction: float = 0.6) -> Scene:
    """Bricks in courses, each shifted by half a brick, that lie just in range of each other."""
    along, up = LENGTH + 1.5 * SHELL, HEIGHT + SHELL - 1e-4
    bricks = [
        rectangle(LENGTH, HEIGHT, [1.0 + (brick + 0.5 * (course % 2)) * along, (course + 1) * up - 0.5 * HEIGHT])
        for course, bricks in enumerate(courses)
        for brick in range(bricks)
    ]
    law = {"law": "spring-dashpot", "range": SHELL, "stiffness": 1e3, "restitution": 0.5, "substeps": 20}
    sticking = {"friction": friction, "tangential_stiffness": 800.0}
    return dry_scene(law | sticking, *bricks, end=end, step=2e-3, gravity=[0.0, -GRAVITY], upper=[4.0, 2.0])


def domino_row(
    count: int,
    end: float,
    gravity: float = GRAVITY,
    friction: float = 0.3,
    gap: float = GAP,
    floor: float = ON_THE_FLOOR,
    damping: float = 1.0,
) -> Scene:
    """Dominoes that stand in a row; the first leans on its corner and falls on the next. ``end`` and steps are those of
    a gravity of 10, and shorter by its root where it is more. ``friction`` is that of dominoes on each other, and
    ``damping`` that of springs along surfaces. A wall stands where the next domino would."""
    weight, faster, pitch = THICKNESS * gravity, np.sqrt(GRAVITY / gravity), gap + THICKNESS
    stiffness = 3e3 * weight
    lift = DOMINO_SHELL - 0.5 * weight / stiffness
    row = []
    for number in range(count):
        lean = LEAN if number == 0 else 0.0
        across = np.array([np.cos(lean), -np.sin(lean)]) * -0.5 * THICKNESS
        foot = np.array([0.6 + number * pitch + 0.5 * THICKNESS, lift])
        place = foot + across + 0.5 * np.array([np.sin(lean), np.cos(lean)])
        row.append(rectangle(THICKNESS, 1.0, place.tolist(), -lean))
    law = {"law": "spring-dashpot", "range": DOMINO_SHELL, "stiffness": stiffness, "restitution": 0.3}
    size = {"end": end * faster, "step": DOMINO_STEP * faster, "upper": [0.6 + count * pitch - 0.5 * THICKNESS, 2.0]}
    data = dry_scene({"substeps": 10}, *row, gravity=[0.0, -gravity], **size).to_dict()
    sticking = {"tangential_stiffness": 0.8 * stiffness, "tangential_damping": damping}
    data["interaction"] = [
        law | ({"friction": friction} | sticking if friction > 0.0 else {}) | {"between": "pairs"},
        law | {"friction": floor} | sticking | {"between": "walls"},
    ]
    return scene_from_dict(data)


def gear_pair(teeth: tuple[int, int], speed: float, end: float) -> Scene:
    """Two wheels on fixed axles with their teeth between each other; the first turns at this ``speed`` [rad/time]."""
    one, other = (PITCH_RADIUS * number for number in teeth)
    first = _wheel(teeth[0], [0.5, 1.0], -np.pi / teeth[0]) | {"prescribed": {"angular_velocity": speed}}
    second = _wheel(teeth[1], [0.5 + one + other + PLAY, 1.0], np.pi) | {"free": ["rotation"]}
    law = {"law": "spring-dashpot", "range": 0.004, "stiffness": 1e5, "restitution": 0.3, "substeps": 20}
    return dry_scene(law, first, second, end=end, step=2e-3, upper=[3.0, 2.0])


def _wheel(teeth: int, position: list[float], angle: float) -> dict[str, Any]:
    """A wheel whose first tooth begins at this angle."""
    turn = np.array([[tooth + part, height] for tooth in range(teeth) for part, height in TOOTH])
    angles, radii = 2.0 * np.pi * turn[:, 0] / teeth, PITCH_RADIUS * teeth + TOOTH_HEIGHT * turn[:, 1]
    points = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    return {"type": "polygon", "points": points.tolist(), "density": 1.0, "position": position, "angle": angle}
