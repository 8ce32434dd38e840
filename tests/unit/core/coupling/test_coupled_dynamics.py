"""Bodies between two solutions of the fluid: mass and friction exactly, whatever the substeps."""

import numpy as np
import pytest
from scipy.linalg import expm

from rigidfluid.core.coupling import coupled_dynamics
from rigidfluid.core.coupling.coupled_dynamics import CoupledDynamics
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.reduced_model import Coupling, Evaluation, ReducedModel, reduced_model
from rigidfluid.core.model.types import Pose, Twist, Wrench

BODIES, WIDTH = 3, 3
INSIDE = np.array([0, 1, 2, 6, 7])
"""All of the first body's velocities, the last one's but its turning; the second is not in the model."""

RNG = np.random.default_rng(6)
START = Pose(RNG.normal(size=(BODIES, 2)), RNG.normal(size=(BODIES, 1)))
TWIST = Twist(RNG.normal(size=(BODIES, 2)), RNG.normal(size=(BODIES, 1)))
RATE = RNG.normal(size=(BODIES, WIDTH))
LOAD = RNG.normal(size=len(INSIDE))
WRENCH = Wrench(RNG.normal(size=(BODIES, 2)), RNG.normal(size=(BODIES, 1)))
LINEAR, ANGULAR = np.array([0.5, 0.25, 2.0])[:, None, None] * np.eye(2), np.array([[[3.0]], [[4.0]], [[5.0]]])


def positive(seed: int, count: int = len(INSIDE)) -> FloatArray:
    root = np.random.default_rng(seed).normal(size=(count, count))
    return root @ root.T + 0.5 * np.eye(count)


MASS, FRICTION = positive(11), 30.0 * positive(12)


def model_of(mass: FloatArray, friction: FloatArray, velocities: IntArray = INSIDE) -> ReducedModel:
    inviscid, viscous = np.linalg.inv(mass), np.linalg.inv(mass + friction)
    return reduced_model(velocities, inviscid, viscous, 1.0, Evaluation(*np.ones((2, len(mass)))), False)


def coupling_of(model: ReducedModel, load: FloatArray, before: FloatArray | None = None) -> Coupling:
    unknown = np.full(len(load), np.nan)
    return Coupling(model, load, unknown if before is None else before, np.zeros(len(load)))


def dynamics(friction: FloatArray = FRICTION, load: FloatArray = LOAD, twist: Twist = TWIST) -> CoupledDynamics:
    return CoupledDynamics(START, twist, RATE, LINEAR, ANGULAR, coupling_of(model_of(MASS, friction), load))


def joined(twist: Twist) -> FloatArray:
    return np.concatenate([twist.velocity, twist.angular_velocity], axis=1)


def flat_wrench() -> FloatArray:
    return np.concatenate([WRENCH.force, WRENCH.torque], axis=1).ravel()


def moved(bodies: CoupledDynamics, time: float, substeps: int) -> CoupledDynamics:
    """By constant forces for so long, in so many kicks before and after a drift."""
    part = time / substeps
    for _ in range(substeps):
        bodies.kick(WRENCH, 0.5 * part)
        bodies.drift(part)
        bodies.kick(WRENCH, 0.5 * part)
    return bodies


@pytest.mark.parametrize("substeps", [1, 7])
def test_without_friction_newton(substeps):
    bodies, time = moved(dynamics(np.zeros_like(MASS)), 0.3, substeps), 0.3
    gained = np.linalg.solve(MASS, LOAD + flat_wrench()[INSIDE]) * time
    start, end = joined(TWIST).ravel()[INSIDE], joined(bodies.twist).ravel()[INSIDE]
    np.testing.assert_allclose(end, start + gained, rtol=1e-9)
    shift = time * (start + 0.5 * gained)
    np.testing.assert_allclose(bodies.pose.position[0], START.position[0] + shift[:2], rtol=1e-9)
    np.testing.assert_allclose(bodies.pose.position[2], START.position[2] + shift[3:], rtol=1e-9)
    np.testing.assert_allclose(bodies.pose.orientation[0], START.orientation[0] + shift[2], rtol=1e-9)


@pytest.mark.parametrize("time", [1e-3, 0.05, 10.0])
@pytest.mark.parametrize("substeps", [1, 13])
def test_with_friction_as_the_exponential_says(time, substeps):
    """U(t) = U₀ + (1 - e^(-M⁻¹R t)) R⁻¹ (Φ + F)."""
    end = joined(moved(dynamics(), time, substeps).twist).ravel()[INSIDE]
    limit = np.linalg.solve(FRICTION, LOAD + flat_wrench()[INSIDE])
    gained = limit - expm(-time * np.linalg.solve(MASS, FRICTION)) @ limit
    np.testing.assert_allclose(end - joined(TWIST).ravel()[INSIDE], gained, rtol=1e-8, atol=1e-11)


