"""No fluid: the bodies alone."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.fluid_backend import Filling, FluidBackend
from rigidfluid.core.model.types import Advance, Fields, FluidState, Mesh, Pose, Response, Step, Twist, Wrench


class Dry(FluidBackend):
    """Newton–Euler without a fluid: mass_matrix · twist = load for free motions, the prescribed twist for others."""

    name: ClassVar[str] = "dry"
    wet: ClassVar[bool] = False
    exchanges_bodies: ClassVar[bool] = True
    periodic_faces: ClassVar[bool] = True

    def initial(self, mesh: Mesh, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
        """An empty state without energy."""
        return {}, 0.0

    def advance(self, fluid: FluidState, mesh: Mesh, step: Step) -> Advance:
        """The twists at the new time; the fluid's wrench and powers are zero."""
        bodies, dimension = step.pose.position.shape
        twist, nothing = _solve(step), np.zeros((bodies, step.load.shape[1]))
        return Advance(
            fluid={},
            twist=Twist(twist[:, :dimension], twist[:, dimension:]),
            hydrodynamic_wrench=Wrench(nothing[:, :dimension], nothing[:, dimension:]),
            kinetic_energy=0.0,
            dissipation=0.0,
            dissipation_midway=0.0,
            boundary_power=0.0,
        )

    def response(self, fluid: FluidState, mesh: Mesh, step: Step, impulses: FloatArray) -> Response:
        """Twists (c, n, d+k) that ``impulses`` give by the bodies' own masses, inviscid and viscous alike."""
        free, twists = ~step.prescribed, np.zeros_like(impulses)
        masses = step.mass_matrix[free] / step.derivative[0]
        twists[:, free] = np.linalg.solve(masses, impulses[:, free, :, None])[..., 0]
        return Response(twists, twists)

    def transfer(self, fluid: FluidState, old: Mesh, new: Mesh) -> tuple[FluidState, float]:
        """An empty state, and no energy lost."""
        return {}, 0.0

    def with_bodies(
        self, fluid: FluidState, old: Mesh, new: Mesh, pose: Pose, twist: Twist, filling: Filling
    ) -> tuple[FluidState, float]:
        """An empty state without energy."""
        return {}, 0.0

    def fields(self, fluid: FluidState, mesh: Mesh) -> Fields:
        """Fields without a single point."""
        dimension = mesh.points.shape[1]
        nodes = (dimension + 1) * (dimension + 2) // 2
        nowhere = np.zeros((0, dimension))
        return Fields(nowhere, np.zeros((0, nodes), dtype=np.int64), nowhere, np.zeros(0))

    def probe(self, fluid: FluidState, mesh: Mesh, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Zero velocity (N, d) and zero pressure (N,) at ``points`` (N, d)."""
        return np.zeros_like(points), np.zeros(len(points))

    def unknowns(self, mesh: Mesh, prescribed: BoolArray) -> int:
        """Zero unknowns: each body's equation stands alone."""
        return 0

    def forget(self) -> None:
        """Do nothing: nothing is cached."""


def _solve(step: Step) -> FloatArray:
    free = ~step.prescribed
    twist = step.prescribed_twist.copy()
    twist[free] = np.linalg.solve(step.mass_matrix[free], step.load[free, :, None])[..., 0]
    return twist
