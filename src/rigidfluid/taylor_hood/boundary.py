"""What crosses the boundary of the domain: pressure loads and mechanical power."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import FloatArray
from rigidfluid.taylor_hood.surfaces import Surfaces, facet_weights


def pressure_load(surfaces: Surfaces, node_points: FloatArray, time: float) -> FloatArray:
    """-∫ p n·v over the pressure faces (n out of the fluid) that this process holds, (nodes, d)."""
    load = np.zeros_like(node_points)
    for face in surfaces.faces:
        if face.condition.type == "pressure" and face.condition.value is not None:
            nodes = face.facet_nodes
            pressure = face.condition.value(time, node_points[nodes.ravel()]).reshape(nodes.shape)
            weight = facet_weights(node_points, face.facets)
            np.add.at(load, nodes, (weight * pressure)[..., None] * face.normal)
    return load


def face_power(
    surfaces: Surfaces,
    inert_density: float,
    node_points: FloatArray,
    velocity: FloatArray,
    mesh_velocity: FloatArray,
    pressure_load: FloatArray,
    reaction: FloatArray,
) -> float:
    """Mechanical power into the fluid through the boundary: tractions times velocity, and kinetic energy carried in.

    ``normal`` n points into the fluid: (u - w)·n flows in, with the ``mesh_velocity`` w (nodes, d) of moving faces.
    With several processes the load and the ``reaction`` (nodes, d) at a node are the sums of what they have there.
    """
    held = surfaces.dirichlet_nodes
    power = float(np.sum(reaction[held] * velocity[held]) + np.sum(pressure_load * velocity))
    energy = 0.5 * inert_density * np.sum(velocity**2, axis=1)
    for face in surfaces.faces:
        if inert_density > 0.0 and face.condition.type in ("pressure", "velocity"):
            weight, nodes = facet_weights(node_points, face.facets), face.facet_nodes
            inflow = (velocity[nodes] - mesh_velocity[nodes]) @ face.normal
            power += float(np.sum(weight * energy[nodes] * inflow))
    return float(surfaces.ranks.sum(power))
