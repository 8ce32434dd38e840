"""The dry backend with the time scheme: free bodies, springs, and a ball that bounces on a wall."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipkinc

from rigidfluid.backends.dry import Dry
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.rigid import lab_inertia, rotation_matrices
from rigidfluid.core.mechanics.time_scheme import derivative_weights, extrapolation_weights, newton_euler, predict_pose
from rigidfluid.core.mechanics.wrenches import contact_wrench
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Pose, Step, Twist, Wrench
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.forces.centre import CentreLaw, CentreOptions


@dataclass(frozen=True)
class Bodies:
    mass: FloatArray
    inertia: FloatArray
    wrench: Callable[[Pose], Wrench]


def free(pose: Pose) -> Wrench:
    count, dimension = pose.position.shape
    return Wrench(np.zeros((count, dimension)), np.zeros((count, 1 if dimension == 2 else 3)))


def simulate(bodies: Bodies, pose: Pose, twist: Twist, steps: FloatArray) -> tuple[list[Pose], list[Twist]]:
    """Poses and twists at all times, oldest first."""
    poses, twists, backend = [pose], [twist], Dry(PartOptions(), None)
    previous: float | None = None
    for step in steps:
        old = twists[-2] if len(twists) > 1 else None
        new = predict_pose(poses[-1], twists[-1], old, step, previous)
        weights = derivative_weights(step, previous)
        newton = newton_euler(
            bodies.mass, bodies.inertia, new, poses[:-3:-1], twists[:-3:-1], weights, bodies.wrench(new)
        )
        advance = backend.advance({}, None, uncontrolled(step, previous, new, *newton))
        poses.append(new)
        twists.append(advance.twist)
        previous = step
    return poses, twists


def uncontrolled(step: float, previous: float | None, pose: Pose, matrix: FloatArray, load: FloatArray) -> Step:
    return Step(
        time=0.0,
        derivative=derivative_weights(step, previous),
        extrapolation=extrapolation_weights(step, previous),
        pose=pose,
        points=None,
        mass_matrix=matrix,
        load=load,
        prescribed=np.zeros(len(load), dtype=bool),
        prescribed_twist=np.zeros_like(load),
        impulse=np.zeros_like(load),
        load_scale=0.0,
        turning=np.zeros_like(load),
    )


PERIOD = 4.058734421
INERTIA = np.array([1.0, 2.0, 3.0])
SPIN = np.array([0.3, 1.0, 1.5])


def tumble(steps: FloatArray) -> tuple[list[Pose], list[Twist]]:
    bodies = Bodies(np.array([1.0]), np.diag(INERTIA)[None], free)
    return simulate(bodies, Pose(np.zeros((1, 3)), np.eye(1, 4)), Twist(np.zeros((1, 3)), SPIN[None]), steps)


def own_spin(pose: Pose, twist: Twist) -> FloatArray:
    return rotation_matrices(pose.orientation)[0].T @ twist.angular_velocity[0]


def exact_spin(time: float) -> FloatArray:
    """ω in the body's frame: (a cn, b sn, c dn), for |L|² > 2 E I₂ (Landau and Lifshitz, Mechanics, §37)."""
    twice_energy, momentum = INERTIA @ SPIN**2, np.sum((INERTIA * SPIN) ** 2)
    first, second, third = INERTIA
    high, low = twice_energy * third - momentum, momentum - twice_energy * first
    a = np.sqrt(high / (first * (third - first)))
    b = np.sqrt(high / (second * (third - second)))
    c = np.sqrt(low / (third * (third - first)))
    rate = np.sqrt((third - second) * low / INERTIA.prod())
    modulus = (second - first) * high / ((third - second) * low)
    start = ellipkinc(np.arctan2(SPIN[1] / b, SPIN[0] / a), modulus)
    sn, cn, dn, _ = ellipj(rate * time + start, modulus)
    return np.array([a * cn, b * sn, c * dn])


def test_exact_spin_has_the_known_period() -> None:
    np.testing.assert_allclose(exact_spin(0.0), SPIN, rtol=1e-14)
    np.testing.assert_allclose(exact_spin(PERIOD), SPIN, rtol=1e-8)


