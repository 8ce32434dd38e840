"""The backend's memory between steps: two time levels of velocity, pressure, mesh and bodies.

``velocity`` (nodes, d), ``pressure`` (vertices,), ``twist`` (n, d+k), ``position`` (n, d) at the accepted time, the
same names with ``_previous`` one step earlier, and ``points_previous`` (vertices, d), where the mesh was then.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.backends.scikit_fem.constraint import rigid_velocity
from rigidfluid.backends.scikit_fem.space import TaylorHood
from rigidfluid.core.types import FluidState, Mesh, Pose, Twist


def at_rest(space: TaylorHood, mesh: Mesh, pose: Pose, twist: Twist) -> FluidState:
    """Fluid at rest, but for the nodes that move with a body."""
    velocity = np.zeros((space.nodes, space.dimension))
    node_points = space.node_points(mesh.points)
    twists = np.concatenate([twist.velocity, twist.angular_velocity], axis=1)
    for body in range(len(twists)):
        nodes = np.unique(space.facet_nodes(mesh.facets[mesh.markers == body]))
        velocity[nodes] = rigid_velocity(twists[body], node_points[nodes] - pose.position[body])
    pressure = np.zeros(space.vertices)
    return {
        "velocity": velocity,
        "velocity_previous": velocity,
        "pressure": pressure,
        "pressure_previous": pressure,
        "points_previous": mesh.points,
        "twist": twists,
        "twist_previous": twists,
        "position": pose.position,
        "position_previous": pose.position,
    }
