"""The stiffness that is left to the loads, seen by dry head-on impacts."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from touching import NORMAL, contact, unstacked

from rigidfluid.core.contact.laws.repulsion import Repulsion, RepulsionOptions
from rigidfluid.core.contact.laws.work_to_stop import work_to_stop
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Loads
from rigidfluid.errors import ArgumentError, SceneError
from rigidfluid.forces.barrier import BarrierLaw
from rigidfluid.forces.centre import CentreLaw
from rigidfluid.forces.contact import ContactPointLaw
from rigidfluid.forces.normal import NormalLaw

RANGE, SMALLEST = 0.02, 0.005
MASSES = np.array([2.0, 0.5])
LAWS = [CentreLaw, ContactPointLaw, NormalLaw, BarrierLaw]
LOADS = [(1e-2, 1e-2), (1e-2, 1e2), (1e2, 1e-2), (1e2, 1e2), (1.0, 0.0), (0.0, 1.0)]


def loads(weight: float, speed: float, smallest: float = SMALLEST) -> Loads:
    """The second body weighs half as much and is faster by half."""
    return unstacked(MASSES, weight * np.array([1.0, 0.5]), speed * np.array([1.0, 1.5]), smallest)


def smallest_gap(part: type[Repulsion], held: Loads, at_wall: bool) -> float:
    """Of an impact with the full speeds, that the larger weight pushes on, from the integrated equation of motion."""
    law = part(part.Options(epsilon="auto"), RANGE, held)
    radius_b = np.inf if at_wall else 0.3
    mass = MASSES[0] if at_wall else MASSES.prod() / MASSES.sum()
    speed = held.speed[0] if at_wall else held.speed.sum()

    def rate(_: float, state: FloatArray) -> list[float]:
        along = float(law.force(contact(state[0], 0.5, radius_b))[0] @ NORMAL[0])
        return [state[1], (along - held.weight[0]) / mass]

    def turned(_: float, state: FloatArray) -> float:
        return float(state[1])

    turned.terminal, turned.direction = True, 1  # type: ignore[attr-defined]
    with np.errstate(divide="ignore"):
        end = 20 * min(RANGE / np.float64(speed), np.sqrt(2 * RANGE * mass / np.float64(held.weight[0])))
    # no trial step may reach into the overlap, which the barrier refuses
    settings = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-12 * speed + 1e-14, "max_step": end / 400}
    found = solve_ivp(rate, (0, end), [RANGE, -speed], events=turned, **settings)
    return float(found.y_events[0][0, 0])


@pytest.mark.parametrize(("weight", "speed"), LOADS)
@pytest.mark.parametrize("at_wall", [True, False], ids=["wall", "pair"])
@pytest.mark.parametrize("part", LAWS, ids=lambda part: part.name)
def test_impact_ends_at_the_smallest_gap(part: type[Repulsion], at_wall: bool, weight: float, speed: float) -> None:
    assert smallest_gap(part, loads(weight, speed), at_wall) == pytest.approx(SMALLEST, rel=1e-5)


@pytest.mark.parametrize("at_wall", [True, False], ids=["wall", "pair"])
@pytest.mark.parametrize(("fraction", "exact"), [(1.02 / 9, True), (0.9 / 9, False), (0.01, False)])
def test_contact_law_turns_a_resting_weight_at_a_ninth_of_the_range_or_before(
    fraction: float, exact: bool, at_wall: bool
) -> None:
    found = smallest_gap(ContactPointLaw, loads(1.0, 0.0, fraction * RANGE), at_wall)
    assert found >= RANGE / 9
    assert (found == pytest.approx(fraction * RANGE, rel=1e-3)) == exact


@pytest.mark.parametrize("part", LAWS, ids=lambda part: part.name)
def test_the_weight_is_held_at_rest(part: type[Repulsion]) -> None:
    law = part(part.Options(epsilon="auto"), RANGE, loads(1.0, 0.0))
    along = [float(law.force(contact(gap, 0.5, np.inf))[0] @ NORMAL[0]) for gap in np.linspace(SMALLEST, RANGE, 400)]
    assert max(along) > 1.0


def test_auto_at_walls_alone() -> None:
    law = NormalLaw(NormalLaw.Options(epsilon=3.0, epsilon_wall="auto"), RANGE, loads(1.0, 2.0))
    assert law.epsilon(contact(0.01, 0.5, 0.3)) == 3.0
    expected = (RANGE - SMALLEST) ** 3 / 3 / (0.5 * 2.0 * 2.0**2 + RANGE - SMALLEST)
    np.testing.assert_allclose(law.epsilon(contact(0.01, 0.5, np.inf)), expected)


def test_work_to_stop_is_that_of_the_pair() -> None:
    held = loads(4.0, 3.0)
    pair = 0.5 * 0.4 * 7.5**2 + 4.0 * (RANGE - SMALLEST)
    np.testing.assert_allclose(work_to_stop(contact(0.01, 0.5, 0.3), held, RANGE), pair)


def test_a_wall_holds_what_comes_down_on_the_lower_body_and_a_pair_what_the_upper_one_brings() -> None:
    lower, upper = 0, 1
    weight, energy = np.array([9.0, 2.0]), np.array([40.0, 30.0])
    held = replace(loads(4.0, 3.0), stacked_weight=weight, stacked_energy=energy)
    way = RANGE - SMALLEST
    np.testing.assert_allclose(
        work_to_stop(contact(0.01, 0.5, np.inf), held, RANGE), energy[lower] + weight[lower] * way
    )
    pair = 0.5 * 0.4 * 7.5**2  # of the two alone
    np.testing.assert_allclose(work_to_stop(contact(0.01, 0.5, 0.3), held, RANGE), energy[upper] + 4.0 * way)
    held = replace(held, stacked_energy=np.array([40.0, 0.9 * pair]), stacked_weight=np.array([9.0, 6.0]))
    np.testing.assert_allclose(work_to_stop(contact(0.01, 0.5, 0.3), held, RANGE), pair + 6.0 * way)


def test_a_driven_body_is_pressed_on_by_a_stack_like_a_wall() -> None:
    driven = unstacked(np.array([2.0, np.inf]), np.array([4.0, 0.0]), np.array([3.0, 0.0]), SMALLEST)
    held = replace(driven, stacked_weight=np.array([9.0, np.inf]), stacked_energy=np.array([40.0, np.inf]))
    np.testing.assert_allclose(work_to_stop(contact(0.01, 0.5, 0.3), held, RANGE), 40.0 + 9.0 * (RANGE - SMALLEST))


def test_a_driven_body_counts_as_a_wall_that_moves() -> None:
    driven = unstacked(np.array([2.0, np.inf]), np.array([4.0, 0.0]), np.array([3.0, 1.0]), SMALLEST)
    expected = 0.5 * 2.0 * 4.0**2 + 4.0 * (RANGE - SMALLEST)
    np.testing.assert_allclose(work_to_stop(contact(0.01, 0.5, 0.3), driven, RANGE), expected)


def test_a_driven_body_needs_neither_weight_nor_speed() -> None:
    held = unstacked(np.array([2.0, np.inf]), np.array([4.0, 0.0]), np.zeros(2), SMALLEST)
    law = NormalLaw(NormalLaw.Options(epsilon="auto"), RANGE, held)
    np.testing.assert_allclose(law.epsilon(contact(0.01)), (RANGE - SMALLEST) ** 2 / 3 / 4.0)


def test_two_driven_bodies_hold_nothing() -> None:
    driven = unstacked(np.full(2, np.inf), np.zeros(2), np.array([3.0, 1.0]), SMALLEST)
    law = NormalLaw(NormalLaw.Options(epsilon="auto"), RANGE, driven)
    assert not law.force(contact(0.01)).any()


@pytest.mark.parametrize(
    ("held", "text"),
    [
        (None, 'contact.epsilon: found "auto" without known loads; .* Give `epsilon` as a number'),
        (unstacked(MASSES, np.array([1.0, 0.0]), np.zeros(2), SMALLEST), "body 1 that has neither weight nor speed"),
        (loads(1.0, 1.0, 0.0), "contact.smallest_gap: found 0.0; .*below contact.range = 0.02"),
        (loads(1.0, 1.0, RANGE), "contact.smallest_gap: found 0.02"),
    ],
)
@pytest.mark.parametrize("keys", [{"epsilon": "auto"}, {"epsilon": 1.0, "epsilon_wall": "auto"}])
def test_what_cannot_be_computed_is_refused_at_once(keys: dict[str, object], held: Loads | None, text: str) -> None:
    with pytest.raises(SceneError, match=text):
        NormalLaw(NormalLaw.Options(**keys), RANGE, held)


@pytest.mark.parametrize("value", ["much", -1.0, 0.0, True, float("inf")])
@pytest.mark.parametrize("key", ["epsilon", "epsilon_wall"])
def test_other_values_are_refused_in_one_sentence(key: str, value: object) -> None:
    text = f'RepulsionOptions.{key}: found {value!r}; allowed is a valid number greater than 0, or "auto". Correct it;'
    with pytest.raises(ArgumentError, match=re.escape(text)):
        RepulsionOptions(**{"epsilon": 1.0, key: value})
