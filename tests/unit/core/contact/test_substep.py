"""Substeps are as long as the frequencies of two balls ask for that closed forms give, and no longer."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, log2
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.contact.path.substep import RESOLUTION, Reach, plan, relative_motion
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.interactions import Interaction, SumOfLaws
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Motion, Pose, Twist
from rigidfluid.forces.normal import NormalLaw
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw

MASS, RADIUS, RANGE = np.array([2.0, 3.0]), 0.5, 0.1
NONE = np.zeros(2, dtype=bool)
INVERSE = float(np.sum(1.0 / MASS))
BALLS = Reach(np.zeros(2), np.zeros(2))


def touching(gap: float) -> Contacts:
    """The first ball beside the second one, along x."""
    return Contacts(
        body_a=np.array([0]), body_b=np.array([1]),
        point_a=np.array([[gap, 0.0]]), point_b=np.zeros((1, 2)), normal=np.array([[1.0, 0.0]]), gap=np.array([gap]),
        radius_a=np.array([RADIUS]), radius_b=np.array([RADIUS]), at_wall=np.array([False]),
    )  # fmt: skip


def balls(gap: float, velocity: FloatArray, weight: float = 0.0, spin: FloatArray | None = None) -> DryDynamics:
    pose = Pose(np.array([[gap + RADIUS, 0.0], [-RADIUS, 0.0]]), np.zeros((2, 1)))
    turning = np.zeros((2, 1)) if spin is None else spin
    pull = np.array([[-weight, 0.0], [0.0, 0.0]])
    return DryDynamics(pose, Twist(velocity, turning), MASS, np.ones((2, 1, 1)), pull, NONE, lambda _: np.zeros(0))


def spring(stiffness: float, **keys: float) -> ForceLaw:
    return SpringDashpotLaw(SpringDashpotLaw.Options(stiffness=stiffness, **keys), RANGE)  # type: ignore[arg-type]


def assert_resolved(
    law: ForceLaw,
    gap: float,
    body: DryDynamics,
    rate: float,
    reach: Reach = BALLS,
    contacts: Contacts | None = None,
) -> None:
    """Halvings are those of a step just too long, and just short enough, for so many of them."""
    for share, halvings in ((1.02, 6), (0.98, 5)):
        size = share * 2.0**5 * RESOLUTION / rate
        found = plan(law, contacts or touching(gap), body, reach, size, size)
        assert ceil(log2(size / found.substep) - 1e-9) == halvings


CLOSING = np.array([[-1.0, 0.0], [0.5, 0.0]])


def test_a_spring_is_resolved_on_both_bodies() -> None:
    """ω² = k (1/m_a + 1/m_b), and (1 + c) times that at points that give way by c more."""
    rate = np.sqrt(7.0 * INVERSE)
    assert_resolved(spring(7.0), 0.05, balls(0.05, CLOSING), rate)
    factors = Reach(np.zeros(2), np.array([3.0, 3.0]))
    assert_resolved(spring(7.0), 0.05, balls(0.05, CLOSING), 2.0 * rate, factors)


def test_a_damper_that_is_faster_than_the_spring_is_resolved() -> None:
    assert_resolved(spring(7.0, damping=40.0), 0.05, balls(0.05, CLOSING), 40.0 * INVERSE)


class Brake(ForceLaw):
    """F = -s v and the couple -c w, in range."""

    name: ClassVar[str] = "brake"
    conservative: bool = False
    dissipative: bool = True
    couples: bool = True

    def __init__(self, sliding: float, turning: float) -> None:
        super().__init__(PartOptions(), RANGE)
        self.coefficients = sliding, turning

    def force(self, contacts: Contacts) -> FloatArray:
        return np.zeros_like(contacts.normal)

    def energy(self, contacts: Contacts) -> FloatArray:
        return np.zeros_like(contacts.gap)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        return np.zeros_like(contacts.gap)

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        return np.where(contacts.gap < RANGE, -self.coefficients[0], 0.0)[:, None] * motion.velocity

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        return np.where(contacts.gap < RANGE, -self.coefficients[1], 0.0)[:, None] * motion.angular_velocity


def test_what_brakes_the_spin_is_resolved() -> None:
    """Twice c (1/I_a + 1/I_b), and s (1/m + l²/I) of both besides, l the distance of the contact from the centre."""
    assert_resolved(Brake(0.0, 30.0), 0.05, balls(0.05, CLOSING), 2.0 * 30.0 * 2.0)
    sliding = 9.0 * (INVERSE + 0.525**2 + 0.525**2)
    assert_resolved(Brake(9.0, 30.0), 0.05, balls(0.05, CLOSING), 2.0 * (sliding + 30.0 * 2.0))


def test_springs_along_surfaces_of_a_law_that_begins_nearer_than_another_are_resolved() -> None:
    """k_t (1/m + l²/I) of both, l the distance of the contact from the centre, which lies beyond their law's range."""
    options = SpringDashpotLaw.Options(stiffness=1e-3, friction=1.0, tangential_stiffness=80.0)
    laws = SpringDashpotLaw(options, 0.5 * RANGE), spring(1e-3)
    both = SumOfLaws([Interaction("interaction", law, "all", ()) for law in laws])
    rate = np.sqrt(80.0 * (INVERSE + 2.0 * 0.54**2))
    assert_resolved(both, 0.08, balls(0.08, CLOSING), rate)


