"""Initial poses and twists of bodies and mechanisms, from the tables of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.scene.scene import BodyTable, MechanismTable
from rigidfluid.errors import SceneError

Tables = Sequence[BodyTable | MechanismTable]


class Placement(Protocol):
    """Position and orientation keys of a table: an angle in 2D, a quaternion in 3D, or neither."""

    @property
    def position(self) -> tuple[float, ...]:
        """Position of the centre of mass [length]."""

    @property
    def angle(self) -> float | None:
        """Angle, counter-clockwise [rad]."""

    @property
    def orientation(self) -> tuple[float, float, float, float] | None:
        """Quaternion, scalar first [1]."""


def check_orientation(table: Placement, dimension: int, at: str) -> None:
    """Raise SceneError for an orientation that the ``dimension`` does not have; ``at`` is the table's place."""
    if dimension == 3 and table.angle is not None:
        raise SceneError(f"{at}.angle", table.angle, "no angle in 3D", "Give `orientation`, a quaternion.")
    if dimension == 2 and table.orientation is not None:
        raise SceneError(
            f"{at}.orientation", list(table.orientation), "no quaternion in 2D", "Give `angle` in radians."
        )
    if table.orientation is not None and not np.linalg.norm(table.orientation) > 0:
        raise SceneError(
            f"{at}.orientation", list(table.orientation), "a quaternion of length above 0", "[1, 0, 0, 0]."
        )


def initial_pose(tables: Sequence[Placement], dimension: int) -> Pose:
    """Positions of the centres of mass and orientations, as many as there are ``tables``."""
    position = np.array([table.position for table in tables]).reshape(-1, dimension)
    if dimension == 2:
        return Pose(position, np.array([[table.angle or 0.0] for table in tables]).reshape(-1, 1))
    quaternions = np.array([table.orientation or (1.0, 0.0, 0.0, 0.0) for table in tables]).reshape(-1, 4)
    return Pose(position, quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True))


def initial_twist(tables: Tables, dimension: int) -> Twist:
    """Velocities and angular velocities, zero where none is given."""
    velocity, spin = np.zeros((len(tables), dimension)), np.zeros((len(tables), 1 if dimension == 2 else 3))
    for i, table in enumerate(tables):
        velocity[i] = table.velocity or 0.0
        spin[i] = table.angular_velocity or 0.0
    return Twist(velocity, spin)
