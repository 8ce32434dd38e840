"""The backend's memory between steps: two time levels of velocity, pressure, mesh and bodies.

``velocity`` (nodes, d), ``pressure`` (vertices,), ``twist`` (n, d+k), ``position`` (n, d) at the accepted time, the
same names with ``_previous`` one step earlier, and ``points_previous`` (vertices + K, d), the mesh's geometry then.
``momentum`` (d,) of the fluid at both times is kept between seams alone; a new mesh does not change it.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import FluidState, Mesh, Pose, Twist
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces


def resting_state(surfaces: Surfaces, mesh: Mesh, pose: Pose, twist: Twist) -> FluidState:
    """Fluid at rest, but for the nodes that move with a body."""
    node_points = surfaces.numbering.node_points(mesh.geometry)
    velocity = np.zeros_like(node_points)
    twists = np.concatenate([twist.velocity, twist.angular_velocity], axis=1)
    surfaces.move_with_bodies(velocity, node_points, pose.position, twists, np.ones(len(twists), dtype=bool))
    pressure = np.zeros(len(mesh.points))
    return {
        "velocity": velocity,
        "velocity_previous": velocity,
        "pressure": pressure,
        "pressure_previous": pressure,
        "points_previous": mesh.geometry,
        "twist": twists,
        "twist_previous": twists,
        "position": pose.position,
        "position_previous": pose.position,
    }


def state_shapes(numbering: Numbering, mesh: Mesh, pose: Pose) -> dict[str, tuple[int, ...]]:
    """Shapes of the arrays of a state on a mesh of this ``numbering``, with the bodies at ``pose``."""
    n, d = pose.position.shape
    nodes, vertices, twist = (numbering.nodes, d), (numbering.vertices,), (n, d + (1 if d == 2 else 3))
    both = {"velocity": nodes, "pressure": vertices, "twist": twist, "position": (n, d)}
    earlier = {f"{name}_previous": shape for name, shape in both.items()}
    return both | earlier | {"points_previous": mesh.geometry.shape}
