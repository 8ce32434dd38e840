"""Steady flow past a cylinder at Re 20: Schäfer & Turek, benchmark 2D-1 (doi:10.1007/978-3-322-89849-4_39)."""

from __future__ import annotations

from functools import cache
from typing import ClassVar

import numpy as np

from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.fluid.conditions import NoSlip, PrescribedPressure, PrescribedVelocity
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.exact import inward_normal
from rigidfluid.testing.fluid.flow import Flow

DRAG, LIFT, PRESSURE_DIFFERENCE = 5.57953523384, 0.010618948146, 0.11752016697
"""Converged values of John & Matthies (2001)."""

CHANNEL, POSE = Box(BoxOptions(lower=(0.0, 0.0), upper=(2.2, 0.41)), 2), Pose(np.array([[0.2, 0.2]]), np.zeros((1, 1)))
ITERATIONS = 12


class CylinderContract(FluidContract):
    """Drag, lift and pressure difference on a mesh that is coarser than that of the validation."""

    cylinder_tolerances: ClassVar[tuple[float, float, float]] = (0.005, 0.05, 0.01)
    """Relative, of drag, lift and pressure difference."""

    def test_flow_past_a_cylinder(self) -> None:
        """Steady steps, each advected by the one before, from Stokes flow to Re 20."""
        conditions = (
            PrescribedVelocity(1, "x0", inward_normal(0, 2), _inflow),
            PrescribedPressure(2, "x1", inward_normal(1, 2)),
            NoSlip(3, "y0", inward_normal(2, 2)),
            NoSlip(4, "y1", inward_normal(3, 2)),
        )
        backend = self.make_backend(FluidProblem(2, 1, 1.0, Newtonian(1e-3), True, conditions))
        flow = Flow.start(backend, self.make_mesh(_mesh()), POSE)
        for _ in range(ITERATIONS):
            flow = flow.after(None)
        coefficients = flow.advance.hydrodynamic_wrench.force[0] * 2.0 / (0.2**2 * 0.1)
        front, back = flow.probe(np.array([[0.15, 0.2], [0.25, 0.2]]))[1]
        found = np.array([*coefficients, front - back])
        published = np.array([DRAG, LIFT, PRESSURE_DIFFERENCE])
        assert np.all(np.abs(found / published - 1.0) < self.cylinder_tolerances), found / published - 1.0


@cache
def _mesh() -> Mesh:
    cylinder = Sphere(SphereOptions(radius=0.05), 2)
    return initial_mesh(FluidDomain([cylinder], POSE, CHANNEL, ()), Sizes(0.05, 0.005))


def _inflow(time: float, points: FloatArray) -> FloatArray:
    s = points[:, 1] / 0.41
    return np.outer(4.0 * s * (1.0 - s), [0.3, 0.0])