def resisted(load_before: FloatArray) -> CoupledDynamics:
    """A fluid without inertia, whose Φ grows from ``load_before``."""
    coupling = coupling_of(model_of(MASS, FRICTION), LOAD, load_before)
    return CoupledDynamics(START, TWIST, RATE, LINEAR, ANGULAR, coupling, weight=WEIGHT)


WEIGHT = RNG.normal(size=len(INSIDE))
ALL = np.ones((BODIES, WIDTH), dtype=bool)


def test_without_inertia_of_the_fluid_all_friction_is_known():
    """∫ (W - Φ + R (U - Uⁿ))·U dt = W·Δx + ∫ F·U dt - Δ(½ UᵀMU), less what Simpson's rule sees."""
    before, time, parts = 0.5 * LOAD, 0.3, 4000
    bodies = resisted(before)
    bodies.vary_load(time, ALL)
    start, pushed, path = joined(TWIST).ravel()[INSIDE], flat_wrench()[INSIDE], 0.0
    for _ in range(parts):
        bodies.kick(WRENCH, 0.5 * time / parts)
        middle = joined(bodies.twist).ravel()[INSIDE]
        bodies.drift(time / parts)
        bodies.kick(WRENCH, 0.5 * time / parts)
        path += (WEIGHT + pushed) @ middle * time / parts
    end = joined(bodies.twist).ravel()[INSIDE]
    path -= 0.5 * (end @ MASS @ end - start @ MASS @ start)
    first, last = WEIGHT - before, WEIGHT - LOAD + FRICTION @ (end - start)
    seen = first @ start + (first + last) @ (start + end) + last @ end
    assert bodies.friction_loss == pytest.approx(path - time * seen / 6.0, rel=1e-5)


@pytest.mark.parametrize("time", [1e-4, 0.02, 5.0])
def test_without_inertia_of_the_fluid_friction_bounds_what_a_pull_adds(time):
    """|Φ|/λ at the end; a pull that nothing ends would go on for ever."""
    bodies = resisted(LOAD)
    bound = time * bodies.max_acceleration(time)
    bodies.kick(Wrench(np.zeros((BODIES, 2)), np.zeros((BODIES, 1))), time)
    gained = np.linalg.norm(joined(bodies.twist)[:, :2] - joined(TWIST)[:, :2], axis=1)
    assert (gained <= bound * (1.0 + 1e-12)).all()
    assert bound[0] <= 3.0 * np.linalg.norm(np.linalg.solve(FRICTION, LOAD)) or time < 0.1


@pytest.mark.parametrize("factor", [0.0, 1.0, 1e12])
def test_rest_is_kept_to_rounding(factor):
    load = -flat_wrench()[INSIDE]
    bodies = moved(dynamics(factor * FRICTION, load, Twist(np.zeros((3, 2)), np.zeros((3, 1)))), 1.0, 50)
    np.testing.assert_allclose(joined(bodies.twist).ravel()[INSIDE], 0.0, atol=1e-13)


@pytest.mark.parametrize("time", [1e-4, 0.02, 5.0])
def test_the_mean_response_is_what_a_kick_adds(time):
    with_wrench, without = dynamics(), dynamics()
    with_wrench.kick(WRENCH, time)
    without.kick(Wrench(np.zeros((BODIES, 2)), np.zeros((BODIES, 1))), time)
    added = (joined(with_wrench.twist) - joined(without.twist)).ravel()
    np.testing.assert_allclose(dynamics().inverse_masses(time) @ flat_wrench() * time, added, rtol=1e-9, atol=1e-12)


def test_outside_the_model_bodies_have_their_own_mass_and_rate():
    end = joined(moved(dynamics(), 0.2, 5).twist)
    own = np.concatenate([LINEAR[1] @ WRENCH.force[1], ANGULAR[1] @ WRENCH.torque[1]])
    np.testing.assert_allclose(end[1], joined(TWIST)[1] + 0.2 * (RATE[1] + own), rtol=1e-12)
    turning = joined(TWIST)[2, 2] + 0.2 * (RATE[2, 2] + 5.0 * WRENCH.torque[2, 0])
    assert end[2, 2] == pytest.approx(turning, rel=1e-12)


