"""Forces of the fluid on the domain's boundary: known stresses, and the balance of all forces."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rigidfluid.core.model.boundary_forces import BoundaryForces
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose, box
from rigidfluid.testing.fluid.exact import VISCOSITY, LinearFlow, enclosed, inward_normal, problem
from rigidfluid.testing.fluid.flow import Flow, size


class BoundaryForcesContract(FluidContract):
    """Exact forces on faces; for backends that give ``boundary_forces``."""

    def test_a_linear_flow_has_known_forces_on_faces(self, dimension: int) -> None:
        """∫ σ·n of a linear velocity and pressure on each face, edges and corners too."""
        exact = LinearFlow.steady(dimension)
        found = self._wanted(self.empty(enclosed(dimension, exact.velocity, exact.source), box(dimension, 3)))
        strain = exact.gradient + exact.gradient.T
        for face, force in enumerate(found.force):
            normal = inward_normal(face, dimension)
            pressure = -0.5 * normal @ exact.slope
            self.assert_close(force, VISCOSITY * strain @ normal - pressure * normal, scale=10.0)
        self.assert_close(found.area, 1.0)

    def test_fluid_without_inertia_passes_on_all_forces(self, dimension: int) -> None:
        """The forces on faces and bodies add up to zero."""
        flow = self.with_balls(problem(dimension, bodies=2, inertia=False))
        flow = self._taken(flow, twist=np.full((2, size(balls_pose(dimension))), 0.5))
        found = flow.advance.boundary_forces
        assert found is not None
        on_bodies = flow.advance.hydrodynamic_wrench.force.sum(axis=0)
        assert np.linalg.norm(on_bodies) > 1.0
        self.assert_close(found.force.sum(axis=0), -on_bodies, scale=10.0 * float(np.linalg.norm(on_bodies)))

    def test_nobody_is_given_forces_that_are_not_wanted(self, dimension: int) -> None:
        """A step that does not ask for them has none."""
        flow = self.empty(problem(dimension), box(dimension, 2)).after(None)
        assert flow.advance.boundary_forces is None

    def _wanted(self, flow: Flow) -> BoundaryForces:
        """Forces of the steady flow."""
        found = self._taken(flow).advance.boundary_forces
        assert found is not None
        return found

    def _taken(self, flow: Flow, **changes: Any) -> Flow:
        """The steady flow, with these forces."""
        if not self.backend.boundary_forces:
            pytest.skip(f"{self.backend.name} gives no forces on the boundary")
        return flow.taken(replace(flow.step_after(None, **changes), boundary_forces=True), None)
