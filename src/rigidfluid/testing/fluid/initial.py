"""Flows that a backend can start with: steady ones, and given ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose, box, box_with_balls, samples
from rigidfluid.testing.fluid.exact import LinearFlow, enclosed, problem


class InitialFlowContract(FluidContract):
    """For backends with ``initial_flows``."""

    def test_starts_with_a_steady_flow(self, dimension: int) -> None:
        """One with convection and pressure, which the discrete equations have exactly."""
        self._skip_without_initial_flows()
        exact = LinearFlow.steady(dimension)

        def source(time: float, points: FloatArray) -> FloatArray:
            return exact.source(1.0, points)

        posed = replace(enclosed(dimension, exact.velocity, source), initial="steady")
        velocity, pressure = self.empty(posed, box(dimension, 3)).probe(samples(dimension))
        self.assert_close(velocity, exact.velocity(0.0, samples(dimension)), scale=10.0)
        self.assert_close(pressure, exact.pressure(0.0, samples(dimension)), scale=100.0)

    def test_starts_with_a_given_flow(self, dimension: int) -> None:
        """Without divergence, and with the boundary's own values: it is as it was given."""
        self._skip_without_initial_flows()
        exact = LinearFlow.steady(dimension)
        posed = replace(enclosed(dimension, exact.velocity), initial=exact.velocity)
        velocity, _ = self.empty(posed, box(dimension, 3)).probe(samples(dimension))
        self.assert_close(velocity, exact.velocity(0.0, samples(dimension)))

    @pytest.mark.parametrize("given", ["steady", "formula"])
    def test_starts_with_bodies_that_move(self, dimension: int, given: str) -> None:
        """Steady or given, the fluid moves with them on them."""
        self._skip_without_initial_flows()
        twist = np.random.default_rng(5).normal(size=(2, 3 if dimension == 2 else 6))
        posed = problem(dimension, bodies=2, inertia=False)
        posed = replace(posed, initial="steady" if given == "steady" else LinearFlow.steady(dimension).velocity)
        flow = self.with_balls(posed, pose=balls_pose(dimension), twist=twist)
        self.assert_rigid(flow, twist, box_with_balls(dimension))

    def _skip_without_initial_flows(self) -> None:
        if not self.backend.initial_flows:
            pytest.skip("it starts at rest alone")
