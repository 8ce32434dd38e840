"""Contract tests of a joint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.joint import Joint, PlacedJoint
from rigidfluid.core.joints.joint_parts import joint_markers
from rigidfluid.core.joints.linkage import JointLinkage
from rigidfluid.core.joints.markers import Markers, PlacedPair, add_relative_rows
from rigidfluid.core.mechanics.rigid import moment, rotate
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.mechanics.wrenches import flat, nothing
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.output.records import columns
from rigidfluid.errors import StepRejected

_NUDGE = 1e-5


class JointContract:
    """Rows, springs and coordinate of one joint, between two bodies and between one and the ground.

    Override the fixture ``joint``; parametrise it to hold several to the same standard. Poses at which the joint fits
    are found by its own rows, so what it holds is judged where its coordinate is not zero, too.
    """

    times: ClassVar[tuple[float, ...]] = (0.07, 0.13, 0.31)
    """Times at which a joint is judged, none of them a corner of its drive [time]."""
    tolerance: ClassVar[float] = 1e-10
    """Error of exact identities, for bodies of size and distance 1."""
    slope_tolerance: ClassVar[float] = 1e-6
    """Error of rates against central differences, over the largest rate [1]."""

    @pytest.fixture
    def joint(self) -> Joint:
        """The joint under test."""
        raise NotImplementedError("override the fixture `joint`")

    def test_axes_are_right_handed_and_of_length_one(self, joint: Joint) -> None:
        """The markers' axes are a rotation."""
        axes, d = joint.axes, joint.dimension
        assert axes.shape == (d, d)
        np.testing.assert_allclose(axes.T @ axes, np.eye(d), rtol=0, atol=self.tolerance)
        assert np.linalg.det(axes) > 0.0

    def test_rows_have_their_shapes(self, joint: Joint) -> None:
        """Each constraint has a row of all that is asked for, and a misfit for each rigid row; the first is of the
        markers given."""
        for second in (1, None):
            case = _Case(joint, second)
            constraints = joint.constraints("joint 'it'", case.markers)
            assert constraints
            assert constraints[0].markers is case.markers
            for one in constraints:
                along, about = one.directions(case.placed(case.start))
                rows, rigid = len(one.compliance), int(np.sum(one.compliance == 0.0))
                assert rigid in (0, rows), "rigid rows and dampers are constraints of their own"
                assert np.all(one.compliance >= 0.0)
                assert along.shape == (rows, joint.dimension)
                assert about.shape == (rows, case.spins)
                assert one.rate(0.1).shape == (rows,)
                assert one.misfit(case.placed(case.start), 0.0).shape == (rigid,)
                assert one.name == "joint 'it'"

    def test_it_fits_where_bodies_start(self, joint: Joint) -> None:
        """The misfit is zero at the start."""
        for second in (1, None):
            case = _Case(joint, second)
            np.testing.assert_allclose(case.links.misfit(case.start, 0.0), 0.0, rtol=0, atol=self.tolerance)

    def test_rows_are_the_rates_of_the_misfit(self, joint: Joint) -> None:
        """d misfit/dt = C u - rate where it fits, whatever the twist: directions are the derivative of the misfit, and
        rates of drives are those of their values."""
        for second in (1, None):
            case = _Case(joint, second)
            for time, pose in case.fitting(self.times):
                twist, links = case.twist(), case.links.links(pose, time)
                expected = (np.einsum("cni,ni->c", links.rows, twist) - links.rate)[links.compliance == 0.0]
                found = _slope(case.links.misfit, pose, twist, time)
                self._same_slopes(found, expected)

    def test_forces_are_equal_and_opposite(self, joint: Joint) -> None:
        """Forces of the rows, and springs, give two bodies neither momentum nor angular momentum."""
        case = _Case(joint, 1)
        for time, pose in case.fitting(self.times):
            rows = case.links.links(pose, time).rows
            pull = flat(case.links.spring_wrench(pose, time))[None]
            for wrench in np.concatenate([rows, pull]):
                d = joint.dimension
                whole = wrench[:, d:] + moment(pose.position, wrench[:, :d])
                total = np.concatenate([wrench[:, :d].sum(axis=0), whole.sum(axis=0)])
                np.testing.assert_allclose(total, 0.0, rtol=0, atol=self.tolerance * (1.0 + np.abs(wrench).max()))

    def test_springs_pull_down_the_slope_of_their_energy(self, joint: Joint) -> None:
        """d energy/dt = -wrench · u, whatever the twist, and no energy is below zero."""
        for second in (1, None):
            case = _Case(joint, second)
            for time, pose in case.fitting(self.times):
                assert case.links.spring_energy(pose, time) >= 0.0
                twist, pull = case.twist(), flat(case.links.spring_wrench(pose, time))
                slope = _slope(case.links.spring_energy, pose, twist, time)
                self._same_slopes(slope, -np.sum(pull * twist))

    def test_springs_are_as_stiff_as_they_say(self, joint: Joint) -> None:
        """The energy's change is ½|B δ|² about where no spring pulls, with B their `stretch`; nowhere else is asked."""
        case = _Case(joint, 1)
        springs, twist = joint.springs(case.markers), case.twist()
        for spring in springs:
            wrench = nothing(case.start)
            spring.add_wrench(case.start, wrench)
            if np.abs(flat(wrench)).max() > self.tolerance:
                continue
            change = spring.energy(_moved(case.start, 1e-3 * twist)) - spring.energy(case.start)
            expected = 0.5e-6 * np.sum(np.einsum("rni,ni->r", spring.stretch(case.start), twist) ** 2)
            assert change == pytest.approx(expected, rel=0.02)

    def test_the_coordinate_starts_at_zero_and_has_the_rate_of_its_directions(self, joint: Joint) -> None:
        """d value/dt = E (v₁ - v₂) + A (ω₁ - ω₂) where the joint fits and goes on to; it has a column of its own."""
        coordinate = joint.coordinate
        if coordinate is None:
            return
        assert coordinate.name.isidentifier()
        assert coordinate.name not in columns(joint.dimension, ())["joints"]
        assert coordinate.unit
        for second in (1, None):
            case = _Case(joint, second)
            assert abs(case.value(case.start, 0.0)) <= self.tolerance
            for time, pose in case.fitting(self.times):
                twist = case.fitting_twist(pose, time)
                found = _slope(case.value, pose, twist, time)
                self._same_slopes(found, np.sum(case.coordinate_row(pose) * twist))

    def test_the_coordinate_is_free_unless_driven(self, joint: Joint) -> None:
        """No rigid rows hold it where there is no drive, and with one they do."""
        if joint.coordinate is None:
            return
        case = _Case(joint, 1)
        links = case.links.links(case.start, 0.0)
        rigid = links.rows[links.compliance == 0.0].reshape(-1, 2 * (joint.dimension + case.spins))
        both = np.concatenate([rigid, case.coordinate_row(case.start).reshape(1, -1)])
        assert np.linalg.matrix_rank(both) == np.linalg.matrix_rank(rigid) + (joint.drive is None)

    def test_corners_come_later(self, joint: Joint) -> None:
        """The next corner of a drive is after the time asked about."""
        if joint.drive is not None:
            assert all(joint.drive.next_corner(time) > time for time in self.times)

    def _same_slopes(self, found: FloatArray, expected: Any) -> None:
        scale = 1.0 + np.abs(expected).max(initial=0.0)
        np.testing.assert_allclose(found, expected, rtol=0, atol=self.slope_tolerance * scale)


