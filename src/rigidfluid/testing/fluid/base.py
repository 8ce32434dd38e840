"""Base of all parts of the contract: makes a backend, holds its tolerances, compares results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import cross
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.types import Mesh, Pose, Step
from rigidfluid.registry import missing_packages
from rigidfluid.testing.fluid.boxes import balls_pose, box_with_balls, carried, nobody, on_ball
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, size

STIR = 0.05
"""The step of a stirred flow [time]."""


class FluidContract:
    """Makes the backend under test, or skips where a package that it needs is missing."""

    backend: ClassVar[type[FluidBackend]]
    """The class under test."""
    options: ClassVar[Mapping[str, Any]] = {}
    """Its options; where it iterates, a tolerance well below ``solver_tolerance``."""
    solver_tolerance: ClassVar[float] = 1e-8
    """Accuracy of what the discrete equations have exactly, relative to the size of what is compared."""

    @pytest.fixture(autouse=True)
    def _packages(self) -> None:
        self.skip_without_packages()

    def skip_without_packages(self) -> None:
        """Skip, with what to install, where a package that the backend needs is missing."""
        hint = missing_packages(self.backend)
        if hint:
            pytest.skip(hint)

    @pytest.fixture(params=[2, 3])
    def dimension(self, request: pytest.FixtureRequest) -> int:
        """Both numbers of space dimensions."""
        return int(request.param)

    def make_backend(self, posed: FluidProblem) -> FluidBackend:
        """The backend under test for this problem."""
        return self.backend(self.backend.Options(**self.options), posed)

    def make_mesh(self, whole: Mesh) -> Mesh:
        """The mesh that the backend gets: override it where each process holds a part."""
        return whole

    def empty(self, posed: FluidProblem, whole: Mesh) -> Flow:
        """Fluid at rest in a box without bodies."""
        return Flow.start(self.make_backend(posed), self.make_mesh(whole), nobody(posed.dimension))

    def with_balls(
        self,
        posed: FluidProblem,
        bodies: Bodies | None = None,
        pose: Pose | None = None,
        twist: FloatArray | None = None,
    ) -> Flow:
        """Fluid at rest in a box around two balls, until these are set in motion with ``twist`` (2, d+k)."""
        mesh = self.make_mesh(box_with_balls(posed.dimension))
        return Flow.start(self.make_backend(posed), mesh, pose or balls_pose(posed.dimension), bodies, twist)

    def assert_close(self, found: Any, expected: Any, scale: float = 1.0) -> None:
        """Equal but for ``solver_tolerance`` · ``scale``."""
        np.testing.assert_allclose(found, expected, rtol=0, atol=self.solver_tolerance * scale)

    def assert_rigid(self, flow: Flow, twist: FloatArray, whole: Mesh) -> None:
        """u = U + ω × r on the balls of the ``whole`` mesh."""
        dimension = flow.pose.position.shape[1]
        for ball in range(2):
            points = on_ball(whole, ball)
            velocity, _ = flow.probe(points)
            arm = points - flow.pose.position[ball]
            expected = twist[ball, :dimension] + cross(np.tile(twist[ball, dimension:], (len(arm), 1)), arm)
            self.assert_close(velocity, expected, scale=10.0)

    def stirred(self, dimension: int, steps: int) -> Flow:
        """One ball of prescribed twist, the other one free, light and pushed, after some steps."""
        bodies = replace(Bodies.uniform(balls_pose(dimension), mass=0.05), prescribed=np.array([True, False]))
        flow = self.with_balls(problem(dimension, bodies=2), bodies)
        for _ in range(steps):
            flow = self.stir(flow)
        return flow

    def stir(self, flow: Flow) -> Flow:
        """A step on."""
        return flow.taken(self.stirring(flow), STIR)

    def stirring(self, flow: Flow) -> Step:
        """The step that ``stir`` takes."""
        start = balls_pose(flow.pose.position.shape[1])
        shift = stirring_shift(flow.time + STIR)[:, : start.position.shape[1]]
        twist = np.full((2, size(start)), 0.5)
        return flow.step_after(
            STIR,
            points=carried(flow.reference.points, shift),
            pose=Pose(start.position + shift, start.orientation),
            twist=twist,
            push=-0.1 * twist,
        )


def stirring_shift(time: float) -> FloatArray:
    """Displacement of the balls of a stirred flow, (2, 3) [length]."""
    return np.asarray(0.03 * np.sin(4.0 * time) * np.array([[1.0, 0.5, -0.5], [0.5, -1.0, 0.5]]))
