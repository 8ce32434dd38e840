import numpy as np
import pytest
from scipy.integrate import solve_ivp
from touching import NORMAL, contact

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.errors import ArgumentError
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw, SpringDashpotOptions

RANGE, STIFFNESS, GAP = 0.02, 1e4, 0.005
ALONG = np.array([[-0.8, 0.6]])


def law(**options: float) -> SpringDashpotLaw:
    return SpringDashpotLaw(SpringDashpotOptions(stiffness=STIFFNESS, **options), RANGE)


def push(law: SpringDashpotLaw, velocity: FloatArray, mass: float = 1.0) -> FloatArray:
    return law.damping(contact(GAP), Motion(velocity, np.array([mass])))


def speed_after(law: SpringDashpotLaw, mass: float, speed: float) -> float:
    """Of a dry head-on impact, from the integrated equation of motion."""

    def rate(_: float, state: FloatArray) -> list[float]:
        touching = contact(state[0])
        force = law.force(touching) + law.damping(touching, Motion(state[1] * NORMAL, np.array([mass])))
        return [state[1], float(force[0] @ NORMAL[0]) / mass]

    def parted(_: float, state: FloatArray) -> float:
        return float(state[0] - RANGE)

    parted.terminal, parted.direction = True, 1  # type: ignore[attr-defined]
    end = 10 * np.sqrt(mass / STIFFNESS)
    # from just inside, as the dashpot does not act outside
    start = [RANGE * (1 - 1e-12), -speed]
    found = solve_ivp(rate, (0, end), start, method="DOP853", rtol=1e-11, atol=1e-14, events=parted)
    return float(found.y_events[0][0, 1])


@pytest.mark.parametrize("restitution", [0.05, 0.5, 0.9, 1.0])
@pytest.mark.parametrize(("mass", "speed"), [(1.0, 1.0), (1e-3, 0.1), (40.0, 0.03)])
def test_impact_ends_with_the_restitution_asked_for(restitution: float, mass: float, speed: float) -> None:
    assert speed_after(law(restitution=restitution), mass, speed) == pytest.approx(restitution * speed, rel=1e-7)


def test_the_given_coefficient_is_taken() -> None:
    np.testing.assert_allclose(push(law(damping=7.0), 3.0 * NORMAL, mass=5.0), -21.0 * NORMAL)


def test_without_a_dashpot_nothing_is_taken_out() -> None:
    assert not push(law(friction=0.5), NORMAL + ALONG).any()


def test_friction_is_viscous_where_it_is_slow_and_coulomb_where_it_is_fast() -> None:
    rough = law(damping=7.0, friction=0.3, tangential_damping=0.5)
    np.testing.assert_allclose(push(rough, 2.0 * ALONG), -0.5 * 7.0 * 2.0 * ALONG)
    np.testing.assert_allclose(push(rough, 1e6 * ALONG), -0.3 * STIFFNESS * (RANGE - GAP) * ALONG)


@pytest.mark.parametrize("approach", [-2.0, 2.0, 200.0])
def test_friction_is_limited_by_the_whole_normal_force(approach: float) -> None:
    rough = law(damping=7.0, friction=0.3)
    pressing = abs(STIFFNESS * (RANGE - GAP) - 7.0 * approach)
    expected = -7.0 * approach * NORMAL - 0.3 * pressing * ALONG
    np.testing.assert_allclose(push(rough, approach * NORMAL + 1e6 * ALONG), expected)


def test_springs_along_the_surfaces_are_shortened_onto_the_cone() -> None:
    sticking = law(damping=7.0, friction=0.3, tangential_damping=0.5, tangential_stiffness=2e3)
    motion = Motion(2.0 * ALONG, np.array([1.0]))
    most, damped = 0.3 * STIFFNESS * (RANGE - GAP), 0.5 * 7.0 * 2.0 * ALONG
    np.testing.assert_array_equal(sticking.held_displacement(contact(GAP), motion, 0.01 * ALONG), 0.01 * ALONG)
    for displacement in (0.1 * ALONG, -0.1 * ALONG):
        held = sticking.held_displacement(contact(GAP), motion, displacement)
        np.testing.assert_allclose(2e3 * held + damped, np.sign(displacement @ ALONG.T) * most * ALONG)
    assert not sticking.held_displacement(contact(RANGE), motion, 0.01 * ALONG).any()


def test_in_fast_slip_a_bounded_dashpot_leaves_the_spring_relaxed_and_lammps_stretches_it_backwards() -> None:
    """Both forces are the bound; at the touch the spring of the second would have energy before there was any way."""
    motion, none = Motion(1e3 * ALONG, np.ones(1)), np.zeros((1, 2))
    bound, damped = 0.3 * STIFFNESS * (RANGE - GAP), 0.5 * 7.0 * 1e3
    for options, dashpot in (({}, bound), ({"bounded_dashpot": False}, damped)):
        slipping = law(damping=7.0, friction=0.3, tangential_damping=0.5, tangential_stiffness=2e3, **options)
        np.testing.assert_allclose(slipping.damping(contact(GAP), motion), -dashpot * ALONG)
        held = slipping.held_displacement(contact(GAP), motion, none)
        np.testing.assert_allclose(held, (bound - dashpot) / 2e3 * ALONG, atol=1e-15)


def test_springs_that_resist_turning_are_shortened_across_and_along_the_normal_by_their_own_coefficients() -> None:
    keys = {"friction": 0.3, "tangential_damping": 0.5, "tangential_stiffness": 2e3}
    rolling = law(damping=7.0, rolling_friction=0.2, twisting_friction=0.1, **keys)
    normal, across = np.array([[0.0, 0.0, 1.0]]), np.array([[0.6, 0.8, 0.0]])
    one, half = np.ones(1), np.full(1, 0.5)
    body, point = np.zeros(1, dtype=np.int64), np.zeros((1, 3))
    touching = Contacts(body, body + 1, point, point, normal, np.full(1, GAP), one, one, body > 0)
    np.testing.assert_allclose(touching.effective_radius, half)
    motion = Motion(0.0 * normal, one, 2.0 * across - 4.0 * normal)
    damping, pressing = 0.5 * 7.0 * half, STIFFNESS * (RANGE - GAP)
    np.testing.assert_allclose(rolling.couple(touching, motion), -damping * 0.5 * motion.angular_velocity)
    small = 1e-4 * (across + normal)
    np.testing.assert_allclose(rolling.held_turning(touching, motion, small), small)
    held = rolling.held_turning(touching, motion, across - normal)
    expected = pressing * (0.2 * across - 0.1 * normal) - damping * motion.angular_velocity
    np.testing.assert_allclose(2e3 * held, expected)
    free_to_twist = law(damping=7.0, rolling_friction=0.2, **keys)
    assert not free_to_twist.held_turning(touching, motion, normal)[0, 2]
    assert not free_to_twist.couple(touching, motion)[0, 2]


@pytest.mark.parametrize(
    "keys",
    [
        {"rolling_friction": 0.1},
        {"twisting_friction": 0.1, "friction": 0.5},
        {"restitution": 0.0},
        {"restitution": 1.1},
        {"damping": -1.0},
        {"friction": -0.1},
        {"restitution": 0.5, "damping": 1.0},
        {"tangential_stiffness": 0.0, "friction": 0.5},
        {"tangential_stiffness": 1.0},
        {"bounded_dashpot": False, "friction": 0.5},
    ],
)
def test_options_refuse_what_has_no_meaning(keys: dict[str, float]) -> None:
    with pytest.raises(ArgumentError):
        SpringDashpotOptions(stiffness=1.0, **keys)
