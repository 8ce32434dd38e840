"""Contract tests of a mechanism."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.frames import distance_to_body, to_world
from rigidfluid.core.mechanics.kinematics import jacobian
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.rigid import lab_inertia, rotate, rotation_between, turned
from rigidfluid.core.mechanics.time_scheme import momentum
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.model.types import Pose, Twist, Wrench
from rigidfluid.core.scene.validation import table_of
from rigidfluid.registry import BODY, Registry

_NUDGE = 1e-6


class MechanismContract:
    """Placement, masses and kinematics of one mechanism, as it is carried by a motion that it had no part in choosing.

    Override the fixture ``mechanism``; parametrise it to hold several to the same standard.
    """

    times: ClassVar[tuple[float, ...]] = (0.0, 0.13, 0.5, 1.7)
    """Times of a driven mechanism's tests [time]; jumps and overlaps are sought from the first to the last."""
    looks: ClassVar[int] = 200
    """Number of looks for jumps and overlaps."""
    tolerance: ClassVar[float] = 1e-10
    """Relative error of exact identities."""
    slope_tolerance: ClassVar[float] = 1e-6
    """Error of rates against central differences of placements, over the sum of size and largest rate [1]."""

    @pytest.fixture
    def mechanism(self) -> Mechanism:
        """The mechanism under test."""
        raise NotImplementedError("override the fixture `mechanism`")

    def test_components_have_names_of_their_own_and_mass(self, mechanism: Mechanism) -> None:
        """Names differ, densities are positive, and the number is always the same."""
        names = [component.name for component in mechanism.components]
        assert names
        assert len(set(names)) == len(names)
        assert all(component.density > 0 for component in mechanism.components)

    def test_shapes_are_of_types_that_a_scene_can_name(self, mechanism: Mechanism) -> None:
        """Each shape is made again from its type's name and its options."""
        for component in mechanism.components:
            shape = component.shape
            part = Registry.load().get(BODY, shape.name)
            again = part(part.Options.model_validate(table_of(shape.options)), mechanism.dimension)
            assert again.volume == pytest.approx(shape.volume)

    def test_placements_have_a_row_for_each_component(self, mechanism: Mechanism) -> None:
        """Positions and orientations of the right shape; quaternions of length 1."""
        for time in self.times:
            count, pose, rate = len(mechanism.components), mechanism.placement(time), mechanism.rate(time)
            d = mechanism.dimension
            assert pose.position.shape == rate.velocity.shape == (count, d)
            assert pose.orientation.shape == ((count, 1) if d == 2 else (count, 4))
            assert rate.angular_velocity.shape == ((count, 1) if d == 2 else (count, 3))
            if d == 3:
                np.testing.assert_allclose(np.linalg.norm(pose.orientation, axis=1), 1.0, atol=self.tolerance)

    def test_what_is_not_driven_keeps_its_shape(self, mechanism: Mechanism) -> None:
        """Without ``driven`` the placement does not depend on time, and its rate is zero."""
        if mechanism.driven:
            return
        start = mechanism.placement(self.times[0])
        for time in self.times:
            pose, rate = mechanism.placement(time), mechanism.rate(time)
            np.testing.assert_array_equal(pose.position, start.position)
            np.testing.assert_array_equal(pose.orientation, start.orientation)
            assert not rate.velocity.any()
            assert not rate.angular_velocity.any()

    def test_the_rate_is_the_derivative_of_the_placement(self, mechanism: Mechanism) -> None:
        """d position/dt = velocity, and orientations turn with the angular velocity."""
        for time in self.times:
            found, expected = mechanism.rate(time), _difference(mechanism.placement, time)
            self._same_slopes(flat(found), expected, self._length(mechanism))

    def test_a_period_repeats_the_placement(self, mechanism: Mechanism) -> None:
        """After a period it is where it was."""
        for time in self.times:
            now, later = mechanism.placement(time), mechanism.placement(time + (mechanism.period or 0.0))
            scale = self.tolerance * self._length(mechanism)
            np.testing.assert_allclose(later.position, now.position, rtol=0, atol=scale)
            np.testing.assert_allclose(later.orientation, now.orientation, rtol=0, atol=self.tolerance)

    def test_corners_come_later_and_have_the_rate_before_them(self, mechanism: Mechanism) -> None:
        """The next corner is after the time asked about, and the rate there is the derivative from before it."""
        for time in self.times:
            corner = mechanism.next_corner(time)
            assert corner > time
            if np.isfinite(corner):
                before = _difference(mechanism.placement, corner - _NUDGE)
                self._same_slopes(flat(mechanism.rate(corner)), before, self._length(mechanism))

    def test_placements_do_not_jump(self, mechanism: Mechanism) -> None:
        """From one look to the next they change as the rates before, between and after say."""
        looks = self._looks(mechanism)
        length = self._length(mechanism)
        for start, end in itertools.pairwise(looks):
            rates = np.array([flat(mechanism.rate(time)) for time in (start, 0.5 * (start + end), end)])
            way, about = _change(mechanism.placement(start), mechanism.placement(end)), (end - start) * rates[1]
            spread = (end - start) * np.ptp(rates, axis=0)
            beyond = np.abs(way - about) - spread - self.slope_tolerance * length
            assert np.all(beyond <= 0.0), f"a jump between times {start:g} and {end:g}: {way} where rates say {about}"

    def test_components_do_not_overlap(self, mechanism: Mechanism) -> None:
        """No point of a component's surface is inside another component, at any time."""
        shapes = [component.shape for component in mechanism.components]
        samples = [shape.sample_surface(500) for shape in shapes]
        for time in (*self.times, *self._looks(mechanism)):
            pose = mechanism.placement(time)
            for one, other in itertools.permutations(range(len(shapes)), 2):
                gap = distance_to_body(pose, other, shapes[other], to_world(pose, one, samples[one])).min()
                assert gap > 0, f"components {one} and {other} overlap by {-gap:g} at time {time:g}"

    def test_its_kinematics_are_derivatives_of_the_poses(self, mechanism: Mechanism) -> None:
        """Poses of the components change by G u with the motion's pose, and by g with time."""
        carried, pose, twist = _carried(mechanism)
        for time in self.times:
            kinematics = carried.kinematics(pose, time)

            def moved(way: float, time: float = time) -> Pose:
                motion = Pose(
                    pose.position + way * twist.velocity, rotate(pose.orientation, way * twist.angular_velocity)
                )
                return carried.poses(motion, time)

            rigid = jacobian(kinematics) @ flat(twist).ravel()
            scale = self._length(mechanism)
            self._same_slopes(rigid.reshape(kinematics.relative_twist.shape), _difference(moved, 0.0), scale)
            by_time = _difference(lambda time: carried.poses(pose, time), time)
            self._same_slopes(kinematics.relative_twist, by_time, scale)
            both = flat(kinematics.component_twist(twist))
            expected = rigid.reshape(both.shape) + kinematics.relative_twist
            np.testing.assert_allclose(both, expected, atol=self.tolerance * scale)

    def test_wrenches_do_the_same_work_on_the_whole(self, mechanism: Mechanism) -> None:
        """w · G u = Gᵀw · u."""
        carried, pose, _ = _carried(mechanism)
        random, d = np.random.default_rng(5), mechanism.dimension
        for time in self.times:
            kinematics = carried.kinematics(pose, time)
            rows = random.normal(size=kinematics.relative_twist.shape)
            on_whole = flat(kinematics.motion_wrench(Wrench(rows[:, :d], rows[:, d:])))
            expected = jacobian(kinematics).T @ rows.ravel()
            scale = np.abs(expected).max()
            np.testing.assert_allclose(on_whole.ravel(), expected, atol=self.tolerance * scale)

    def test_the_whole_has_the_momentum_of_its_components(self, mechanism: Mechanism) -> None:
        """Gᵀ M (G u + g) = (m U, R (I Rᵀ ω + h)), about the common centre of mass."""
        carried, pose, twist = _carried(mechanism)
        mass, inertia = _masses(mechanism)
        for time in self.times:
            kinematics = carried.kinematics(pose, time)
            assert np.abs(mass @ kinematics.arm).max() <= self.tolerance * mass.sum() * self._length(mechanism)
            parts = momentum(mass, inertia, carried.poses(pose, time), kinematics.component_twist(twist))
            d = mechanism.dimension
            together = flat(kinematics.motion_wrench(Wrench(parts[:, :d], parts[:, d:])))[0]
            lab = lab_inertia(carried.inertia(time), pose.orientation)[0]
            spin = lab @ twist.angular_velocity[0] + turned(pose.orientation, carried.spin(time))[0]
            whole = np.append(carried.mass[0] * twist.velocity[0], spin)
            np.testing.assert_allclose(together, whole, atol=self.tolerance * np.abs(whole).max())
            assert carried.mass[0] == pytest.approx(mass.sum())

    def _same_slopes(self, found: FloatArray, expected: FloatArray, scale: float) -> None:
        enough = self.slope_tolerance * (scale + float(np.abs(found).max()))
        np.testing.assert_allclose(found, expected, rtol=0, atol=enough)

    def _looks(self, mechanism: Mechanism) -> FloatArray:
        """Times from the first to the last [time]; the first alone without ``driven``."""
        first, last = min(self.times), max(self.times)
        return np.linspace(first, last, self.looks) if mechanism.driven else np.array([first])

    def _length(self, mechanism: Mechanism) -> float:
        """Size of the mechanism [length]."""
        reach = [component.shape.bounding_radius for component in mechanism.components]
        return float(np.ptp(mechanism.placement(self.times[0]).position, axis=0).max() + max(reach))


