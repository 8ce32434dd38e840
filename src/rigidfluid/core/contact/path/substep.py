"""Length of the substeps that resolve contacts."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, log2
from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.laws.ball_law import ball_law
from rigidfluid.core.contact.laws.stiffness import (
    contacts_on_the_way,
    greatest_of_each,
    greatest_stiffness,
    repeated,
)
from rigidfluid.core.contact.path.delassus import delassus
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.wall import WallVelocities
from rigidfluid.core.mechanics.matrices import full
from rigidfluid.core.model.contacts import middle, normal_part, select, sides, tangential_part, turning_radius
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.pair_formula import common_formula, compiled
from rigidfluid.core.model.part_results import refuse_no_number
from rigidfluid.core.model.types import Contacts, Motion, Pose, Twist

RESOLUTION = 0.1
"""Substep times the highest contact frequency: some sixty substeps in a period."""

JUST_IN = 0.999
"""Gap over the range of a contact that is just in range."""

FADED = 8.0
"""Bound of the frequency of parting balls, over the highest that is still to come."""

_HALVINGS = 30

_SPEEDS = 1.0, 2.0**-80
"""Speeds at which dampers are evaluated for their coefficient: some are steepest at rest; a power of two costs no
digit."""


class Reach(NamedTuple):
    """Distance ``arms`` (n,) of the farthest surface point of each body from its centre of mass [length], and
    ``rotational_factor`` (n,) there [1], see `largest_rotational_factor`; zero for balls, which turn in their place."""

    arms: FloatArray
    rotational_factor: FloatArray


class Plan(NamedTuple):
    """Time ``free_flight`` in which nothing can touch, and the ``substep`` that resolves the contacts from then on
    [time]."""

    free_flight: float
    substep: float


def plan(
    law: ForceLaw,
    contacts: Contacts,
    dynamics: BodyDynamics,
    reach: Reach,
    size: float,
    span: float,
    quasi_steady: bool = False,
) -> Plan:
    """Plan of the next ``span``, of a step ``size`` [time]: h ω ≤ 0.1 with ω the highest frequency that the contacts
    can reach with the energy they have.

    ω is neither the present frequency nor does it depend on whether contacts close or open: the estimate of their
    energy is constant through a collision, and so is h, also where each of many steps plans again. Substeps of equal
    length keep the energy; each change costs some. h is the step halved a whole number of times, so that other bodies
    seldom change it. A body that is no ball may hit with its fastest point, wherever its nearest one is now.

    ``contacts`` are all that may come into range in the span, of which those of sign -1 only take stiffness away;
    ``quasi_steady``: whether the fluid has no inertia. Friction may then leave contacts no time to swing, and h is a
    tenth of their relaxation time.
    """
    contacts = select(contacts, contacts.sign > 0.0)
    if len(contacts) == 0:
        return Plan(span, span)
    acceleration = _pair_values(dynamics.max_acceleration(span), contacts).sum(axis=1)
    approach = _approach(law, contacts, dynamics, reach)
    speed = approach.fastest + span * acceleration
    first = np.maximum(contacts.gap - law.range, 0.0) / np.maximum(speed, np.finfo(float).tiny)
    if quasi_steady:
        push = _creep(contacts, dynamics, reach, size)
    else:
        push = _Push(relative_motion(contacts, dynamics).mass * acceleration, None)
    halvings = log2(max(size / _resolved(law, contacts, dynamics, approach, push), 1.0))
    substep = size / 2.0 ** ceil(halvings)
    free_flight = min(float(first.min()), span)
    return Plan(free_flight if free_flight > substep else 0.0, substep)


class _Approach(NamedTuple):
    """Approach in the m contacts: ``fastest``, a bound of the closing speed of any two points [length/time]; the
    ``energy`` of the approach; ``inverse`` (m, 2): bounds of 1/m_a and 1/m_b where the contact may wander [1/mass];
    ``parting``: whether two balls in range part."""

    fastest: FloatArray
    energy: FloatArray
    inverse: FloatArray
    parting: BoolArray


def _approach(law: ForceLaw, contacts: Contacts, dynamics: BodyDynamics, reach: Reach) -> _Approach:
    """Approach in each contact: normals of balls turn with the line of centres; those of other shapes may turn
    anywhere."""
    twist, arm = dynamics.twist, _pair_values(reach.arms, contacts)
    spin = _pair_values(reach.arms * np.linalg.norm(twist.angular_velocity, axis=1), contacts)
    velocity = _relative(twist.velocity, contacts)
    opening = normal_part(velocity, contacts)
    inside, tumbling = law.range - contacts.gap, np.asarray(arm.any(axis=1))
    energy = _radial_energy(contacts, dynamics, velocity, opening, inside)
    if tumbling.any():
        energy[tumbling] = _tumbling_energy(select(contacts, tumbling), dynamics, velocity[tumbling], reach)
    inverse = _inverse_masses(contacts, dynamics) * (1.0 + _pair_values(reach.rotational_factor, contacts))
    fastest = np.linalg.norm(velocity, axis=1) + spin.sum(axis=1)
    return _Approach(fastest, energy, inverse, ~tumbling & (inside > 0.0) & (opening > 0.0))


def _radial_energy(
    contacts: Contacts, dynamics: BodyDynamics, velocity: FloatArray, opening: FloatArray, inside: FloatArray
) -> FloatArray:
    """Energy of approach of two balls m/2 [v_n² + v_t² (1 - r²/r₀²)], (m,), r apart and r₀ where the range begins
    [energy].

    The sum with the energy of the contact is constant while they touch, as v_t r is. Balls out of range that part have
    none.
    """
    mass = relative_motion(contacts, dynamics).mass
    centres = _relative(dynamics.pose.position, contacts)
    distance = np.linalg.norm(centres if contacts.shift is None else centres - contacts.shift, axis=1)
    on_body = contacts.body_b < len(dynamics.pose.position)
    turned = np.where(on_body, 1.0 - (distance / (distance + inside)) ** 2, 0.0)
    sliding = np.sum(velocity**2, axis=1) - opening**2
    square = np.where(inside > 0.0, opening**2 + sliding * turned, np.minimum(opening, 0.0) ** 2)
    return np.asarray(0.5 * mass * square)


def _tumbling_energy(contacts: Contacts, dynamics: BodyDynamics, velocity: FloatArray, reach: Reach) -> FloatArray:
    """Energy (m,) of all mass at the greatest speed that the kinetic energy can give to a point of a free body
    [energy].

    Kinetic energy is that relative to each other, with bodies as heavy as in their heaviest direction. A prescribed
    body is not stopped; so its fastest point counts.
    """
    arms, spin, inverse = reach.arms, dynamics.twist.angular_velocity, dynamics.inverse_inertia
    free, turning = inverse.any(axis=(1, 2)), np.zeros(len(arms))
    own = free & (arms > 0.0)
    turning[own] = 0.5 * np.einsum("ni,nij,nj->n", spin[own], np.linalg.inv(inverse[own]), spin[own])
    driven = np.where(free, 0.0, arms * np.linalg.norm(spin, axis=1))
    speed = np.linalg.norm(velocity, axis=1) + _pair_values(driven, contacts).sum(axis=1)
    lightness: FloatArray = np.asarray(np.linalg.eigvalsh(dynamics.inverse_mass)[:, 0], dtype=np.float64)
    mass = _reciprocal(_pair_values(lightness, contacts).sum(axis=1))
    kinetic = 0.5 * mass * speed**2 + _pair_values(turning, contacts).sum(axis=1)
    return np.asarray((1.0 + _pair_values(reach.rotational_factor, contacts).max(axis=1)) * kinetic)


class _Push(NamedTuple):
    """Resultant ``force`` (m,) in each contact of all but contacts [force]; ``rates`` (m, m), in a fluid without
    inertia alone: absolute rates of the gaps by forces that last for a step [speed/force]."""

    force: FloatArray
    rates: FloatArray | None


def _creep(contacts: Contacts, dynamics: BodyDynamics, reach: Reach, size: float) -> _Push:
    rates = np.abs(size * full(delassus(contacts, dynamics, size)))
    gained = size * _pair_values(dynamics.max_acceleration(size), contacts).sum(axis=1)
    wandering = 1.0 + _pair_values(reach.rotational_factor, contacts).max(axis=1)
    return _Push(gained * _reciprocal(rates.diagonal()), rates * wandering)


def _resolved(law: ForceLaw, contacts: Contacts, dynamics: BodyDynamics, approach: _Approach, push: _Push) -> float:
    """Substep 0.1/ω with ω² ≤ Σ k/m over all contacts of either body, k the greatest stiffness within reach [time], and
    Σ k/m of springs along the surfaces besides.

    Without inertia of the fluid it is a tenth of the contacts' relaxation time, if that is longer: h k φ₁(λh) h/m ≤ 0.1
    then, with decay rates λ, and Verlet's method with exact decay is stable up to 2.
    """
    motion = relative_motion(contacts, dynamics)
    stiffness, damping = _reached(law, contacts, motion, approach, push.force)
    inverse = approach.inverse
    square = _highest_sum(stiffness, contacts, inverse)
    if law.sticking:
        square += _tangential_sum(law, contacts, dynamics, inverse)
    swing = np.sqrt(square)
    if push.rates is not None and not law.sticking:
        swing = min(swing, float((push.rates @ stiffness).max()))
    rate = max(swing, _highest_sum(damping, contacts, inverse))
    if law.couples:
        rate = max(rate, _turning_rate(law, contacts, dynamics, approach, push.force))
    refuse_no_number("contacts", "stiffness or damping", rate, "contact.law")
    return RESOLUTION / rate if rate > 0 else np.inf


def _tangential_sum(law: ForceLaw, contacts: Contacts, dynamics: BodyDynamics, inverse: FloatArray) -> float:
    """Bound of Σ k/m of springs along the surfaces of all contacts of either body, which turn the bodies too
    [1/time²]."""
    touching = [replace(contacts, gap=np.minimum(contacts.gap, JUST_IN * begin)) for begin in law.ranges]
    stiffness = np.max([law.tangential_stiffness(there) for there in touching], axis=0)
    square = _square_arms(contacts, dynamics)
    if law.rolling:
        square += turning_radius(contacts) ** 2
    turning = square * _lightest(contacts, dynamics)
    return _highest_sum(stiffness, contacts, inverse + turning)


def _turning_rate(
    law: ForceLaw, contacts: Contacts, dynamics: BodyDynamics, approach: _Approach, force: FloatArray
) -> float:
    """Bound of the rate at which dampers along the surfaces and couples slow bodies down [1/time].

    Their power S v² + 2 Q v w + W w², which is never negative, is at most 2 (S v² + W w²).
    """
    deepest = _deepest(law, contacts, approach.energy + law.energy(contacts), force)
    axes, turning = np.eye(contacts.normal.shape[1]), np.eye(dynamics.twist.angular_velocity.shape[1])
    mass, (sliding, rolling) = relative_motion(contacts, dynamics).mass, np.zeros((2, len(contacts)))
    for there in contacts_on_the_way(law, contacts, deepest):
        tried, speed, axis = _tried(there, axes)
        motion = Motion(speed[:, None] * tangential_part(axis, tried), np.resize(mass, len(tried)))
        sliding = np.maximum(sliding, greatest_of_each(_size(law.damping(tried, motion)) / speed, len(contacts)))
        tried, speed, axis = _tried(there, turning)
        motion = Motion(np.zeros_like(tried.normal), np.resize(mass, len(tried)), speed[:, None] * axis)
        rolling = np.maximum(rolling, greatest_of_each(_size(law.couple(tried, motion)) / speed, len(contacts)))
    lightest = _lightest(contacts, dynamics)
    moving = _inverse_masses(contacts, dynamics) + _square_arms(contacts, dynamics) * lightest
    return 2.0 * (_highest_sum(sliding, contacts, moving) + _highest_sum(rolling, contacts, lightest))


def _tried(contacts: Contacts, axes: FloatArray) -> tuple[Contacts, FloatArray, FloatArray]:
    """Contacts, once for each of the speeds at which dampers are evaluated and each of the ``axes`` (c, k); that speed
    of each (m,) and that axis (m, k)."""
    tried = repeated(contacts, len(_SPEEDS) * len(axes))
    each = np.repeat(axes, len(contacts), axis=0)
    return tried, np.repeat(_SPEEDS, len(each)), np.tile(each, (len(_SPEEDS), 1))


def _size(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _square_arms(contacts: Contacts, dynamics: BodyDynamics) -> FloatArray:
    """Squares of the distances from the centres of a and of b to the contact, (m, 2), zero for walls [length²]."""
    square = np.zeros((len(contacts), 2))
    for side, (body, point) in enumerate(sides(contacts)):
        on_body = body < len(dynamics.pose.position)
        arm = point[on_body] - dynamics.pose.position[body[on_body]]
        square[on_body, side] = np.sum(arm**2, axis=1)
    return square


def _lightest(contacts: Contacts, dynamics: BodyDynamics) -> FloatArray:
    """Greatest inverse moments of inertia of a and of b, (m, 2), zero for walls [1/(mass·length²)]."""
    return _pair_values(np.asarray(np.linalg.eigvalsh(dynamics.inverse_inertia)[:, -1]), contacts)


def _reached(
    law: ForceLaw, contacts: Contacts, motion: Motion, approach: _Approach, force: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Greatest stiffness and damping coefficient (m,) that count under a further ``force`` (m,).

    A law may be far stiffer where bodies start than on their way apart. The substeps of parting bodies grow, but only
    where the contact is so soft that the change costs next to no energy; those that attraction brings back do not part.
    """
    stored = law.energy(contacts)
    parting = np.flatnonzero(approach.parting & (approach.energy + stored >= 0.0))
    rows = np.concatenate(
        [np.arange(len(contacts)), parting]
    )  # those that part a second time, with no energy of motion
    energy = np.concatenate([approach.energy + stored, stored[parting]])
    both, alike = select(contacts, rows), motion.select(rows)
    stiffness, damping = _greatest(law, both, alike, _deepest(law, both, energy, force[rows]))
    (stiffness, faded), (damping, faded_damping) = (
        np.split(column, [len(contacts)]) for column in (stiffness, damping)
    )
    stiffness[parting] = np.minimum(stiffness[parting], FADED**2 * faded)
    damping[parting] = np.minimum(damping[parting], FADED * faded_damping)
    return stiffness, damping


