"""Bodies that one motion carries: rigid on all of them but for what is given, pulled by all their wrenches together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.kinematics import CarriedKinematics
from rigidfluid.core.model.types import Step
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose, box_with_balls
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, components, size

STEP = 0.02
"""Length of each step [time]."""


class CarriedContract(FluidContract):
    """Two balls on one motion that is free."""

    def test_balls_of_one_motion_move_as_it_does_but_for_what_is_given(self, dimension: int) -> None:
        """u = U + ω × r on both, r from the common centre, and one of them moves and turns relatively."""
        flow, step = self._pushed(dimension, given=0.3)
        advance = flow.backend.advance(flow.fluid, flow.mesh, step)
        assert advance.twist.velocity.shape == (1, dimension)
        twist = components(step.kinematics.component_twist(advance.twist))
        moved = replace(flow, fluid=advance.fluid, pose=step.pose)
        self.assert_rigid(moved, twist, box_with_balls(dimension))
        assert np.abs(twist[1] - twist[0]).max() > 0.1

    def test_newton_euler_holds_for_the_whole(self, dimension: int) -> None:
        """mass_matrix · twist = load + Gᵀ of the fluid's wrenches on the balls."""
        flow, step = self._pushed(dimension, given=0.3)
        advance = flow.backend.advance(flow.fluid, flow.mesh, step)
        wrench = advance.hydrodynamic_wrench
        assert wrench.force.shape == (2, dimension)
        pulled = components(step.kinematics.motion_wrench(wrench))
        moved = np.einsum("nij,nj->ni", step.mass_matrix, components(advance.twist))
        scale = float(np.abs(components(wrench)).max())
        self.assert_close(moved - step.load, pulled, scale=scale)
        assert np.abs(pulled).min() > 1e-4 * scale

    def test_responses_are_those_of_the_whole(self, dimension: int) -> None:
        """Two steps, one with an impulse on the motion in its load, differ by the impulse response."""
        flow, step = self._pushed(dimension, given=0.3)
        impulse = 0.01 * np.random.default_rng(5).normal(size=step.load.shape)
        pushed = replace(step, load=step.load + step.derivative[0] * impulse, impulse=impulse)
        told = flow.backend.response(flow.fluid, flow.mesh, step, impulse[None])
        twists = [components(flow.backend.advance(flow.fluid, flow.mesh, one).twist) for one in (step, pushed)]
        np.testing.assert_allclose(
            told.viscous[0], twists[1] - twists[0], rtol=0, atol=1e-4 * np.abs(told.viscous).max()
        )
        assert told.inviscid.shape == (1, *step.load.shape)
        assert float(np.sum(told.inviscid * impulse)) > float(np.sum(told.viscous * impulse)) > 0.0

    def _pushed(self, dimension: int, given: float) -> tuple[Flow, Step]:
        """A flow that the balls stirred before, and the step in which they are pushed as a whole."""
        pose, carrier = balls_pose(dimension), np.zeros(2, dtype=np.int64)
        posed = replace(problem(dimension, bodies=2), carrier=(0, 0))
        started = 0.2 * np.random.default_rng(7).normal(size=(2, size(pose)))
        flow = self.with_balls(posed, Bodies.uniform(pose, mass=0.05), twist=started)
        centre = pose.position.mean(axis=0, keepdims=True)
        relative = np.zeros((2, size(pose)))
        relative[1] = given
        kinematics = CarriedKinematics(carrier, centre, pose.position - centre, relative)
        width = size(pose)
        random: FloatArray = np.random.default_rng(8).normal(size=(width, width))
        masses = 0.1 * np.eye(width) + 0.01 * random @ random.T
        motion = np.zeros((1, width))
        step = replace(
            flow.step_after(STEP),
            mass_matrix=masses[None] / STEP,
            load=5.0 * random[:1],
            prescribed=np.zeros(1, dtype=bool),
            prescribed_twist=motion,
            impulse=motion,
            turning=motion,
            kinematics=kinematics,
        )
        return flow, step
