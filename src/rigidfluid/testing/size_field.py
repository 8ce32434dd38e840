"""Contract tests of a size field."""

from __future__ import annotations

from copy import deepcopy

import numpy as np
import pytest

from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mesh.flow import AtRest, Flow
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.domains.box import Box, BoxOptions

_POINTS = 40


class Whirl(Flow):
    """A flow that turns about the middle of a box, the slower the farther from it: u = r⊥ exp(-|r|²)."""

    @property
    def speed(self) -> float:
        """exp(-½)/√2, at |r|² = ½ [length/time]."""
        return float(np.exp(-0.5) / np.sqrt(2.0))

    def velocity(self, points: FloatArray) -> FloatArray:
        """(-y, x, 0) exp(-r²) of x, y from the middle, (m, d) [length/time]."""
        return _sideways(points) * _decay(points)[:, None]

    def pressure(self, points: FloatArray) -> FloatArray:
        """-¼ exp(-2 r²), (m,) [force/length^(d-1)]."""
        return np.asarray(-0.25 * _decay(points) ** 2)

    def gradient(self, points: FloatArray) -> FloatArray:
        """∂u_i/∂x_j, (m, d, d) [1/time]."""
        turn = _sideways(np.eye(points.shape[1])).T
        plane = np.where(np.arange(points.shape[1]) < 2, points, 0.0)
        bent = turn - 2.0 * _sideways(points)[:, :, None] * plane[:, None, :]
        return np.asarray(bent * _decay(points)[:, None, None])


class SizeFieldContract:
    """Edge lengths of one field around a ball in a box, in a fluid at rest and in one that turns.

    Override the fixture ``field``, and ``around`` for a field that wants other bodies or another domain; parametrise
    them to hold several to the same standard.
    """

    @pytest.fixture
    def field(self) -> SizeField:
        """The size field under test."""
        raise NotImplementedError("override the fixture `field`")

    @pytest.fixture
    def around(self, field: SizeField) -> FluidDomain:
        """A ball of radius .2 in a box of width 2 about the origin."""
        d = field.dimension
        box = Box(BoxOptions(lower=(-1.0,) * d, upper=(1.0,) * d), d)
        pose = Pose(np.full((1, d), 0.3), np.zeros((1, 1)) if d == 2 else np.eye(1, 4))
        walls = [Wall(1 + number, piece.name, piece.shape) for number, piece in enumerate(box.pieces)]
        return FluidDomain([Sphere(SphereOptions(radius=0.2), d)], pose, box, walls)

    @pytest.fixture(params=["at rest", "turning"])
    def flow(self, request: pytest.FixtureRequest, around: FluidDomain) -> Flow:
        """A fluid and bodies at rest, or in motion."""
        at_rest = AtRest(len(around.bodies), around.domain.dimension)
        if request.param == "at rest":
            return at_rest
        velocity, spin = at_rest.twist.velocity, at_rest.twist.angular_velocity
        return Whirl(Twist(velocity + 0.4, spin + 1.0))

    @pytest.fixture
    def points(self, around: FluidDomain) -> FloatArray:
        """Points of the domain, and of the bodies' surfaces, (m, d) [length]."""
        lower, upper = around.domain.extent
        spread = np.random.default_rng(0).uniform(lower, upper, (_POINTS, len(lower)))
        return np.concatenate([spread, *(around.closest_points(i, spread[:5]) for i in range(len(around.bodies)))])

    def test_lengths_are_positive_and_finite(
        self, field: SizeField, around: FluidDomain, flow: Flow, points: FloatArray
    ) -> None:
        """One length for each point, none of them zero, infinite or no number; else the interface raises."""
        field.edge_length(points, around, flow)

    def test_no_points_have_no_lengths(
        self, field: SizeField, around: FluidDomain, flow: Flow, points: FloatArray
    ) -> None:
        """An empty array is answered by one; else the interface raises."""
        field.edge_length(points[:0], around, flow)

    def test_its_arguments_stay_as_they_are(
        self, field: SizeField, around: FluidDomain, flow: Flow, points: FloatArray
    ) -> None:
        """Points, poses and twists are the mesher's, and not changed."""
        given = points, around.pose.position, around.pose.orientation, flow.twist.velocity, flow.twist.angular_velocity
        before = deepcopy(given)
        field.edge_length(points, around, flow)
        for array, kept in zip(given, before, strict=True):
            np.testing.assert_array_equal(array, kept)

    def test_each_length_is_of_its_point_alone(
        self, field: SizeField, around: FluidDomain, flow: Flow, points: FloatArray
    ) -> None:
        """In another order, or without the others, points have the same lengths, but for rounding."""
        lengths = np.array(field.edge_length(points, around, flow))
        order = np.random.default_rng(1).permutation(len(points))
        np.testing.assert_allclose(field.edge_length(points[order], around, flow), lengths[order], rtol=1e-12)
        np.testing.assert_allclose(field.edge_length(points[:3], around, flow), lengths[:3], rtol=1e-12)

    def test_it_remembers_nothing(self, field: SizeField, around: FluidDomain, flow: Flow, points: FloatArray) -> None:
        """Asked again after another flow, it answers the same to the last bit."""
        lengths = np.array(field.edge_length(points, around, flow))
        field.edge_length(points, around, Whirl(flow.twist))
        np.testing.assert_array_equal(field.edge_length(points, around, flow), lengths)


def _sideways(points: FloatArray) -> FloatArray:
    """(-y, x, 0) of points (x, y, z), (m, d)."""
    return np.stack([-points[:, 1], points[:, 0], *np.zeros_like(points.T[2:])], axis=1)


def _decay(points: FloatArray) -> FloatArray:
    """exp(-x² - y²), (m,)."""
    return np.asarray(np.exp(-np.sum(points[:, :2] ** 2, axis=1)))