def _carried(mechanism: Mechanism) -> tuple[CarriedBodies, Pose, Twist]:
    """The mechanism on a motion with any pose and twist."""
    random, d = np.random.default_rng(2), mechanism.dimension
    turn = np.array([[0.7]]) if d == 2 else random.normal(size=(1, 4))
    pose = Pose(random.normal(size=(1, d)), turn if d == 2 else turn / np.linalg.norm(turn))
    twist = Twist(random.normal(size=(1, d)), random.normal(size=(1, 1 if d == 2 else 3)))
    mass, inertia = _masses(mechanism)
    return CarriedBodies({"it": mechanism}, mass, inertia, np.zeros(len(mass), dtype=bool), pose, twist), pose, twist


def _masses(mechanism: Mechanism) -> tuple[FloatArray, FloatArray]:
    """Mass (m,) and inertia (m, k, k) of the components."""
    mass = np.array([component.density * component.shape.volume for component in mechanism.components])
    unit = np.array([component.shape.unit_inertia for component in mechanism.components])
    return mass, mass[:, None, None] * unit


def _difference(poses: Callable[[float], Pose], at: float) -> FloatArray:
    """Central difference of poses, (m, d+k)."""
    return _change(poses(at - _NUDGE), poses(at + _NUDGE)) / (2.0 * _NUDGE)


def _change(before: Pose, after: Pose) -> FloatArray:
    """Translations and turns from one to the other, (m, d+k)."""
    straight, turning = after.position - before.position, rotation_between(before.orientation, after.orientation)
    return np.concatenate([straight, turning], axis=1)
