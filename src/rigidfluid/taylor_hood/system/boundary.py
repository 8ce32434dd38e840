"""Exchange through the boundary of the domain: pressure loads, mechanical power, and spurious flux of energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.elements.face import Face
from rigidfluid.taylor_hood.elements.surfaces import Surfaces


def pressure_load(surfaces: Surfaces, node_points: FloatArray, time: float) -> FloatArray:
    """-∫ p n·v over the faces with a pressure (n out of the fluid) that this process holds, (nodes, d); on a periodic
    face p is the excess of the pressure there."""
    load = np.zeros_like(node_points)
    with surfaces.ranks.raise_on_all():
        for face in surfaces.faces:
            if not face.condition.prescribes_normal:
                np.add.at(load, face.facet_nodes, face.pressure_load(time, node_points))
    return load


@dataclass(frozen=True, eq=False)
class FaceFlow:
    """Flow at the faces: ``velocity`` u (nodes, d) at ``node_points`` (nodes, d).

    The normal n points into the fluid: what flows in is (u - w)·n, with the ``mesh_velocity`` w (nodes, d) of a face
    that moves, which is asked for where there are such faces.
    """

    surfaces: Surfaces
    inert_density: float
    node_points: FloatArray
    velocity: FloatArray
    mesh_velocity: Callable[[], FloatArray]

    def power(self, pressure_load: FloatArray, reaction: FloatArray) -> float:
        """Mechanical power into the fluid through the boundary: tractions times velocity, and kinetic energy carried
        in.

        With several processes the load and the ``reaction`` (nodes, d) at a node are the sums of what they have there.
        """
        held = self.surfaces.dirichlet_nodes
        power = float(np.sum(reaction[held] * self.velocity[held]) + np.sum(pressure_load * self.velocity))
        for inflow in self._energy_inflows([face for face in self.surfaces.faces if face.condition.passes]):
            power += self.inert_density * inflow
        return float(self.surfaces.ranks.sum(power))

    def spurious_flux(self) -> float:
        """Kinetic energy that convection carries out through curved slip faces, per unit time: between their nodes u·n
        is not zero. It gets less with finer cells there."""
        faces = self.surfaces.faces
        crossed = [face for face in faces if face.condition.slips and face.condition.normal is None]
        carried = self._energy_inflows(crossed)
        return float(self.surfaces.ranks.sum(-self.inert_density * sum(carried) if carried else 0.0))

    def _energy_inflows(self, faces: list[Face]) -> list[float]:
        """∫ ½|u|² (u - w)·n of each face; none in a fluid without inertia."""
        if self.inert_density == 0.0 or not faces:
            return []
        relative = self.velocity - self.mesh_velocity()
        return [face.energy_inflow(self.node_points, self.velocity, relative) for face in faces]
