"""Exchange through the boundary of the domain: pressure loads, mechanical power, and spurious flux of energy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.surfaces import Surfaces


def pressure_load(surfaces: Surfaces, node_points: FloatArray, time: float) -> FloatArray:
    """-∫ p n·v over the faces with a pressure (n out of the fluid) that this process holds, (nodes, d); on a periodic
    face p is the excess of the pressure there."""
    load = np.zeros_like(node_points)
    with surfaces.ranks.raise_on_all():
        for face in surfaces.faces:
            if not face.condition.prescribes_normal:
                nodes = face.facet_nodes
                pressure = face.condition.pressure(time, node_points[nodes.ravel()]).reshape(nodes.shape)
                np.add.at(load, nodes, pressure[..., None] * face.area_vectors(node_points))
    return load


def face_power(
    surfaces: Surfaces,
    inert_density: float,
    node_points: FloatArray,
    velocity: FloatArray,
    mesh_velocity: Callable[[], FloatArray],
    pressure_load: FloatArray,
    reaction: FloatArray,
) -> float:
    """Mechanical power into the fluid through the boundary: tractions times velocity, and kinetic energy carried in.

    The normal n points into the fluid: what flows in is (u - w)·n, with the ``mesh_velocity`` w (nodes, d) of a face
    that moves, which is asked for where there are such faces. With several processes the load and the ``reaction``
    (nodes, d) at a node are the sums of what they have there.
    """
    held = surfaces.dirichlet_nodes
    power = float(np.sum(reaction[held] * velocity[held]) + np.sum(pressure_load * velocity))
    passed = [face for face in surfaces.faces if face.condition.passes]
    if inert_density > 0.0 and passed:
        relative = velocity - mesh_velocity()
        for face in passed:
            power += inert_density * face.energy_inflow(node_points, velocity, relative)
    return float(surfaces.ranks.sum(power))


def spurious_flux(
    surfaces: Surfaces,
    inert_density: float,
    node_points: FloatArray,
    velocity: FloatArray,
    mesh_velocity: Callable[[], FloatArray],
) -> float:
    """Kinetic energy that convection carries out through curved slip faces, per unit time: between their nodes u·n is
    not zero. It gets less with finer cells there."""
    crossed = [face for face in surfaces.faces if face.condition.slips and face.condition.normal is None]
    flux = 0.0
    if inert_density > 0.0 and crossed:
        relative = velocity - mesh_velocity()
        flux = -inert_density * sum(face.energy_inflow(node_points, velocity, relative) for face in crossed)
    return float(surfaces.ranks.sum(flux))
