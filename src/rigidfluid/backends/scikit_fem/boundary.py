"""What crosses the faces of the domain: pressure loads and mechanical power."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.backends.scikit_fem.discretisation import Discretisation
from rigidfluid.core.types import BoundaryCondition, FloatArray, IntArray, Mesh

if TYPE_CHECKING:
    from rigidfluid.backends.scikit_fem.advance import _Assembled

# ∫ φᵢ over a straight quadratic facet of measure 1: Simpson's weights on an edge, the midpoints' on a triangle.
_WEIGHTS = {2: np.array([1.0, 1.0, 4.0]) / 6.0, 3: np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]) / 3.0}


def pressure_load(discretisation: Discretisation, mesh: Mesh, node_points: FloatArray, time: float) -> FloatArray:
    """-∫ p n·v over the pressure faces (n out of the fluid), (nodes, d)."""
    load = np.zeros_like(node_points)
    for condition, nodes, weight in _faces(discretisation, mesh, node_points, "pressure"):
        assert condition.value is not None
        pressure = condition.value(time, node_points[nodes.ravel()]).reshape(nodes.shape)
        np.add.at(load, nodes, (weight * pressure)[..., None] * condition.normal)
    return load


def face_power(
    discretisation: Discretisation,
    mesh: Mesh,
    assembled: _Assembled,
    velocity: FloatArray,
    reaction: FloatArray,
    time: float,
) -> float:
    """Mechanical power into the fluid through the faces: tractions times velocity, and kinetic energy carried in.

    ``condition.normal`` points into the fluid, so u·n > 0 is inflow.
    """
    nodes = discretisation.constraint.dirichlet_nodes
    power = float(np.sum(reaction[nodes] * velocity[nodes]))
    power += float(np.sum(pressure_load(discretisation, mesh, assembled.node_points, time) * velocity))
    if not discretisation.problem.inertia:
        return power
    relative = velocity - assembled.mesh_velocity
    energy = 0.5 * discretisation.problem.density * np.sum(velocity**2, axis=1)
    for kind in ("pressure", "velocity"):
        for condition, face, weight in _faces(discretisation, mesh, assembled.node_points, kind):
            power += float(np.sum(weight * energy[face] * (relative[face] @ condition.normal)))
    return power


def _faces(
    discretisation: Discretisation, mesh: Mesh, node_points: FloatArray, kind: str
) -> Iterator[tuple[BoundaryCondition, IntArray, FloatArray]]:
    """Each face of a kind with its facets' nodes (F, 3 | 6) and their integration weights (F, 3 | 6)."""
    space = discretisation.space
    for condition in discretisation.problem.conditions:
        facets = mesh.facets[mesh.markers == condition.surface]
        if condition.type == kind and len(facets):
            yield (
                condition,
                space.facet_nodes(facets),
                np.outer(_measure(node_points, facets), _WEIGHTS[space.dimension]),
            )


def _measure(points: FloatArray, facets: IntArray) -> FloatArray:
    edges = points[facets[:, 1:]] - points[facets[:, :1]]
    gram = edges @ np.swapaxes(edges, 1, 2)
    return np.asarray(np.sqrt(np.linalg.det(gram)) / (1.0 if facets.shape[1] == 2 else 2.0))
