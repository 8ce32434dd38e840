"""What crosses the faces of the domain: pressure loads and mechanical power."""

from __future__ import annotations

import numpy as np

from rigidfluid.backends.scikit_fem.discretisation import Discretisation
from rigidfluid.backends.scikit_fem.facets import facet_weights
from rigidfluid.core.types import FloatArray


def pressure_load(discretisation: Discretisation, node_points: FloatArray, time: float) -> FloatArray:
    """-∫ p n·v over the pressure faces (n out of the fluid), (nodes, d)."""
    load = np.zeros_like(node_points)
    for face in discretisation.constraint.faces:
        if face.condition.type == "pressure" and face.condition.value is not None:
            pressure = face.condition.value(time, node_points[face.nodes.ravel()]).reshape(face.nodes.shape)
            weight = facet_weights(node_points, face.facets)
            np.add.at(load, face.nodes, (weight * pressure)[..., None] * face.condition.normal)
    return load


def face_power(
    discretisation: Discretisation,
    node_points: FloatArray,
    velocity: FloatArray,
    pressure_load: FloatArray,
    reaction: FloatArray,
) -> float:
    """Mechanical power into the fluid through the faces: tractions times velocity, and kinetic energy carried in.

    ``normal`` points into the fluid, so u·n > 0 is inflow; the mesh does not move across a face.
    """
    held = discretisation.constraint.dirichlet_nodes
    power = float(np.sum(reaction[held] * velocity[held]) + np.sum(pressure_load * velocity))
    if not discretisation.problem.inertia:
        return power
    energy = 0.5 * discretisation.problem.density * np.sum(velocity**2, axis=1)
    for face in discretisation.constraint.faces:
        if face.condition.type in ("pressure", "velocity"):
            weight = facet_weights(node_points, face.facets)
            power += float(np.sum(weight * energy[face.nodes] * (velocity[face.nodes] @ face.condition.normal)))
    return power