def _deepest(law: ForceLaw, contacts: Contacts, energy: FloatArray, force: FloatArray) -> FloatArray:
    """Gap (m,) at which the law has stored this ``energy`` (m,) and the work of ``force`` (m,) on the way [length].

    The gap is zero where the law never can.
    """
    start = np.minimum(contacts.gap, law.range)
    if np.array_equal(contacts.at_wall, np.isinf(contacts.radius_b)):
        found = _deepest_by_formula(law, contacts, start, energy, force)
        if found is not None:
            return found
    low, high = np.zeros(len(contacts)), start
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        enough = law.energy(replace(contacts, gap=middle)) >= energy + force * (start - middle)
        low, high = np.where(enough, middle, low), np.where(enough, high, middle)
    return high


def _deepest_by_formula(
    law: ForceLaw, contacts: Contacts, start: FloatArray, energy: FloatArray, force: FloatArray
) -> FloatArray | None:
    """The same gap (m,), of balls and flat walls, searched from ``start`` (m,) on; None without a formula."""
    of_balls, formula = ball_law(law), common_formula(law)
    if of_balls is not None:
        formula, parameters = of_balls.formula, of_balls.parameters(contacts)
    elif formula is not None:
        parameters = formula.parameters[None]
    else:
        return None
    from rigidfluid.core.contact.path.deepest_gaps import deepest_gaps

    radii = contacts.radius_a, contacts.radius_b
    found = deepest_gaps(compiled(formula.function), parameters, start, *radii, energy, force, _HALVINGS)
    return np.asarray(found)