def tumbling_error(count: int, unevenness: float) -> float:
    steps = 1 + unevenness * (-1.0) ** np.arange(count)
    poses, twists = tumble(PERIOD * steps / steps.sum())
    return float(np.linalg.norm(own_spin(poses[-1], twists[-1]) - exact_spin(PERIOD)))


@pytest.mark.parametrize("unevenness", [0.0, 0.3], ids=["even steps", "uneven steps"])
def test_free_rotation_converges_at_second_order(unevenness: float) -> None:
    coarse, fine = tumbling_error(200, unevenness), tumbling_error(400, unevenness)
    assert fine < 5e-3
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.15)


def test_free_rotation_keeps_angular_momentum_to_rounding() -> None:
    poses, twists = tumble(PERIOD / 200 * (1 + 0.3 * np.sin(np.arange(400))))
    momenta = [
        lab_inertia(np.diag(INERTIA)[None], pose.orientation)[0] @ twist.angular_velocity[0]
        for pose, twist in zip(poses, twists, strict=True)
    ]
    np.testing.assert_allclose(momenta, np.tile(INERTIA * SPIN, (len(momenta), 1)), rtol=0, atol=1e-12)


def test_free_rotation_keeps_energy_at_second_order() -> None:
    def drift(count: int) -> float:
        poses, twists = tumble(np.full(count, PERIOD / count))
        energies = [0.5 * INERTIA @ own_spin(*state) ** 2 for state in zip(poses, twists, strict=True)]
        return float(np.ptp(energies))

    coarse, fine = drift(200), drift(400)
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.2)
    assert fine < 2e-3


def swing(relative_step: float, count: int) -> FloatArray:
    """Positions of a unit mass on a unit spring; ``relative_step`` is ωΔt."""
    bodies = Bodies(np.ones(1), np.ones((1, 1, 1)), lambda pose: Wrench(-pose.position, np.zeros((1, 1))))
    start = Pose(np.array([[1.0, 0.0]]), np.zeros((1, 1)))
    poses, _ = simulate(bodies, start, Twist(np.zeros((1, 2)), np.zeros((1, 1))), np.full(count, relative_step))
    return np.array([pose.position[0, 0] for pose in poses])


@pytest.mark.parametrize("relative_step", [0.1, 1.0, 1.9])
def test_spring_obeys_the_recurrence_of_verlet(relative_step: float) -> None:
    x = swing(relative_step, 60)
    residual = x[3:] - (2 - relative_step**2) * x[2:-1] + x[1:-2]
    np.testing.assert_allclose(residual, 0.0, rtol=0, atol=1e-12 * np.abs(x).max())


def test_spring_neither_decays_nor_grows_below_the_limit() -> None:
    x = np.abs(swing(1.95, 2000))
    assert x[-500:].max() == pytest.approx(x[3:503].max(), rel=1e-2)


def test_spring_grows_beyond_the_limit() -> None:
    x = np.abs(swing(2.05, 200))
    assert x[-1] > 1e10


RADIUS = 0.5
RANGE = 0.01
SPEED = 2.0
MASS = np.pi * RADIUS**2
DEEPEST = 0.5 * RANGE


@dataclass(frozen=True)
class Bounce:
    times: FloatArray
    gaps: FloatArray
    speeds: FloatArray
    energies: FloatArray


def bounce(steps_in_contact: int) -> Bounce:
    """A disk that flies straight onto a wall; times, gaps, speeds away from the wall, energies of the contact."""
    # the shallow estimate of the stiffness for which the disk comes to rest at DEEPEST
    epsilon = DEEPEST**3 * 2 * (2 * RADIUS + RANGE) / (3 * MASS * SPEED**2)
    ball = Sphere(SphereOptions(radius=RADIUS), 2)
    wall = Wall(1, "bottom", Plane(np.zeros(2), np.array([0.0, 1.0])))
    detector = SphereDetector(PartOptions(), [ball], [wall])
    law = CentreLaw(CentreOptions(epsilon=1.0, epsilon_wall=epsilon), RANGE)

    def contacts(pose: Pose) -> Contacts:
        return detector.detect(pose, None, np.inf)

    def wrench(pose: Pose) -> Wrench:
        return contact_wrench(contacts(pose), law.force(contacts(pose)), pose)

    step = contact_time() / steps_in_contact
    start = Pose(np.array([[3.0, RADIUS + RANGE + 3.3 * SPEED * step]]), np.zeros((1, 1)))
    bodies = Bodies(np.array([MASS]), MASS * ball.unit_inertia[None], wrench)
    steps = np.full(int(1.2 * steps_in_contact) + 10, step)
    poses, twists = simulate(bodies, start, Twist(np.array([[0.0, -SPEED]]), np.zeros((1, 1))), steps)
    gaps = np.array([contacts(pose).gap[0] for pose in poses])
    energies = np.array([law.energy(contacts(pose))[0] for pose in poses])
    return Bounce(step * np.arange(len(poses)), gaps, np.array([twist.velocity[0, 1] for twist in twists]), energies)


