"""Components of mechanisms as bodies of a model, where they are at the start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.nested.placing import initial_pose, initial_twist
from rigidfluid.core.setup.rigid_body import PlacedMechanism, RigidBody


def component_bodies(mechanisms: Sequence[PlacedMechanism], dimension: int) -> tuple[RigidBody, ...]:
    """Components as if each were a body, named after mechanism and component, ``dumbbell.left``."""
    if not mechanisms:
        return ()
    owners = [(placed.name, part) for placed in mechanisms for part in placed.mechanism.components]
    mass = np.array([part.density * part.shape.volume for _, part in owners])
    inertia = mass[:, None, None] * np.array([part.shape.unit_inertia for _, part in owners])
    pose, twist = initial_pose(mechanisms, dimension), initial_twist(mechanisms, dimension)
    by_name = {placed.name: placed.mechanism for placed in mechanisms}
    carried = CarriedBodies(by_name, mass, inertia, np.zeros(len(mass), dtype=bool), pose, twist)
    poses, twists = carried.poses(pose, 0.0), carried.kinematics(pose, 0.0).component_twist(twist)
    return tuple(
        RigidBody(
            name=f"{name}.{part.name}",
            shape=part.shape,
            density=part.density,
            position=tuple(poses.position[i].tolist()),
            angle=float(poses.orientation[i, 0]) if dimension == 2 else None,
            orientation=tuple(poses.orientation[i].tolist()) if dimension == 3 else None,
            velocity=tuple(twists.velocity[i].tolist()),
            angular_velocity=tuple(twists.angular_velocity[i].tolist()),
            part_of=name,
        )
        for i, (name, part) in enumerate(owners)
    )