def _greatest(law: ForceLaw, contacts: Contacts, motion: Motion, deepest: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Greatest stiffness and damping coefficient (m,) between the deepest gap and the range."""
    damping = np.zeros(len(contacts))
    if law.dissipative:
        for there in contacts_on_the_way(law, contacts, deepest):
            tried, speed = repeated(there, len(_SPEEDS)), np.repeat(_SPEEDS, len(there))
            opening = Motion(speed[:, None] * tried.normal, np.resize(motion.mass, len(tried)))
            resisting = -normal_part(law.damping(tried, opening), tried) / speed
            damping = np.maximum(damping, greatest_of_each(resisting, len(contacts)))
    return greatest_stiffness(law, contacts, deepest), damping


def relative_motion(
    contacts: Contacts, dynamics: BodyDynamics, wall_velocity: WallVelocities | None = None, turning: bool = False
) -> Motion:
    """Velocity of a relative to b half-way between the m contact points, and the effective mass of the pair, zero where
    both are prescribed; the relative angular velocity only if ``turning``.

    ``wall_velocity`` gives the velocities of sliding walls, None for walls at rest; walls have infinite mass.
    """
    velocity = relative_velocity(contacts, dynamics.pose, dynamics.twist)
    if wall_velocity is not None:
        velocity -= wall_velocity(contacts.body_b, middle(contacts))
    on_body = contacts.body_b < len(dynamics.pose.position)
    inverse = dynamics.inverse_mass_along(contacts.body_a, contacts.normal)
    inverse[on_body] += dynamics.inverse_mass_along(contacts.body_b[on_body], contacts.normal[on_body])
    if not turning:
        return Motion(velocity, _reciprocal(inverse))
    spin = relative_angular_velocity(contacts, dynamics.twist, wall_velocity)
    return Motion(velocity, _reciprocal(inverse), spin)


def relative_angular_velocity(contacts: Contacts, twist: Twist, wall_velocity: WallVelocities | None) -> FloatArray:
    """Angular velocity of a relative to b, (m, k) [rad/time]; ``wall_velocity`` as in `relative_motion`."""
    spin = _relative(twist.angular_velocity, contacts)
    return spin if wall_velocity is None else spin - wall_velocity.angular_velocity(contacts.body_b, middle(contacts))


def _reciprocal(inverse: FloatArray) -> FloatArray:
    """Reciprocal, zero where ``inverse`` is."""
    return np.divide(1.0, inverse, out=np.zeros_like(inverse), where=inverse > 0.0)


def _relative(quantity: FloatArray, contacts: Contacts) -> FloatArray:
    """Difference of ``quantity`` (n, d) between a and b, zero for walls, (m, d)."""
    extended = np.vstack([quantity, np.zeros_like(quantity[:1])])
    return np.asarray(extended[contacts.body_a] - extended[np.minimum(contacts.body_b, len(quantity))])


def relative_velocity(contacts: Contacts, pose: Pose, twist: Twist) -> FloatArray:
    """Velocity of a relative to b half-way between the contact points, (m, d) [length/time].

    Walls count as at rest, since no approach depends on how they slide in themselves.
    """
    from rigidfluid.core.contact.pairs.pair_velocity import relative_velocities

    a, b = (contacts.body_a, contacts.point_a), (contacts.body_b, contacts.point_b)
    return np.asarray(
        relative_velocities(pose.position, twist.velocity, twist.angular_velocity, *a, *b, contacts.shift)
    )


def _inverse_masses(contacts: Contacts, dynamics: BodyDynamics) -> FloatArray:
    """Inverse masses 1/m of a and of b along the normal, (m, 2), zero for walls [1/mass]."""
    inverse = np.zeros((len(contacts), 2))
    for side, body in enumerate([contacts.body_a, contacts.body_b]):
        on_body = body < len(dynamics.pose.position)
        inverse[on_body, side] = dynamics.inverse_mass_along(body[on_body], contacts.normal[on_body])
    return inverse


def _pair_values(column: FloatArray, contacts: Contacts) -> FloatArray:
    """Values of ``column`` (n,) for a and for b, zero for walls, (m, 2)."""
    extended = np.append(column, 0.0)
    return np.column_stack([extended[contacts.body_a], extended[np.minimum(contacts.body_b, len(column))]])


def _highest_sum(coefficient: FloatArray, contacts: Contacts, inverse: FloatArray) -> float:
    """Bound of the largest eigenvalue of M⁻¹K: the sums of k/m over the contacts of a body, of both in each contact."""
    total = np.zeros(int(contacts.body_b.max(initial=0)) + 1 + int(contacts.body_a.max(initial=0)))
    np.add.at(total, contacts.body_a, coefficient * inverse[:, 0])
    np.add.at(total, contacts.body_b, coefficient * inverse[:, 1])
    return float((total[contacts.body_a] + total[contacts.body_b]).max())
