"""Stresslets of bodies: symmetric first moments of the tractions of the fluid on them."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.facet_integrals import area_vectors, into_fluid
from rigidfluid.taylor_hood.elements.surfaces import Surfaces, joined


def stresslets(surfaces: Surfaces, node_force: FloatArray, node_points: FloatArray, position: FloatArray) -> FloatArray:
    r"""Stresslet of each body, S = Σ ½ (a f + f a) over its nodes, (n, d, d) [force·length].

    It is ∮ ½ (a σ·n + σ·n a) over the body's surface, n into the fluid, by consistent tractions: the arms a are a
    function of the elements, so that S is as accurate as forces are.

    Parameters
    ----------
    surfaces : Surfaces
        Nodes of the bodies.
    node_force : (nodes, d) array
        Force f of the fluid on the body that a node is on [force].
    node_points : (nodes, d) array
        Coordinates of the nodes [length].
    position : (n, d) array
        Centres of the bodies [length].

    Notes
    -----
    Batchelor, J. Fluid Mech. 41 (1970) 545, doi:10.1017/S0022112070000745; S has its trace here.
    """
    nodes, body = joined(surfaces.body_nodes)
    arm, force = node_points[nodes] - position[body], node_force[nodes]
    moments = np.zeros((len(position), *2 * (position.shape[1],)))
    np.add.at(moments, body, arm[:, :, None] * force[:, None, :])
    moments = np.asarray(surfaces.ranks.sum(moments))
    return 0.5 * (moments + moments.swapaxes(1, 2))


def body_volumes(surfaces: Surfaces, mesh: Mesh, node_points: FloatArray) -> FloatArray:
    """Volumes of the bodies as the mesh has them, (n,) [length^d]: ∮ x·n/d with the nodes at ``node_points``."""
    volumes = np.zeros(len(surfaces.body_nodes))
    for body in range(len(volumes)):
        facets = into_fluid(mesh.facets[mesh.markers == body], mesh.cells, mesh.points)
        nodes = surfaces.numbering.facet_nodes(facets)
        volumes[body] = np.sum(area_vectors(node_points[nodes]) * node_points[nodes]) / node_points.shape[1]
    return np.asarray(surfaces.ranks.sum(volumes))
