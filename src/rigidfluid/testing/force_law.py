"""What every force law must satisfy."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.interfaces import ForceLaw
from rigidfluid.core.types import Contacts, FloatArray, IntArray


class ForceLawContract:
    """A repulsion that is zero beyond its range and has an energy.

    Override the fixture ``law``. Where a law needs other contacts than two balls and a ball at a wall, override
    ``make_contacts``.
    """

    gap_fractions: ClassVar[tuple[float, ...]] = (0.03, 0.2, 0.5, 0.8, 0.97)
    """The gaps, as parts of the range, at which the law is evaluated."""

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
        """No force and no energy from the range on."""
        contacts = self.make_contacts(law.range * np.array([1.0, 1.001, 2.0, 1e6]), dimension)
        assert not law.force(contacts).any()
        assert not law.energy(contacts).any()

    def test_continuous_at_range(self, law: ForceLaw, dimension: int) -> None:
        """Force and energy fade out as the gap grows to the range."""
        force = np.linalg.norm(law.force(self._contacts_of(law, (0.5, 1 - 1e-9), dimension)), axis=1)
        energy = law.energy(self._contacts_of(law, (0.5, 1 - 1e-9), dimension))
        assert np.all(force[1::2] < 1e-6 * force[::2])
        assert np.all(energy[1::2] < 1e-6 * energy[::2])

    def test_repels_along_the_normal(self, law: ForceLaw, dimension: int) -> None:
        """The force on a points along the normal, away from b."""
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        force = law.force(contacts)
        along = np.sum(force * contacts.normal, axis=1)
        assert np.all(along > 0)
        np.testing.assert_allclose(force, along[:, None] * contacts.normal, rtol=0, atol=1e-12 * along.max())

    def test_force_is_minus_the_slope_of_the_energy(self, law: ForceLaw, dimension: int) -> None:
        """F = -dU/dgap, by a central difference of fourth order."""
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        along = np.sum(law.force(contacts) * contacts.normal, axis=1)
        step = 1e-3 * law.range
        near = law.energy(_moved(contacts, step)) - law.energy(_moved(contacts, -step))
        wide = law.energy(_moved(contacts, 2 * step)) - law.energy(_moved(contacts, -2 * step))
        np.testing.assert_allclose(along, -(8 * near - wide) / (12 * step), rtol=1e-6)

    def test_turns_with_the_frame(self, law: ForceLaw, dimension: int) -> None:
        """Turning the contacts turns the force and leaves the energy."""
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        rotation = np.linalg.qr(np.random.default_rng(5).normal(size=(dimension, dimension)))[0]
        turned = replace(
            contacts,
            point_a=contacts.point_a @ rotation.T,
            point_b=contacts.point_b @ rotation.T,
            normal=contacts.normal @ rotation.T,
        )
        force = law.force(contacts)
        np.testing.assert_allclose(law.force(turned), force @ rotation.T, rtol=0, atol=1e-12 * np.abs(force).max())
        np.testing.assert_allclose(law.energy(turned), law.energy(contacts), rtol=1e-12)

    def test_contacts_do_not_influence_each_other(self, law: ForceLaw, dimension: int) -> None:
        """The order and the number of contacts change nothing, and none at all is allowed."""
        contacts = self._contacts_of(law, self.gap_fractions, dimension)
        order = np.random.default_rng(7).permutation(len(contacts))[: len(contacts) // 2]
        np.testing.assert_allclose(law.force(_taken(contacts, order)), law.force(contacts)[order], rtol=1e-14)
        nothing = _taken(contacts, order[:0])
        assert law.force(nothing).shape == (0, dimension)
        assert law.energy(nothing).shape == (0,)

    def _contacts_of(self, law: ForceLaw, fractions: tuple[float, ...], dimension: int) -> Contacts:
        return self.make_contacts(law.range * np.array(fractions), dimension)


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
    )


def _moved(contacts: Contacts, distance: float) -> Contacts:
    return replace(contacts, point_a=contacts.point_a + distance * contacts.normal, gap=contacts.gap + distance)


def _taken(contacts: Contacts, chosen: IntArray) -> Contacts:
    return Contacts(*(getattr(contacts, field)[chosen] for field in Contacts.__slots__))