def rate_at(depth: float, epsilon: float) -> float:
    """Of the law `normal`, whose stiffness is 2 w/ε and whose energy is w³/(3 ε)."""
    return float(np.sqrt(2.0 * depth / epsilon * INVERSE))


def test_the_depth_is_that_at_which_the_energy_of_the_approach_is_used_up() -> None:
    """½ m v² of the reduced mass at 1.5, from range on."""
    law = NormalLaw(NormalLaw.Options(epsilon=1e-4), RANGE)
    depth = float(np.cbrt(3e-4 * 0.5 * 1.5**2 / INVERSE))
    assert depth < RANGE
    assert_resolved(law, 0.2, balls(0.2, CLOSING), rate_at(depth, 1e-4))


def test_a_force_adds_its_work_on_the_way_in() -> None:
    """Where bodies rest in range, pressed by a weight that acts on the first one alone."""
    law, weight = NormalLaw(NormalLaw.Options(epsilon=1e-4), RANGE), 20.0
    force = weight / MASS[0] / INVERSE
    depth = float(np.sqrt(3e-4 * force))
    assert depth < RANGE
    assert_resolved(law, RANGE, balls(RANGE, np.zeros((2, 2)), weight), rate_at(depth, 1e-4))


def test_what_slides_past_has_the_energy_that_turning_takes_from_it() -> None:
    """½ m v² (1 - r²/r₀²), r₀ where the range began, besides what is stored."""
    law, gap, speed = NormalLaw(NormalLaw.Options(epsilon=1e-4), RANGE), 0.09, 3.0
    share = 1.0 - ((2.0 * RADIUS + gap) / (2.0 * RADIUS + RANGE)) ** 2
    stored = (RANGE - gap) ** 3 / 3e-4
    depth = float(np.cbrt(3e-4 * (stored + 0.5 * speed**2 / INVERSE * share)))
    body = balls(gap, np.array([[0.0, speed], [0.0, 0.0]]))
    assert_resolved(law, gap, body, rate_at(depth, 1e-4))
    image = replace(touching(gap), shift=np.array([[-7.0, 2.0]]))
    there = replace(body.pose, position=body.pose.position - [[0.0, 0.0], [-7.0, 2.0]])
    across = DryDynamics(there, body.twist, MASS, np.ones((2, 1, 1)), np.zeros((2, 2)), NONE, lambda _: np.zeros(0))
    assert_resolved(law, gap, across, rate_at(depth, 1e-4), contacts=image)


def test_nothing_touches_before_bodies_have_come_to_range() -> None:
    """At the speed of the end of the span all the while."""
    body, span = balls(0.4, CLOSING, weight=4.0), 0.05
    speed = 1.5 + span * 4.0 / MASS[0]
    found = plan(spring(1e6), touching(0.4), body, BALLS, 0.5, span)
    assert found.free_flight == span
    near = plan(spring(1e6), touching(0.15), balls(0.15, CLOSING, weight=4.0), BALLS, 0.5, span)
    assert near.free_flight == pytest.approx(0.05 / speed)


@pytest.mark.parametrize("alone", [False, True])
def test_the_relative_motion_is_that_of_the_surfaces(alone: bool) -> None:
    """Both bodies turn; the second one may be a wall."""
    gap, spin = 0.2, np.array([[2.0], [5.0]])
    found, body = touching(gap), balls(gap, CLOSING, spin=spin)
    if alone:
        found = replace(found, body_b=np.array([2]))
    motion = relative_motion(found, body)
    first, second = np.array([-1.0, -2.0 * (RADIUS + 0.1)]), np.array([0.5, 5.0 * (RADIUS + 0.1)])
    np.testing.assert_allclose(motion.velocity, [first - (0.0 if alone else 1.0) * second])
    assert motion.mass[0] == pytest.approx(MASS[0] if alone else 1.0 / INVERSE)
