"""Loads of the contacts at one moment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.path.stretched import stretched
from rigidfluid.core.contact.path.substep import relative_motion
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.wrenches import contact_wrench, nothing, power
from rigidfluid.core.model.contacts import middle
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import TangentialSprings, spring_energy
from rigidfluid.core.model.types import Contacts, Wrench


class ContactLoad(NamedTuple):
    """Loads of the contacts at one moment: their ``wrench`` on the bodies, the forces of ``damping`` (m, d) in it, None
    without dampers, the ``loss`` to these, and ``actuator_work``, done on prescribed bodies and walls to move them
    against contacts [energy/time]; the ``springs`` along surfaces, None without any, and the energy that ``slipped``
    away since these were as before."""

    wrench: Wrench
    damping: FloatArray | None
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
    force, damping, loss, slipped = law.force(contacts), None, 0.0, 0.0
    if law.dissipative:
        motion = relative_motion(contacts, dynamics, system.wall_velocity)
        damping = law.damping(contacts, motion)
        force, loss = force + damping, -float(np.sum(damping * motion.velocity))
        if law.sticking:
            along, springs, slipped = stretched(law, contacts, motion, dynamics.pose, springs, time)
            force = force + along
    wrench, actuator_work = contact_wrench(contacts, force, dynamics.pose), 0.0
    moved = prescribed_bodies(system)
    if moved.any():
        actuator_work = -float(power(wrench, dynamics.prescribed_part(system.motions.prescribed))[moved].sum())
    if system.wall_velocity is not None:
        actuator_work += float(np.sum(force * system.wall_velocity(contacts.body_b, middle(contacts))))
    return ContactLoad(wrench, damping, loss, actuator_work, springs, slipped)


def damping_loss(system: System, contacts: Contacts, dynamics: BodyDynamics, damping: FloatArray | None) -> float:
    """Power that the dampers take, with the velocities half-way through their kick, of which each of two substeps has a
    half: times the substep it is the loss in the whole kick [energy/time]."""
    if damping is None:
        return 0.0
    return -float(np.sum(damping * relative_motion(contacts, dynamics, system.wall_velocity).velocity))


def prescribed_bodies(system: System) -> BoolArray:
    """Tell whether a body's twist may have a prescribed part (n,): any body's where something moves relatively in a
    mechanism, as that part is zero in all others."""
    return np.ones_like(system.prescribed) if system.motions.driven else system.prescribed
