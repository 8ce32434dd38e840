"""Galilean invariance: a flow in a container, and the same flow in a container that moves along."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import NoSlip
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Pose
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose, carried
from rigidfluid.testing.fluid.exact import FACES, problem
from rigidfluid.testing.fluid.flow import Bodies, components, size

VISCOSITY = 0.01
"""So low that cells do not resolve the flow, and pointwise divergence is large."""

SPEED, TRANSLATION = 0.4, np.array([4.0, 2.0, -1.0])
"""Highest velocity of the balls in the container, and its own [length/time]."""

LENGTH, STEPS = 0.05, 4


class GalileanContract(FluidContract):
    """Wrenches on two balls that are moved and turned in a box whose walls rest, or all move alike."""

    def test_a_container_in_translation_changes_no_wrench(self, dimension: int) -> None:
        """Mesh, walls, bodies and fluid all move with one more constant velocity."""
        if not self.backend.initial_flows:
            pytest.skip("this backend starts from rest alone")
        still, moving = (self._wrenches(share * TRANSLATION[:dimension]) for share in (0.0, 1.0))
        assert np.abs(still).max() > 0.01
        self.assert_close(moving, still, scale=100.0 * np.abs(still).max())

    def _wrenches(self, translation: FloatArray) -> FloatArray:
        """Hydrodynamic wrenches of all steps, (s, 2, d+k), in a container with a constant ``translation`` (d,)."""
        dimension = len(translation)

        def uniform(_time: float, points: FloatArray) -> FloatArray:
            return np.tile(translation, (len(points), 1))

        walls = FACES[: 2 * dimension]
        posed = problem(dimension, dict.fromkeys(walls, partial(NoSlip, sliding=partial(uniform, 0.0))), 2)
        posed = replace(posed, material=Newtonian(VISCOSITY), initial=uniform)
        start = balls_pose(dimension)
        twist = np.zeros((2, size(start)))
        twist[:, :dimension] = translation
        flow, found = self.with_balls(posed, Bodies.uniform(start), twist=twist), []
        for _ in range(STEPS):
            time = flow.time + LENGTH
            way = SPEED * np.outer([1.0, -1.0], np.ones(dimension))
            twist[:, :dimension] = way * np.sin(4.0 * time) + translation
            twist[:, dimension:] = 3.0 * time
            shift = 0.25 * way * (1.0 - np.cos(4.0 * time))
            pose = Pose(start.position + shift + translation * time, start.orientation)
            points = carried(flow.reference.points, shift) + translation * time
            flow = flow.after(LENGTH, points=points, pose=pose, twist=twist.copy())
            found.append(components(flow.advance.hydrodynamic_wrench))
        return np.array(found)
