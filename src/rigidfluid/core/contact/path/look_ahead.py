"""Contacts that a step may bring into range, and how far they are detected ahead."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.contact.laws.attraction import releasable_energy
from rigidfluid.core.contact.pairs.proximity import detect, interacting
from rigidfluid.core.contact.pairs.tracked_pairs import TrackedPairs
from rigidfluid.core.contact.path.substep import relative_velocity
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import body_accelerations
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detection import Sight
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Pose


def near_contacts(system: System, state: State, start: float, size: float) -> Contacts:
    """Contacts in range, or that may come into it in a step of this ``size`` from ``start`` on [time]: by twice the
    relative speed of their surfaces at its end, with the accelerations of both bodies added up."""
    contacts = state.contacts
    if system.law is None or len(contacts) == 0:
        return select(contacts, np.zeros(len(contacts), dtype=bool))
    speed = np.linalg.norm(relative_velocity(contacts, state.pose, state.twist), axis=1)
    rate, d = body_accelerations(system, state, start, size), system.dimension
    acceleration = np.linalg.norm(rate[:, :d], axis=1) + system.arms * np.linalg.norm(rate[:, d:], axis=1)
    acceleration = np.append(acceleration, 0.0)  # of walls
    both = acceleration[contacts.body_a] + acceleration[np.minimum(contacts.body_b, len(acceleration) - 1)]
    return select(contacts, contacts.gap <= system.law.range + 2.0 * size * (speed + size * both))


def look_ahead(system: System, dynamics: BodyDynamics, size: float) -> Sight:
    """Sight for a step of this ``size`` [time] at the present speeds, by a detector that needs no mesh; no farther than
    the law where a scene fixes the number of substeps, which are then not planned by contacts to come."""
    law_range = system.law_range
    if system.substeps:
        return Sight(_detection(system, law_range), law_range, size)
    largest = float(system.bounding_radii.max())
    fastest = fastest_speed(system, dynamics, size)
    ahead = min(2.0 * fastest * size, law_range + 2.0 * largest)
    reach = law_range + ahead
    return Sight(_detection(system, reach), reach, 0.5 * ahead / fastest if fastest > 0 else size)


def _detection(system: System, reach: float) -> Callable[[Pose], Contacts]:
    """Function that detects the contacts up to a gap ``reach`` [length] at a pose, without a mesh."""

    def contacts_at(pose: Pose) -> Contacts:
        return interacting(system, detect(system, pose, None, reach))

    return contacts_at


def foreseen(system: System, law: ForceLaw, dynamics: BodyDynamics, size: float, reach: float) -> TrackedPairs:
    """Pairs that a step of this ``size`` [time] may bring into range, and at least those within ``reach`` [length].

    The speed allowed for is four times the fastest, as impacts may double that of both bodies, and twice the speed that
    bodies at rest, pressed together, may get from the energy of their contacts.
    """
    reach = max(reach, law.range + 4.0 * fastest_speed(system, dynamics, size) * size)
    contacts = TrackedPairs(system, dynamics.pose, reach)
    released = _released(system, law, dynamics, contacts.start)
    if released > 0.0:
        contacts = TrackedPairs(system, dynamics.pose, reach + 2.0 * released * size)
    return contacts


def _released(system: System, law: ForceLaw, dynamics: BodyDynamics, contacts: Contacts) -> float:
    """Greatest speed of a surface point if a body got all energy that its contacts can release [length/time]."""
    contacts, stored = select(contacts, contacts.sign > 0.0), np.zeros(len(system.surfaces))
    energy = releasable_energy(law, contacts)
    np.add.at(stored, contacts.body_a, energy)
    np.add.at(stored, contacts.body_b, energy)
    straight, turning = (np.linalg.eigvalsh(each)[:, -1] for each in (dynamics.inverse_mass, dynamics.inverse_inertia))
    inverse_mass = straight + system.arms**2 * turning
    return float(np.sqrt(2.0 * np.max(stored[: len(inverse_mass)] * inverse_mass)))


def fastest_speed(system: System, dynamics: BodyDynamics, size: float) -> float:
    """Bound of the speed of any surface point in a step of this ``size`` [time], contacts apart [length/time]."""
    return float(np.max(fastest_speeds(system, dynamics, size)))


def fastest_speeds(system: System, dynamics: BodyDynamics, size: float) -> FloatArray:
    """Bounds of the speeds of each body's surface points in a step of this ``size`` [time], contacts apart (n,)
    [length/time]."""
    twist = dynamics.twist
    turning = system.arms * np.linalg.norm(twist.angular_velocity, axis=1)
    return np.asarray(np.linalg.norm(twist.velocity, axis=1) + turning + size * dynamics.max_acceleration(size))
