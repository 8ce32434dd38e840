"""Bodies that enter a flow and leave it: where they move as the fluid does, the flow stays as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.rigid import cross
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import RADII, balls_pose, box, box_with_balls, nobody, samples
from rigidfluid.testing.fluid.exact import LinearFlow, enclosed
from rigidfluid.testing.fluid.flow import Bodies, Flow, twist_from_components

_LARGEST = float(max(RADII))


class ExchangeContract(FluidContract):
    """Flow among other bodies than before, for backends with ``exchanges_bodies``."""

    def test_a_linear_flow_and_its_energy_are_kept(self, dimension: int) -> None:
        """On a mesh of other cells, by another backend."""
        self._skip_without_exchange()
        exact = LinearFlow.shear(dimension)
        posed = enclosed(dimension, exact.velocity, exact.source)
        flow = self.empty(posed, box(dimension, 3)).after(None)
        there, kinetic = self._among(flow, posed, nobody(dimension), box(dimension, 4))
        points = samples(dimension)
        self.assert_close(there.probe(points)[0], flow.probe(points)[0], scale=10.0)
        self.assert_close(kinetic, flow.advance.kinetic_energy, scale=10.0)

    def test_bodies_enter_a_flow_that_turns_with_them(self, dimension: int) -> None:
        """u = ω × r with bodies as without."""
        self._skip_without_exchange()
        flow = self.empty(_posed(dimension, 0), box(dimension, 3)).after(None)
        there, _ = self._among(flow, _posed(dimension, 2), balls_pose(dimension), box_with_balls(dimension))
        points = samples(dimension)
        apart = np.linalg.norm(points[:, None] - there.pose.position, axis=2).min(axis=1)
        self._assert_turns(there, points[apart > _LARGEST])

    def test_fluid_moves_as_bodies_did_that_have_left(self, dimension: int) -> None:
        """u = ω × r also in the places of the balls, where there was no fluid."""
        self._skip_without_exchange()
        pose = balls_pose(dimension)
        flow = self.with_balls(_posed(dimension, 2), twist=_twist(pose))
        flow = replace(flow, bodies=Bodies.uniform(pose)).after(None, twist=_twist(pose))
        there, _ = self._among(flow, _posed(dimension, 0), nobody(dimension), box(dimension, 3))
        self._assert_turns(there, np.concatenate([samples(dimension), pose.position]))

    def _skip_without_exchange(self) -> None:
        if not self.backend.exchanges_bodies:
            pytest.skip(f"bodies neither enter nor leave {self.backend.name}")

    def _among(self, flow: Flow, posed: FluidProblem, pose: Pose, whole: Mesh) -> tuple[Flow, float]:
        """The flow among bodies at ``pose`` that move with ω × r, and its kinetic energy."""
        backend, mesh, twist = (
            self.make_backend(posed),
            self.make_mesh(whole),
            twist_from_components(_twist(pose), pose),
        )

        def filling(points: FloatArray) -> tuple[BoolArray, FloatArray]:
            distance = np.linalg.norm(points[:, None] - flow.pose.position, axis=2).min(axis=1, initial=np.inf)
            return distance < _LARGEST, _velocity(0.0, points)

        fluid, kinetic = backend.with_bodies(flow.fluid, flow.mesh, mesh, pose, twist, filling)
        return replace(flow, backend=backend, mesh=mesh, fluid=fluid, pose=pose, twist=twist), kinetic

    def _assert_turns(self, flow: Flow, points: FloatArray) -> None:
        self.assert_close(flow.probe(points)[0], _velocity(0.0, points), scale=10.0)


def _posed(dimension: int, bodies: int) -> FluidProblem:
    return enclosed(dimension, _velocity, bodies=bodies, inertia=False)


def _spin(dimension: int) -> FloatArray:
    return np.array([0.7]) if dimension == 2 else np.array([0.7, -0.4, 0.2])


def _velocity(time: float, points: FloatArray) -> FloatArray:
    """ω × r at ``points`` (N, d)."""
    return cross(np.tile(_spin(points.shape[1]), (len(points), 1)), points)


def _twist(pose: Pose) -> FloatArray:
    """Twists (n, d+k) of bodies that move with ω × r."""
    spin = np.tile(_spin(pose.position.shape[1]), (len(pose.position), 1))
    return np.concatenate([_velocity(0.0, pose.position), spin], axis=1)
