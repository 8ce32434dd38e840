"""How long substeps must be so that contacts are met and resolved."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, log2
from typing import NamedTuple

import numpy as np

from rigidfluid.core.interfaces import ForceLaw
from rigidfluid.core.movement import Movement
from rigidfluid.core.rigid import cross, moment
from rigidfluid.core.types import Contacts, FloatArray, IntArray, Motion, Pose, Twist

RESOLUTION = 0.1
"""Substep times the highest contact frequency: some sixty substeps in a period."""

_HALVINGS = 30
_SAMPLES = 8


class Plan(NamedTuple):
    """``coast``: for how long nothing can touch [time]; ``substep``: what resolves the contacts from then on [time]."""

    coast: float
    substep: float


def plan(law: ForceLaw, contacts: Contacts, movement: Movement, pull: FloatArray, size: float, span: float) -> Plan:
    """How to go on: h ω ≤ 0.1 with ω the highest frequency that the contacts can reach with the energy they have.

    Not the one they have now: substeps of equal length keep the energy of a collision. h is the step halved a whole
    number of times, so that it seldom changes from step to step; each change costs some energy.

    Parameters
    ----------
    law : ForceLaw
        Gives energy, stiffness and damping.
    contacts : Contacts
        All that may come into range in the span.
    movement : Movement
        The n bodies as they move now.
    pull : (n,) array
        Greatest acceleration by all but contacts [length/time²].
    size, span : float
        Of the whole step, and how far contacts are foreseen [time].

    Returns
    -------
    Plan
        For the span.
    """
    if len(contacts) == 0:
        return Plan(span, span)
    motion = relative_motion(contacts, movement)
    pulls = np.append(pull, 0.0)
    pulled = pulls[contacts.body_a] + pulls[np.minimum(contacts.body_b, len(pull))]
    speed = np.linalg.norm(motion.velocity, axis=1) + span * pulled
    first = np.maximum(contacts.gap - law.range, 0.0) / np.maximum(speed, np.finfo(float).tiny)
    halvings = log2(max(size / _resolved(law, contacts, movement, motion, pulled), 1.0))
    substep = size / 2.0 ** ceil(halvings)
    coast = min(float(first.min()), span)
    return Plan(coast if coast > substep else 0.0, substep)


def _resolved(law: ForceLaw, contacts: Contacts, movement: Movement, motion: Motion, pull: FloatArray) -> float:
    """0.1/ω with ω² ≤ Σ k/m over all contacts of either body, k the greatest stiffness within reach [time]."""
    inverse = _inverse_masses(contacts, movement)
    closing = np.minimum(np.sum(motion.velocity * contacts.normal, axis=1), 0.0)
    mass = 1.0 / np.maximum(inverse.sum(axis=1), np.finfo(float).tiny)
    energy = 0.5 * mass * closing**2 + law.energy(contacts)
    stiffness, damping = _greatest(law, contacts, motion, _deepest(law, contacts, energy, mass * pull))
    rate = max(np.sqrt(_highest_sum(stiffness, contacts, inverse)), _highest_sum(damping, contacts, inverse))
    return RESOLUTION / rate if rate > 0 else np.inf


def _deepest(law: ForceLaw, contacts: Contacts, energy: FloatArray, force: FloatArray) -> FloatArray:
    """The gap (m,) at which the law has stored this ``energy`` (m,) and what ``force`` (m,) adds on the way [length].

    Zero where it never can.
    """
    start = np.minimum(contacts.gap, law.range)
    low, high = np.zeros(len(contacts)), start
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        enough = law.energy(replace(contacts, gap=middle)) >= energy + force * (start - middle)
        low, high = np.where(enough, middle, low), np.where(enough, high, middle)
    return high


def _greatest(law: ForceLaw, contacts: Contacts, motion: Motion, deepest: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The greatest stiffness and damping coefficient (m,) between the deepest gap and the range."""
    stiffness, damping = np.zeros((2, len(contacts)))
    unit = replace(motion, velocity=contacts.normal)
    for part in np.linspace(0.0, 1.0, _SAMPLES, endpoint=False):
        there = replace(contacts, gap=deepest + part * (law.range - deepest))
        stiffness = np.maximum(stiffness, law.stiffness(there))
        if law.dissipative:
            damping = np.maximum(damping, -np.sum(law.damping(there, unit) * contacts.normal, axis=1))
    return stiffness, damping


def relative_motion(contacts: Contacts, movement: Movement) -> Motion:
    """Velocity of a relative to b half-way between the contact points, and the effective mass of the pair,
    zero where both are driven.

    Parameters
    ----------
    contacts : Contacts
        m contacts.
    movement : Movement
        The n bodies as they move now; walls rest, and are heavy beyond measure.

    Returns
    -------
    Motion
        Of the m contacts.
    """
    pose, twist = movement.pose, movement.twist
    count, point = len(pose.position), 0.5 * (contacts.point_a + contacts.point_b)
    velocity = _point_velocity(pose, twist, contacts.body_a, point)
    on_body = contacts.body_b < count
    velocity[on_body] -= _point_velocity(pose, twist, contacts.body_b[on_body], point[on_body])
    inverse = movement.inverse_mass(contacts.body_a, contacts.normal)
    inverse[on_body] += movement.inverse_mass(contacts.body_b[on_body], contacts.normal[on_body])
    mass = np.zeros_like(inverse)
    np.divide(1.0, inverse, out=mass, where=inverse > 0.0)
    return Motion(velocity, mass)


def _point_velocity(pose: Pose, twist: Twist, body: IntArray, point: FloatArray) -> FloatArray:
    return twist.velocity[body] + cross(twist.angular_velocity[body], point - pose.position[body])


def _inverse_masses(contacts: Contacts, movement: Movement) -> FloatArray:
    """1/m + (r × n)·(R I Rᵀ)⁻¹(r × n) of a and of b, (m, 2), zero for walls [1/mass]."""
    position = movement.pose.position
    inverse = np.zeros((len(contacts), 2))
    for side, (body, point) in enumerate([(contacts.body_a, contacts.point_a), (contacts.body_b, contacts.point_b)]):
        on_body = body < len(position)
        index, normal = body[on_body], contacts.normal[on_body]
        turn = moment(point[on_body] - position[index], normal)
        turning = np.einsum("ni,nij,nj->n", turn, movement.inverse_inertia[index], turn)
        inverse[on_body, side] = movement.inverse_mass(index, normal) + turning
    return inverse


def _highest_sum(coefficient: FloatArray, contacts: Contacts, inverse: FloatArray) -> float:
    """Bound of the largest eigenvalue of M⁻¹K: the sums of k/m over the contacts of a body, of both in each contact."""
    total = np.zeros(int(contacts.body_b.max(initial=0)) + 1 + int(contacts.body_a.max(initial=0)))
    np.add.at(total, contacts.body_a, coefficient * inverse[:, 0])
    np.add.at(total, contacts.body_b, coefficient * inverse[:, 1])
    return float((total[contacts.body_a] + total[contacts.body_b]).max())
