"""Stresslets of bodies: the work of a strain on them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose
from rigidfluid.testing.fluid.exact import VISCOSITY, enclosed, problem
from rigidfluid.testing.fluid.flow import Bodies, Flow


class StressletContract(FluidContract):
    """Exact moments; for backends that give ``stresslets``."""

    def test_a_strain_works_on_stresslets(self, dimension: int) -> None:
        """Stokes flow in a unit box with u = E·x on its faces, E symmetric without trace, round free bodies.

        The power of the faces is 2 μ E:E + Σ E:S, discretely too.
        """
        strain = np.array([[0.4, 1.0, 0.3], [1.0, -0.7, -0.2], [0.3, -0.2, 0.3]])[:dimension, :dimension]
        strain = strain - np.trace(strain) / dimension * np.eye(dimension)

        def straining(_time: float, points: FloatArray) -> FloatArray:
            return np.asarray(points @ strain)

        bodies = Bodies.uniform(balls_pose(dimension), prescribed=False)
        flow = self._wanting(self.with_balls(enclosed(dimension, straining, bodies=2, inertia=False), bodies))
        found = flow.advance.stresslet
        assert found is not None
        np.testing.assert_array_equal(found, found.swapaxes(1, 2))
        power = 2.0 * VISCOSITY * np.sum(strain * strain) + np.sum(strain * found)
        self.assert_close(flow.advance.boundary_power, power, scale=10.0 * power)
        assert np.all(np.tensordot(found, strain, axes=2) > 0.0)

    def test_nobody_is_given_what_is_not_wanted(self, dimension: int) -> None:
        """A step that does not ask for them has none."""
        flow = self.with_balls(problem(dimension, bodies=2, inertia=False)).after(None)
        assert flow.advance.stresslet is None

    def _wanting(self, flow: Flow) -> Flow:
        """The steady flow, with stresslets."""
        if not self.backend.stresslets:
            pytest.skip(f"{self.backend.name} gives no stresslets")
        return flow.taken(replace(flow.step_after(None), stresslets=True), None)