def contact_time() -> float:
    """The shallow limit of the centre law."""
    return 2.80436 * DEEPEST / SPEED


def test_dry_bounce_gives_all_speed_back() -> None:
    defects = [abs(bounce(count).speeds[-1] / SPEED - 1) for count in (100, 200, 400)]
    assert defects[-1] < 1e-7
    assert np.log2(defects[0] / defects[-1]) / 2 > 1.8


def test_dry_bounce_stores_the_kinetic_energy() -> None:
    found = bounce(400)
    assert found.energies.max() == pytest.approx(0.5 * MASS * SPEED**2, rel=1e-3)
    assert found.gaps.min() == pytest.approx(RANGE - DEEPEST, rel=5e-3)


def test_dry_bounce_takes_the_known_time() -> None:
    found = bounce(400)
    inside = found.gaps < RANGE
    enter, leave = np.argmax(inside), len(inside) - np.argmax(inside[::-1])
    times = [
        np.interp(RANGE, found.gaps[[enter, enter - 1]], found.times[[enter, enter - 1]]),
        np.interp(RANGE, found.gaps[[leave - 1, leave]], found.times[[leave - 1, leave]]),
    ]
    assert times[1] - times[0] == pytest.approx(contact_time(), rel=5e-3)


def test_prescribed_bodies_take_the_given_twist() -> None:
    pose = Pose(np.zeros((2, 2)), np.zeros((2, 1)))
    step = Step(
        time=0.0,
        derivative=derivative_weights(0.1, None),
        extrapolation=extrapolation_weights(0.1, None),
        pose=pose,
        points=None,
        mass_matrix=np.stack([np.zeros((3, 3)), 2 * np.eye(3)]),
        load=np.array([[9.0, 9.0, 9.0], [2.0, 4.0, 6.0]]),
        prescribed=np.array([True, False]),
        prescribed_twist=np.array([[7.0, 8.0, 9.0], [0.0, 0.0, 0.0]]),
        impulse=np.zeros((2, 3)),
        load_scale=0.0,
        turning=np.zeros((2, 3)),
    )
    advance = Dry(PartOptions(), None).advance({}, None, step)
    np.testing.assert_allclose(advance.twist.velocity, [[7.0, 8.0], [1.0, 2.0]])
    np.testing.assert_allclose(advance.twist.angular_velocity, [[9.0], [3.0]])
    assert not advance.hydrodynamic_wrench.force.any()
    assert advance.hydrodynamic_wrench.torque.shape == (2, 1)


def test_bodies_respond_to_impulses_with_their_own_mass():
    matrix = np.stack([3.0 * np.diag([2.0, 2.0, 0.5]), np.eye(3)])
    pose = Pose(np.zeros((2, 2)), np.zeros((2, 1)))
    step = replace(uncontrolled(1.0, None, pose, matrix, np.zeros((2, 3))), prescribed=np.array([False, True]))
    impulses = np.array([[[6.0, 0.0, 1.5], [1.0, 1.0, 1.0]]])
    mesh: Any = None
    response = Dry(PartOptions(), None).response(
        {}, mesh, replace(step, derivative=np.array([3.0, -3.0, 0.0])), impulses
    )
    np.testing.assert_allclose(response.inviscid, [[[3.0, 0.0, 3.0], [0.0, 0.0, 0.0]]])
    np.testing.assert_array_equal(response.viscous, response.inviscid)