def test_the_inverse_mass_of_one_body_is_its_block():
    bodies, inverse = dynamics(), np.linalg.inv(MASS)
    np.testing.assert_allclose(bodies.inverse_mass[0], inverse[:2, :2], rtol=1e-10)
    np.testing.assert_allclose(bodies.inverse_mass[1], LINEAR[1])
    np.testing.assert_allclose(bodies.inverse_mass[2], inverse[3:, 3:], rtol=1e-10)
    np.testing.assert_allclose(bodies.inverse_inertia[:, 0, 0], [inverse[2, 2], 4.0, 5.0], rtol=1e-10)
    along = np.array([[0.6, 0.8]])
    expected = along[0] @ inverse[:2, :2] @ along[0]
    assert bodies.inverse_mass_along(np.array([0]), along)[0] == pytest.approx(expected, rel=1e-10)


def test_forces_do_not_move_driven_bodies():
    none = np.zeros_like(RATE)
    model = model_of(MASS[3:, 3:], FRICTION[3:, 3:], INSIDE[3:])
    linear, angular = LINEAR.copy(), ANGULAR.copy()
    linear[0], angular[0] = 0.0, 0.0
    bodies = CoupledDynamics(START, TWIST, none, linear, angular, coupling_of(model, LOAD[3:]))
    moved(bodies, 0.4, 6)
    np.testing.assert_array_equal(joined(bodies.twist)[0], joined(TWIST)[0])
    np.testing.assert_allclose(bodies.pose.position[0], START.position[0] + 0.4 * TWIST.velocity[0], rtol=1e-12)
    assert bodies.inverse_masses(0.1)[:3].count_nonzero() == 0
    assert np.any(joined(bodies.twist)[1] != joined(TWIST)[1])


def test_a_copy_goes_its_own_way():
    bodies = moved(dynamics(), 0.1, 3)
    before = bodies.friction_loss, joined(bodies.twist), bodies.pose.position
    moved(bodies.copied(), 0.2, 4)
    assert bodies.friction_loss == before[0]
    np.testing.assert_array_equal(joined(bodies.twist), before[1])
    np.testing.assert_array_equal(bodies.pose.position, before[2])


ONE = ReducedModel(np.array([0]), np.array([[0.5]]), np.array([8.0]), Evaluation(np.ones(1), np.ones(1)), False)
"""Of mass 4, friction 32."""


def one_body() -> CoupledDynamics:
    still = Twist(np.zeros((1, 2)), np.zeros((1, 1)))
    pose = Pose(np.zeros((1, 2)), np.zeros((1, 1)))
    zero = np.zeros((1, 3))
    return CoupledDynamics(pose, still, zero, np.zeros((1, 2, 2)), np.zeros((1, 1, 1)), coupling_of(ONE, np.zeros(1)))


def pushed(bodies: CoupledDynamics, forces: FloatArray, part: float) -> FloatArray:
    """Kick and drift by each of the forces along x; the velocities while drifting."""
    speeds = []
    for force in forces:
        wrench = Wrench(np.array([[force, 0.0]]), np.zeros((1, 1)))
        bodies.kick(wrench, 0.5 * part)
        bodies.drift(part)
        speeds.append(bodies.twist.velocity[0, 0])
        bodies.kick(wrench, 0.5 * part)
    return np.array(speeds)


def test_what_is_linear_in_time_the_solutions_see():
    """F = 4a + 32a t makes U = a t, whose friction 32 ∫ U² dt the fluid's own solutions see."""
    count, total, speedup = 1000, 0.5, 3.0
    middle = (np.arange(count) + 0.5) * total / count
    bodies = one_body()
    speeds = pushed(bodies, speedup * (4.0 + 32.0 * middle), total / count)
    np.testing.assert_allclose(speeds, speedup * middle, rtol=1e-4, atol=1e-5)
    all_friction = 32.0 * (speedup * total) ** 2 * total / 3.0
    assert abs(bodies.friction_loss) < 1e-6 * all_friction


def test_drag_left_out_is_that_of_the_change_of_velocities():
    """Δt/6 R ΔU² of one body with R = 32, at the end of the last kick."""
    total, bodies = 0.5, one_body()
    drifting = pushed(bodies, np.array([70.0, -20.0, 50.0]), total / 3.0)
    end = bodies.twist.velocity[0, 0]
    assert abs(end - drifting[-1]) > 0.1
    assert bodies.drag_left_out == pytest.approx(total / 6.0 * 32.0 * end**2, rel=1e-9)


