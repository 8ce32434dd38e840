"""Contract tests of a force law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.mechanics.wrenches import contact_wrench
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.pair_formula import compiled, own_formula
from rigidfluid.core.model.types import Contacts, Motion, Pose
from rigidfluid.errors import StepRejected

Column = Callable[[Contacts], FloatArray]


class ForceLawContract:
    """A short-range force that an energy gives, with or without damping, or damping alone.

    Override the fixture ``law``; and ``make_contacts`` for a law that needs other contacts than two balls and a ball at
    a wall: both balls are bodies 0 and 1, the wall is surface 2. The law itself declares its behaviour: ``sign``,
    ``overlap``, ``acts_in``, ``vanishes_at_range``, and whether it has an energy, damping and couples at all,
    ``conservative``, ``dissipative`` and ``couples``.
    """

    gap_fractions: ClassVar[tuple[float, ...]] = (0.03, 0.2, 0.5, 0.8, 0.97)
    """The gaps, as parts of the range, at which the law is evaluated."""
    overlap_fractions: ClassVar[tuple[float, ...]] = (-0.02, -0.3)
    """The gaps in overlap, as parts of the range."""

    @pytest.fixture
    def law(self) -> ForceLaw:
        """The law under test."""
        raise NotImplementedError("override the fixture `law`")

    @pytest.fixture(params=[2, 3])
    def dimension(self, request: pytest.FixtureRequest) -> int:
        """Both numbers of space dimensions."""
        return int(request.param)

    def make_contacts(self, gap: FloatArray, dimension: int) -> Contacts:
        """Balls of radius 0.7 and 0.4, and balls at a wall, at each of the gaps ``gap`` (m,) [length]."""
        return _ball_contacts(np.tile(gap, 2), np.repeat([0.4, np.inf], len(gap)), dimension)

    def test_zero_beyond_range(self, law: ForceLaw, dimension: int) -> None:
        """No force of any kind, no energy and no stiffness from the range on."""
        contacts = self._contacts_of(law, (1.0, 1.001, 2.0, 1e6), dimension)
        for column in (law.force, law.energy, law.stiffness):
            assert not column(contacts).any()
        assert not law.damping(contacts, _motion(contacts)).any()
        assert not law.couple(contacts, _motion(contacts)).any()

    def test_continuous_at_range(self, law: ForceLaw, dimension: int) -> None:
        """Force and energy fade out as the gap grows to the range; the force may jump there where the law says so."""
        _needs_energy(law)
        inside = self.gap_fractions if law.sign == "either" else (0.5,)
        contacts, each = self._contacts_of(law, (*inside, 1 - 1e-9), dimension), len(inside) + 1
        force, energy = np.linalg.norm(law.force(contacts), axis=1), np.abs(law.energy(contacts))
        largest_force, largest_energy = (column.reshape(-1, each)[:, :-1].max(axis=1) for column in (force, energy))
        assert np.all(energy[each - 1 :: each] < 1e-6 * largest_energy)
        assert np.all(force[each - 1 :: each] < 1e-6 * largest_force) == law.vanishes_at_range

    def test_acts_along_the_normal_as_it_declares(self, law: ForceLaw, dimension: int) -> None:
        """The force on a points along the normal, away from b if the law repels, towards it if it attracts."""
        _needs_energy(law)
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        along = _along(law, contacts)
        if law.sign != "either":
            assert np.all(along > 0 if law.sign == "repels" else along < 0)
        np.testing.assert_allclose(
            law.force(contacts), along[:, None] * contacts.normal, rtol=0, atol=1e-12 * np.abs(along).max()
        )

    def test_force_is_minus_the_slope_of_the_energy(self, law: ForceLaw, dimension: int) -> None:
        """F = -dU/dgap, by a central difference of fourth order."""
        contacts = self._contacts_of(law, self._finite_fractions(law), dimension)
        found = _along(law, contacts)
        expected = -_slope(law.energy, contacts, law.range)
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=self._rounding(law, found))

    def test_stiffness_is_minus_the_slope_of_the_force(self, law: ForceLaw, dimension: int) -> None:
        """Stiffness = -dF/dgap, by a central difference of fourth order."""
        contacts = self._contacts_of(law, self._finite_fractions(law), dimension)
        slope = _slope(lambda moved: _along(law, moved), contacts, law.range)
        found = law.stiffness(contacts)
        np.testing.assert_allclose(found, -slope, rtol=1e-6, atol=1e-9 * np.abs(found).max())

    def test_does_in_overlap_what_it_declares(self, law: ForceLaw, dimension: int) -> None:
        """Repels or attracts, without a jump at contact, or has any force, or an infinite energy and refuses."""
        _needs_energy(law)
        overlapping = self._contacts_of(law, self.overlap_fractions, dimension)
        if law.overlap == "unbounded":
            assert np.all(np.isposinf(law.energy(overlapping)))
            for column in (law.force, law.stiffness):
                with pytest.raises(StepRejected):
                    column(overlapping)
            near = law.energy(self._contacts_of(law, (1e-2, 1e-4, 1e-8, 1e-16), dimension)).reshape(-1, 4)
            assert np.all(np.diff(near, axis=1) > 0)
            return
        columns: list[Column] = [law.energy]
        if law.overlap != "either":
            sign = 1 if law.overlap == "repels" else -1
            assert np.all(sign * _along(law, overlapping) > 0)
            columns += [law.stiffness, lambda contacts: _along(law, contacts)]
        both = (-1e-9, 1e-9)
        for one in columns:
            before, after = one(self._contacts_of(law, both, dimension)).reshape(-1, 2).T
            largest = np.abs(one(self._contacts_of(law, self.gap_fractions, dimension))).max()
            np.testing.assert_allclose(before, after, rtol=0, atol=1e-6 * largest)

    def test_has_the_kinds_of_force_that_it_declares(self, law: ForceLaw, dimension: int) -> None:
        """An energy if conservative, damping if dissipative, one of both at least, couples only beside damping, and
        zeros where it has none."""
        assert law.conservative or law.dissipative
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        for column in (law.force, law.energy):
            assert column(contacts).any() == law.conservative
        if law.vanishes_at_range:
            assert law.stiffness(contacts).any() == law.conservative
        assert law.conservative or not law.stiffness(contacts).any()
        assert law.damping(contacts, _motion(contacts)).any() == law.dissipative
        assert law.couple(contacts, _motion(contacts)).any() == law.couples
        assert law.dissipative or not law.couples

    def test_damping_never_adds_energy(self, law: ForceLaw, dimension: int) -> None:
        """Damping · velocity + couple · angular velocity ≤ 0 however bodies move and turn, and none of both at rest."""
        contacts = self._contacts_of(law, self._finite_fractions(law), dimension)
        for seed in range(20):
            motion = _motion(contacts, seed)
            power = _power(law, contacts, motion)
            assert np.all(power <= 1e-12 * np.abs(power).max())
            least = _power(law, contacts, _least_resisted(law, contacts, motion))
            assert np.all(least <= 1e-12 * np.abs(power).max())
        still = Motion(np.zeros_like(motion.velocity), motion.mass)
        assert not law.damping(contacts, still).any()
        assert not law.couple(contacts, still).any()

    def test_turns_and_moves_with_the_frame(self, law: ForceLaw, dimension: int) -> None:
        """Turning the contacts turns the forces, and nothing else changes; where they are changes nothing."""
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        motion = _motion(contacts)
        rotation = np.linalg.qr(np.random.default_rng(5).normal(size=(dimension, dimension)))[0]
        shift, curvatures = np.random.default_rng(6).normal(size=dimension), contacts.curvatures
        turned = replace(
            contacts,
            point_a=contacts.point_a @ rotation.T + shift,
            point_b=contacts.point_b @ rotation.T + shift,
            normal=contacts.normal @ rotation.T,
            curvatures=None if curvatures is None else rotation @ curvatures @ rotation.T,
        )
        spin = motion.angular_velocity
        turned_motion = replace(motion, velocity=motion.velocity @ rotation.T, angular_velocity=_turned(spin, rotation))
        _assert_close(law.force(turned), law.force(contacts) @ rotation.T)
        _assert_close(law.damping(turned, turned_motion), law.damping(contacts, motion) @ rotation.T)
        _assert_close(law.couple(turned, turned_motion), _turned(law.couple(contacts, motion), rotation))
        _assert_close(law.energy(turned), law.energy(contacts))
        _assert_close(law.stiffness(turned), law.stiffness(contacts))

    def test_swapping_the_pair_turns_the_force_round(self, law: ForceLaw, dimension: int) -> None:
        """Which of two bodies is called a makes no difference."""
        contacts = self._pairs_of(law, dimension)
        if len(contacts) == 0:
            pytest.skip("the law acts at walls alone")
        motion = _motion(contacts)
        swapped = Contacts(
            body_a=contacts.body_b,
            body_b=contacts.body_a,
            point_a=contacts.point_b,
            point_b=contacts.point_a,
            normal=-contacts.normal,
            gap=contacts.gap,
            radius_a=contacts.radius_b,
            radius_b=contacts.radius_a,
            at_wall=contacts.at_wall,
            effective_radius=contacts.effective_radius,
            curvatures=None if contacts.curvatures is None else contacts.curvatures[:, ::-1],
        )
        _assert_close(law.force(swapped), -law.force(contacts))
        opposite = Motion(-motion.velocity, motion.mass, -motion.angular_velocity)
        _assert_close(law.damping(swapped, opposite), -law.damping(contacts, motion))
        _assert_close(law.couple(swapped, opposite), -law.couple(contacts, motion))
        _assert_close(law.energy(swapped), law.energy(contacts))
        _assert_close(law.stiffness(swapped), law.stiffness(contacts))

    def test_a_pair_gains_no_momentum(self, law: ForceLaw, dimension: int) -> None:
        """With ``core/mechanics/wrenches``, all forces of the law have no resultant and no moment about any point."""
        contacts = self._pairs_of(law, dimension)
        if len(contacts) == 0:
            pytest.skip("the law acts at walls alone")
        count = 1 + int(max(contacts.body_a.max(), contacts.body_b.max()))
        position = np.random.default_rng(8).normal(size=(count, dimension))
        pose = Pose(position, np.tile(np.eye(1, 1 if dimension == 2 else 4), (len(position), 1)))
        force, couple = law.force(contacts) + law.damping(contacts, _motion(contacts)), None
        if law.couples:
            couple = law.couple(contacts, _motion(contacts))
        wrench = contact_wrench(contacts, force, pose, couple)
        about = np.random.default_rng(9).normal(size=dimension)
        turning = wrench.torque + moment(position - about, wrench.force)
        scale = np.abs(force).max()
        np.testing.assert_allclose(wrench.force.sum(axis=0), 0.0, rtol=0, atol=1e-12 * scale)
        np.testing.assert_allclose(turning.sum(axis=0), 0.0, rtol=0, atol=1e-11 * scale)

    def test_contacts_do_not_influence_each_other(self, law: ForceLaw, dimension: int) -> None:
        """The order and the number of contacts change nothing, and none at all is allowed."""
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        motion = _motion(contacts)
        order = np.random.default_rng(7).permutation(len(contacts))[: len(contacts) // 2]
        for chosen in (order, order[:0]):
            some, moving = select(contacts, chosen), motion.select(chosen)
            for column in (law.force, law.energy, law.stiffness):
                np.testing.assert_allclose(column(some), column(contacts)[chosen], rtol=1e-14)
            np.testing.assert_allclose(law.damping(some, moving), law.damping(contacts, motion)[chosen], rtol=1e-14)
            np.testing.assert_allclose(law.couple(some, moving), law.couple(contacts, motion)[chosen], rtol=1e-14)

    def test_a_formula_gives_the_same_force(self, law: ForceLaw, dimension: int) -> None:
        """The formula of one contact, if the class has one, gives energy, force, damping and the stiffness of springs,
        and can be compiled."""
        formula = own_formula(law)
        if formula is None:
            pytest.skip("the law has no formula")
        springs = formula.springs
        assert law.sticking == (springs is not None)
        assert law.couples == (springs is not None and max(springs.rolling, springs.twisting) > 0.0)
        contacts = self._contacts_of(law, (*self._finite_fractions(law), 1.0), dimension)
        motion = _motion(contacts)
        opening = np.sum(motion.velocity * contacts.normal, axis=1)
        along = motion.velocity - opening[:, None] * contacts.normal
        numbers = (
            contacts.gap,
            contacts.radius_a,
            contacts.radius_b,
            motion.mass,
            opening,
            np.linalg.norm(along, axis=1),
        )
        own = [formula.parameters] * len(contacts) if formula.each is None else formula.each(contacts)
        parts = [formula.function(*row) for row in zip(own, *numbers, strict=True)]
        _assert_close(np.array(parts)[:, 0], law.energy(contacts))
        push, damping, drag = np.array(parts).T[1:, :, None]
        if springs is not None:
            inside = contacts.gap < law.range
            _assert_close(np.where(inside, springs.stiffness, 0.0), law.tangential_stiffness(contacts))
            if springs.bounded:
                drag = np.minimum(
                    drag, springs.friction * np.abs(push + damping) / np.linalg.norm(along, axis=1)[:, None]
                )
        _assert_close(push * contacts.normal, law.force(contacts))
        _assert_close(damping * contacts.normal - drag * along, law.damping(contacts, motion))
        assert np.all(drag >= 0.0)
        assert compiled(formula.function)

    def _contacts_of(self, law: ForceLaw, fractions: tuple[float, ...], dimension: int) -> Contacts:
        contacts = self.make_contacts(law.range * np.array(fractions), dimension)
        if law.acts_in == "all":
            return contacts
        return select(contacts, np.flatnonzero(contacts.at_wall == (law.acts_in == "walls")))

    def _rounding(self, law: ForceLaw, force: FloatArray) -> float:
        """Rounding of slopes, which a force that is zero in part of the range is compared with."""
        return 1e-9 * float(np.abs(force).max()) if law.sign == "either" or law.overlap == "either" else 0.0

    def _finite_fractions(self, law: ForceLaw) -> tuple[float, ...]:
        return self.gap_fractions if law.overlap == "unbounded" else (*self.gap_fractions, *self.overlap_fractions)

    def _pairs_of(self, law: ForceLaw, dimension: int) -> Contacts:
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        return select(contacts, np.flatnonzero(~contacts.at_wall))


def _needs_energy(law: ForceLaw) -> None:
    if not law.conservative:
        pytest.skip("the law has no energy")


def _ball_contacts(gap: FloatArray, radius_b: FloatArray, dimension: int) -> Contacts:
    count = len(gap)
    normal = np.random.default_rng(2).normal(size=(count, dimension))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    point_b = np.random.default_rng(4).normal(size=(count, dimension))
    return Contacts(
        body_a=np.zeros(count, dtype=np.int64),
        body_b=np.where(np.isinf(radius_b), 2, 1),
        point_a=point_b + gap[:, None] * normal,
        point_b=point_b,
        normal=normal,
        gap=gap,
        radius_a=np.full(count, 0.7),
        radius_b=radius_b,
        at_wall=np.isinf(radius_b),
    )


def _motion(contacts: Contacts, seed: int = 3) -> Motion:
    random, dimension = np.random.default_rng(seed), contacts.normal.shape[1]
    velocity, mass = random.normal(size=contacts.normal.shape), random.uniform(0.1, 10.0, len(contacts))
    return Motion(velocity, mass, random.normal(size=(len(contacts), 1 if dimension == 2 else 3)))


def _power(law: ForceLaw, contacts: Contacts, motion: Motion) -> FloatArray:
    """Power of damping and couples, (m,) [energy/time]."""
    power = np.sum(law.damping(contacts, motion) * motion.velocity, axis=1)
    return np.asarray(power + np.sum(law.couple(contacts, motion) * motion.angular_velocity, axis=1))


def _least_resisted(law: ForceLaw, contacts: Contacts, motion: Motion) -> Motion:
    """Motion whose power is the greatest if force and couple are linear: an eigenvector of their matrix (d+k, d+k)."""
    dimension, width = motion.velocity.shape[1], motion.velocity.shape[1] + motion.angular_velocity.shape[1]
    answers = []
    for unit in np.eye(width):
        velocity, spin = (np.tile(part, (len(contacts), 1)) for part in np.split(unit, [dimension]))
        one = Motion(velocity, motion.mass, spin)
        answers.append(np.hstack([law.damping(contacts, one), law.couple(contacts, one)]))
    matrix = np.stack(answers, axis=2)
    greatest = np.linalg.eigh(matrix + np.swapaxes(matrix, 1, 2))[1][:, :, -1]
    return Motion(greatest[:, :dimension], motion.mass, greatest[:, dimension:])


def _turned(spin: FloatArray, rotation: FloatArray) -> FloatArray:
    """Angular velocities or couples (m, k) in a frame turned or mirrored by ``rotation`` (d, d)."""
    turned = spin if len(rotation) == 2 else spin @ rotation.T
    return np.asarray(np.linalg.det(rotation) * turned)


def _along(law: ForceLaw, contacts: Contacts) -> FloatArray:
    return np.asarray(np.sum(law.force(contacts) * contacts.normal, axis=1))


def _slope(column: Column, contacts: Contacts, law_range: float) -> FloatArray:
    """d/dgap by a central difference of fourth order, with steps that are short relative to gap and range."""
    step = 1e-3 * np.minimum(np.abs(contacts.gap), law_range - contacts.gap)
    near = column(_moved(contacts, step)) - column(_moved(contacts, -step))
    wide = column(_moved(contacts, 2 * step)) - column(_moved(contacts, -2 * step))
    return np.asarray((8 * near - wide) / (12 * step))


def _moved(contacts: Contacts, distance: FloatArray) -> Contacts:
    point_a = contacts.point_a + distance[:, None] * contacts.normal
    return replace(contacts, point_a=point_a, gap=contacts.gap + distance)


def _assert_close(found: FloatArray, expected: FloatArray) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
