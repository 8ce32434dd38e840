"""Loads of the contacts at one moment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.path.stretched import stretched
from rigidfluid.core.contact.path.substep import relative_motion
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.wall import WallVelocities
from rigidfluid.core.mechanics.wrenches import contact_wrench, nothing, power
from rigidfluid.core.model.contacts import middle
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import TangentialSprings, spring_energy
from rigidfluid.core.model.types import Contacts, Motion, Wrench


class Damping(NamedTuple):
    """Dampers' ``force`` (m, d) [force] and ``couple`` (m, k), None without any [force·length], on ``body_a``."""

    force: FloatArray
    couple: FloatArray | None

    def loss(self, motion: Motion) -> float:
        """Power that they take in this ``motion`` [energy/time]."""
        taken = -float(np.sum(self.force * motion.velocity))
        return taken if self.couple is None else taken - float(np.sum(self.couple * motion.angular_velocity))


def evaluate_damping(law: ForceLaw, contacts: Contacts, motion: Motion) -> Damping:
    """Damping of a ``law`` in the ``contacts`` in this ``motion``."""
    return Damping(law.damping(contacts, motion), law.couple(contacts, motion) if law.couples else None)


class ContactLoad(NamedTuple):
    """Loads of the contacts at one moment: their ``wrench`` on the bodies, the ``damping`` in it, None without dampers,
    the ``loss`` to these, and ``actuator_work``, done on prescribed bodies and walls to move them against contacts
    [energy/time]; the ``springs`` along surfaces, None without any, and the energy that ``slipped`` away since these
    were as before."""

    wrench: Wrench
    damping: Damping | None
    loss: float
    actuator_work: float
    springs: TangentialSprings | None = None
    slipped: float = 0.0


def contact_load(
    system: System,
    law: ForceLaw,
    contacts: Contacts,
    dynamics: BodyDynamics,
    springs: TangentialSprings | None = None,
    time: float = 0.0,
) -> ContactLoad:
    """Loads of the ``contacts`` on the bodies, by the ``law`` and its dampers, and by its ``springs`` along surfaces,
    after another ``time`` of the present motion since they were such."""
    if len(contacts) == 0:
        return ContactLoad(nothing(dynamics.pose), None, 0.0, 0.0, slipped=spring_energy(springs))
    force, couple, damping, loss, slipped = law.force(contacts), None, None, 0.0, 0.0
    if law.dissipative:
        motion = relative_motion(contacts, dynamics, system.wall_velocity, law.couples)
        damping = evaluate_damping(law, contacts, motion)
        force, couple, loss = force + damping.force, damping.couple, damping.loss(motion)
        if law.sticking:
            along, turning, springs, slipped = stretched(law, contacts, motion, dynamics.pose, springs, time)
            force = force + along
            if turning is not None:
                couple = turning if couple is None else couple + turning
    wrench, actuator_work = contact_wrench(contacts, force, dynamics.pose, couple), 0.0
    moved = prescribed_bodies(system)
    if moved.any():
        actuator_work = -float(power(wrench, dynamics.prescribed_part(system.motions.prescribed))[moved].sum())
    if system.wall_velocity is not None:
        actuator_work += wall_power(system.wall_velocity, contacts, force, couple)
    return ContactLoad(wrench, damping, loss, actuator_work, springs, slipped)


def wall_power(
    wall_velocity: WallVelocities, contacts: Contacts, force: FloatArray, couple: FloatArray | None
) -> float:
    """Power of sliding walls on the bodies, by contacts' ``force`` (m, d) and ``couple`` (m, k) on these
    [energy/time]."""
    walls, points = contacts.body_b, middle(contacts)
    given = float(np.sum(force * wall_velocity(walls, points)))
    return given if couple is None else given + float(np.sum(couple * wall_velocity.angular_velocity(walls, points)))


def damping_loss(system: System, contacts: Contacts, dynamics: BodyDynamics, damping: Damping | None) -> float:
    """Power that the dampers take, with the velocities half-way through their kick, of which each of two substeps has a
    half: times the substep it is the loss in the whole kick [energy/time]."""
    if damping is None:
        return 0.0
    turning = damping.couple is not None
    return damping.loss(relative_motion(contacts, dynamics, system.wall_velocity, turning))


def prescribed_bodies(system: System) -> BoolArray:
    """Tell whether a body's twist may have a prescribed part (n,): any body's where something moves relatively in a
    mechanism, as that part is zero in all others."""
    return np.ones_like(system.prescribed) if system.motions.driven else system.prescribed