def test_friction_of_a_jump_beyond_a_linear_velocity():
    """A blow in the middle: U is zero, then decays; against 32 ∫ (U - U_end t/T)² dt."""
    count, total, blow = 2000, 0.5, 6.0
    part = total / count
    forces = np.zeros(count)
    forces[count // 2] = blow / part
    bodies = one_body()
    pushed(bodies, forces, part)
    times = (np.arange(200_000) + 0.5) * total / 200_000
    speed = np.where(times > 0.5 * total, blow / 4.0 * np.exp(-8.0 * (times - 0.5 * total)), 0.0)
    end = blow / 4.0 * np.exp(-4.0 * total)
    expected = 32.0 * np.mean((speed - end * times / total) ** 2) * total
    assert bodies.friction_loss == pytest.approx(expected, rel=2e-3)


def test_a_load_that_varies_gives_the_mean_of_its_ends_and_one_that_was_not_known_stays():
    before = np.where(np.arange(len(LOAD)) == 1, np.nan, -LOAD)
    coupling = coupling_of(model_of(MASS, 0.0 * FRICTION), LOAD, before)
    bodies = CoupledDynamics(START, TWIST, RATE, LINEAR, ANGULAR, coupling)
    bodies.vary_load(0.2, ALL)
    for _ in range(4):
        bodies.kick(Wrench(0.0 * WRENCH.force, 0.0 * WRENCH.torque), 0.05)
    gained = (joined(bodies.twist) - joined(TWIST)).ravel()[INSIDE]
    mean = np.where(np.isnan(before), LOAD, 0.5 * (LOAD + before))
    np.testing.assert_allclose(gained, 0.2 * np.linalg.solve(MASS, mean), rtol=1e-10)


def test_components_that_do_not_vary_are_constant():
    coupling = coupling_of(model_of(MASS, 0.0 * FRICTION), LOAD, -LOAD)
    bodies = CoupledDynamics(START, TWIST, RATE, LINEAR, ANGULAR, coupling)
    varying = np.zeros((BODIES, WIDTH), dtype=bool)
    varying.flat[INSIDE[1]] = True
    bodies.vary_load(0.2, varying)
    bodies.kick(Wrench(0.0 * WRENCH.force, 0.0 * WRENCH.torque), 0.2)
    gained = (joined(bodies.twist) - joined(TWIST)).ravel()[INSIDE]
    mean = np.where(np.arange(len(LOAD)) == 1, 0.0, LOAD)
    np.testing.assert_allclose(gained, 0.2 * np.linalg.solve(MASS, mean), rtol=1e-10)


@pytest.mark.parametrize("time", [1e-3, 0.3, 500.0])
def test_a_growing_load_is_followed_exactly_in_any_number_of_kicks(time):
    once, often = resisted(-0.5 * LOAD), resisted(-0.5 * LOAD)
    for bodies, parts in ((once, 1), (often, 40)):
        bodies.vary_load(time, ALL)
        moved(bodies, time, parts)
    np.testing.assert_allclose(joined(once.twist), joined(often.twist), rtol=1e-9)


def test_kicks_of_other_lengths_have_other_factors():
    bodies, once = resisted(-0.5 * LOAD), resisted(-0.5 * LOAD)
    once.vary_load(0.3, ALL)
    bodies.vary_load(0.3, ALL)
    once.kick(WRENCH, 0.3)
    for time in (0.05, 0.05, 0.15, 0.05):
        bodies.kick(WRENCH, time)
    np.testing.assert_allclose(joined(bodies.twist), joined(once.twist), rtol=1e-9)


def test_kicks_as_long_as_the_one_before_evaluate_no_exponential(monkeypatch):
    asked = []
    growing = coupled_dynamics._growing_phi
    monkeypatch.setattr(coupled_dynamics, "_growing_phi", lambda decay: asked.append(1) or growing(decay))
    moved(dynamics(), 0.2, 5)
    assert len(asked) == 2  # one by the start


def test_the_response_to_an_impulse_at_once_is_that_of_the_masses_alone():
    bodies = dynamics()
    impulse = flat_wrench().reshape(BODIES, WIDTH)
    expected = joined(bodies.twist).ravel() + bodies.inverse_masses(0.0) @ impulse.ravel()
    bodies.apply_impulse(impulse)
    np.testing.assert_allclose(joined(bodies.twist).ravel(), expected, rtol=1e-12)
    pushed, kicked = bodies, dynamics()
    kicked.kick(Wrench(1e8 * WRENCH.force, 1e8 * WRENCH.torque), 1e-8)
    for each in (pushed, kicked):
        each.kick(Wrench(0.0 * WRENCH.force, 0.0 * WRENCH.torque), 0.3)
    np.testing.assert_allclose(joined(pushed.twist), joined(kicked.twist), rtol=1e-5)
