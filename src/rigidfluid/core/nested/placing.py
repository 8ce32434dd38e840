"""Initial poses and twists of bodies and mechanisms, from tables of a scene or values of a model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.errors import SceneError

_UPRIGHT = (1.0, 0.0, 0.0, 0.0)


class Turned(Protocol):
    """Orientation keys of a table: an angle in 2D, a quaternion in 3D, or neither."""

    @property
    def angle(self) -> float | None:
        """Angle, counter-clockwise [rad]."""

    @property
    def orientation(self) -> Sequence[float] | FloatArray | None:
        """Quaternion, scalar first [1]."""


class Placement(Turned, Protocol):
    """Position and orientation keys of a table."""

    @property
    def position(self) -> Sequence[float] | FloatArray:
        """Position of the centre of mass [length]."""


class Moving(Protocol):
    """Velocity keys of a table."""

    @property
    def velocity(self) -> Sequence[float] | FloatArray | None:
        """Velocity of the centre of mass, None at rest [length/time]."""

    @property
    def angular_velocity(self) -> float | Sequence[float] | FloatArray | None:
        """Angular velocity (k,), in 2D a number too, None at rest [rad/time]."""


def check_orientation(table: Turned, dimension: int, at: str) -> None:
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
    quaternions = np.array([_UPRIGHT if table.orientation is None else table.orientation for table in tables]).reshape(
        -1, 4
    )
    return Pose(position, quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True))


def initial_twist(tables: Sequence[Moving], dimension: int) -> Twist:
    """Velocities and angular velocities, zero where none is given."""
    velocity, spin = np.zeros((len(tables), dimension)), np.zeros((len(tables), 1 if dimension == 2 else 3))
    for i, table in enumerate(tables):
        velocity[i] = 0.0 if table.velocity is None else table.velocity
        spin[i] = 0.0 if table.angular_velocity is None else table.angular_velocity
    return Twist(velocity, spin)
