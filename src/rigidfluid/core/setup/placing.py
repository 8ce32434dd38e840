"""Where the tables of a scene put bodies and mechanisms, and how they start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.scene.scene import BodyTable, MechanismTable

Tables = Sequence[BodyTable | MechanismTable]


def initial_pose(tables: Tables, dimension: int) -> Pose:
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