class _Case:
    """A joint between two bodies, or where ``second`` is None the first and the ground."""

    def __init__(self, joint: Joint, second: int | None) -> None:
        d, self.spins = joint.dimension, 1 if joint.dimension == 2 else 3
        random = np.random.default_rng(3)
        self._joint, self._random = joint, random
        position = random.uniform(-0.5, 0.5, (2, d)) + np.array([[0.0], [1.0]])
        zero = np.zeros((2, 1)) if d == 2 else np.tile(np.eye(1, 4), (2, 1))
        self.start = Pose(position, rotate(zero, random.normal(size=(2, self.spins))))
        placed = PlacedJoint("it", joint, 0, second, position.mean(axis=0))
        self.markers = joint_markers(placed, self.start)
        inertia = np.array([1.0, 1.5])[:, None, None] * np.diag([0.3, 0.2, 0.4][: self.spins])
        rest = Twist(np.zeros((2, d)), np.zeros((2, self.spins)))
        bodies = SingleBodies(np.array([1.0, 1.5]), inertia, np.zeros(2, dtype=bool), self.start, rest)
        self.links = JointLinkage(self.start, [placed], [], bodies, self._given)

    def placed(self, pose: Pose) -> PlacedPair:
        """The markers at a pose of the bodies."""
        return Markers([self.markers], self._joint.dimension).placed(pose)[0]

    def twist(self) -> FloatArray:
        """A random one (2, d+k)."""
        return self._random.normal(size=(2, self._joint.dimension + self.spins))

    def fitting(self, times: Sequence[float]) -> list[tuple[float, Pose]]:
        """Poses elsewhere at which the joint fits at these times."""
        return [(time, self._closed(_moved(self.start, 0.3 * self.twist()), time)) for time in times]

    def _closed(self, pose: Pose, time: float) -> Pose:
        try:
            return self.links.closed(pose, time)
        except StepRejected as error:
            raise AssertionError(f"rows lead to no pose at which it fits: {error}") from None

    def fitting_twist(self, pose: Pose, time: float) -> FloatArray:
        """A twist (2, d+k) that the joint allows."""
        twist, d = self.twist(), self._joint.dimension
        return flat(self.links.fitting(pose, Twist(twist[:, :d], twist[:, d:]), time))

    def value(self, pose: Pose, time: float) -> float:
        """Value of the coordinate at a pose, at any time."""
        assert self._joint.coordinate is not None
        return self._joint.coordinate.value(self.placed(pose))

    def coordinate_row(self, pose: Pose) -> FloatArray:
        """The coordinate's row on the twists (2, d+k)."""
        coordinate, at = self._joint.coordinate, self.placed(pose)
        assert coordinate is not None
        rows = np.zeros((1, 2, self._joint.dimension + self.spins))
        add_relative_rows(self.markers.bodies, coordinate.levers(at), coordinate.directions(at), rows)
        return np.asarray(rows[0])

    def _given(self, time: float) -> FloatArray:
        return np.zeros((2, self._joint.dimension + self.spins))


def _moved(pose: Pose, way: FloatArray) -> Pose:
    d = pose.position.shape[1]
    return Pose(pose.position + way[:, :d], rotate(pose.orientation, way[:, d:]))


def _slope(found: Callable[[Pose, float], Any], pose: Pose, twist: FloatArray, time: float) -> FloatArray:
    """Rate of what is found at a pose and a time, along a twist, by a central difference."""
    later, earlier = (found(_moved(pose, sign * _NUDGE * twist), time + sign * _NUDGE) for sign in (1.0, -1.0))
    return np.asarray((later - earlier) / (2.0 * _NUDGE))
