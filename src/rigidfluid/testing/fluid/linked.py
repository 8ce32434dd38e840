"""Joints in a step: velocities that links allow, and no force but theirs, the fluid's and what is given."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import NO_LINKS, Links, Step
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, components, size

STEP = 0.02
"""Length of each step [time]."""


class LinkedContract(FluidContract):
    """Two free balls, joined at a point, driven about it with some slip, and one of them held in a direction."""

    link_tolerance: ClassVar[float] = 1e-8
    """Error of the links' velocity equations, relative to the largest component of a twist."""

    def test_links_hold_at_the_end_of_a_step(self, dimension: int) -> None:
        """C u + compliance · force = rate."""
        flow, step, links = self._linked(dimension)
        advance = flow.backend.advance(flow.fluid, flow.mesh, step)
        assert len(advance.link_force) == len(links.rate)
        closing = np.tensordot(links.rows, components(advance.twist), axes=2) + links.compliance * advance.link_force
        scale = float(np.abs(components(advance.twist)).max())
        np.testing.assert_allclose(closing, links.rate, rtol=0, atol=self.link_tolerance * scale)
        assert np.abs(links.compliance * advance.link_force).max() > 1e-3 * scale

    def test_links_act_as_their_forces_in_the_load_would(self, dimension: int) -> None:
        """The same step without links, Cᵀ of the forces found in its load."""
        flow, step, links = self._linked(dimension)
        linked = flow.backend.advance(flow.fluid, flow.mesh, step)
        load = step.load + np.tensordot(linked.link_force, links.rows, axes=1)
        pushed = flow.backend.advance(flow.fluid, flow.mesh, replace(step, load=load, links=NO_LINKS))
        assert len(pushed.link_force) == 0
        for found, expected in (
            (components(linked.twist), components(pushed.twist)),
            (components(linked.hydrodynamic_wrench), components(pushed.hydrodynamic_wrench)),
        ):
            self.assert_close(found, expected, scale=float(np.abs(expected).max()))
        free = flow.backend.advance(flow.fluid, flow.mesh, replace(step, links=NO_LINKS))
        changed = components(linked.twist) - components(free.twist)
        assert np.abs(changed).max() > 0.1 * np.abs(components(free.twist)).max()

    def _linked(self, dimension: int) -> tuple[Flow, Step, Links]:
        """A flow that the balls stirred before, and the step in which links hold them."""
        pose = balls_pose(dimension)
        width, random = size(pose), np.random.default_rng(11)
        started = 0.2 * np.random.default_rng(7).normal(size=(2, width))
        flow = self.with_balls(problem(dimension, bodies=2), Bodies.uniform(pose, mass=0.05), twist=started)
        rows = np.zeros((dimension + 2, 2, width))
        point = pose.position.mean(axis=0)
        for axis in range(dimension):
            for body, sign in enumerate((1.0, -1.0)):
                rows[axis, body] = sign * _velocity_row(point - pose.position[body], axis, width)
        rows[dimension, :, -1] = 1.0, -1.0
        rows[dimension + 1, 0, 1] = 1.0
        compliance: FloatArray = np.zeros(dimension + 2)
        compliance[dimension] = 30.0
        links = Links(rows, np.append(np.zeros(dimension), [0.7, 0.0]), compliance)
        free = np.zeros(2, dtype=bool)
        step = replace(flow.step_after(STEP), load=random.normal(size=(2, width)), prescribed=free, links=links)
        return flow, step, links


def _velocity_row(arm: FloatArray, axis: int, width: int) -> FloatArray:
    """Row (d+k,) that takes a body's twist to the velocity along an axis of its point at ``arm`` (d,)."""
    dimension = len(arm)
    row: FloatArray = np.eye(width)[axis]
    for turn, about in enumerate(np.eye(3)[3 - (width - dimension) :]):
        row[dimension + turn] = np.cross(about, np.append(arm, np.zeros(3 - dimension)))[axis]
    return row
