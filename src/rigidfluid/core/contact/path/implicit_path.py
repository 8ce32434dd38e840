"""Path of the bodies through one step in implicit steps of their contacts."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from rigidfluid.core.contact.pairs.extrapolated_contacts import ExtrapolatedContacts
from rigidfluid.core.contact.path.body_step import BodyStep, add_wrench, arrived
from rigidfluid.core.contact.path.contact_load import prescribed_bodies
from rigidfluid.core.contact.path.implicit_contacts import KEPT, Encounter, implicit_contact_step
from rigidfluid.core.contact.path.look_ahead import fastest_speed, foreseen
from rigidfluid.core.contact.path.substep_path import fly_freely, spring_parts
from rigidfluid.core.mechanics.wrenches import nothing, power
from rigidfluid.core.model.detection import FollowedContacts
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import TangentialSprings, spring_energy
from rigidfluid.core.model.types import Contacts, Pose, Twist, Wrench
from rigidfluid.errors import StepRejected

M = TypeVar("M", bound=BodyDynamics)

IMPLICIT_PARTS = 8
"""Number of implicit steps of the bodies in one step of a fluid."""


def implicit_free(
    system: System, law: ForceLaw, dynamics: BodyDynamics, size: float, springs: TangentialSprings | None
) -> tuple[BodyStep, BodyDynamics]:
    """Advance without a fluid, by one implicit step or as many as springs of joints need; return also the dynamics at
    the end. ``springs``: those along surfaces at the start."""
    parts = spring_parts(system, size)
    path, dynamics = _implicit_or_free(system, law, dynamics, size / parts, springs)
    for _ in range(1, parts):
        before = path
        path, dynamics = _implicit_or_free(system, law, dynamics, size / parts, before.springs)
        impulse = add_wrench(path.impulse, before.impulse, 1.0)
        path = replace(
            path,
            motions=dynamics.motions(impulse),
            impulse=impulse,
            dissipated=path.dissipated + before.dissipated,
            actuator_work=path.actuator_work + before.actuator_work,
            substeps=path.substeps + before.substeps,
        )
    return path, dynamics


def _implicit_or_free(
    system: System, law: ForceLaw, dynamics: BodyDynamics, size: float, springs: TangentialSprings | None
) -> tuple[BodyStep, BodyDynamics]:
    """Advance by one implicit step, or freely where nothing may come into range; return also the dynamics at its
    end."""
    contacts = foreseen(system, law, dynamics, size, 0.0)
    if len(contacts.start) == 0:
        return replace(fly_freely(system, dynamics, size), dissipated=spring_energy(springs)), dynamics
    return _implicit_step(system, law, dynamics, contacts.start, contacts, size, springs)


def implicit_coupled(
    system: System,
    law: ForceLaw,
    dynamics: BodyDynamics,
    near: Contacts,
    size: float,
    springs: TangentialSprings | None,
) -> BodyStep:
    """Advance in a fluid, by several implicit steps in one of the fluid's: an impact is then short compared with that,
    and drag acts before and after it.

    In a single implicit step an impact would last as long as the fluid's step and work against drag all the while, and
    its impulse would be greater than the reduced mass alone asks for.
    """
    part, impulse, lost, actuator_work = size / IMPLICIT_PARTS, nothing(dynamics.pose), 0.0, 0.0
    at_start = ExtrapolatedContacts(near, dynamics.pose)
    reach = max(float(near.gap.max()), law.range + 4.0 * fastest_speed(system, dynamics, size) * size)
    for _ in range(IMPLICIT_PARTS):
        start, followed = system.detection.followed(at_start, law, dynamics, part, reach)
        if len(start) == 0:
            fly_freely(system, dynamics, part)
            lost, springs = lost + spring_energy(springs), None
            continue
        path, dynamics = _implicit_step(system, law, dynamics, start, followed, part, springs)
        impulse = add_wrench(impulse, path.impulse, 1.0)
        lost, actuator_work, springs = lost + path.dissipated, actuator_work + path.actuator_work, path.springs
    path = arrived(dynamics, impulse, lost, actuator_work, IMPLICIT_PARTS)
    friction, left_out = dynamics.friction_loss, dynamics.drag_left_out
    return replace(path, friction=friction, drag_left_out=left_out, springs=springs)


def _implicit_step(
    system: System,
    law: ForceLaw,
    dynamics: M,
    start: Contacts,
    followed: FollowedContacts,
    size: float,
    springs: TangentialSprings | None,
) -> tuple[BodyStep, M]:
    """Advance by one implicit step with the contacts ``followed``, at its start ``start``; return also the dynamics at
    its end."""
    encounter = Encounter(law, dynamics, start, followed.extrapolate, size, system.wall_velocity, springs)
    crossing = implicit_contact_step(encounter)
    end, wrench, lost, wall_work, stored, springs = crossing
    _refuse_unseen(law, followed, end.pose, KEPT * stored)
    impulse = Wrench(size * wrench.force, size * wrench.torque)
    before, after = (each.prescribed_part(system.motions.prescribed) for each in (dynamics, end))
    mean = Twist(
        0.5 * (before.velocity + after.velocity),
        0.5 * (before.angular_velocity + after.angular_velocity),
    )
    actuator_work = wall_work - float(power(impulse, mean)[prescribed_bodies(system)].sum())
    return replace(arrived(end, impulse, lost, actuator_work, 1), springs=springs), end


def _refuse_unseen(law: ForceLaw, followed: FollowedContacts, end: Pose, allowed: float) -> None:
    """Raise StepRejected if contacts that came or went untracked hold more than the ``allowed`` energy."""
    missed = followed.missed(law, end)
    if abs(missed) > allowed:
        found = f"contacts of a pair that came or went within it, with an energy of {missed:.1e}"
        raise StepRejected("the implicit contact step", found, "contacts that last through it", "Shorten the step.")
