"""Springs along the surfaces of contacts, as these move past each other and turn: stretched, and shortened where they
slip."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.pairs.carried_springs import carried_springs, springs_at
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.contacts import tangential_part, turning_radius
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.tangential_springs import TangentialSprings, spring_energy
from rigidfluid.core.model.types import Contacts, Motion, Pose


class Stretched(NamedTuple):
    """Forces -k ξ of springs along the surfaces on ``body_a`` (m, d) [force], the ``couple`` -R k ζ of those that
    resist turning (m, k), None without any [force·length], the ``springs`` themselves, None where all are relaxed, and
    the energy ``lost`` since they were as before, by slip [energy]."""

    force: FloatArray
    couple: FloatArray | None
    springs: TangentialSprings | None
    lost: float


def stretched(
    law: ForceLaw, contacts: Contacts, motion: Motion, pose: Pose, before: TangentialSprings | None, time: float
) -> Stretched:
    """Springs of the ``contacts`` of bodies at ``pose`` after a ``motion`` that has lasted for ``time``, from those
    ``before``.

    ξ' = ξ + v_t Δt, shortened as far as friction slips. The mean of both forces loses k (ξ + ξ')/2·v_t Δt less the
    change of the energy k ξ²/2: nothing where the surfaces stick. So it is for the turning ζ, by R w Δt.
    """
    carried, turned = carried_springs(before, contacts, pose)
    way = time * tangential_part(motion.velocity, contacts)
    stiffness = law.tangential_stiffness(contacts)
    displacement = law.held_displacement(contacts, motion, carried + way)
    work, couple, turning = float(np.sum(stiffness[:, None] * 0.5 * (carried + displacement) * way)), None, None
    if law.rolling:
        radius = turning_radius(contacts)
        rolled = time * radius * motion.angular_velocity
        turning = law.held_turning(contacts, motion, turned + rolled)
        work += float(np.sum(stiffness[:, None] * 0.5 * (turned + turning) * rolled))
        couple = -radius * stiffness[:, None] * turning
    springs = springs_at(contacts, displacement, stiffness, pose, turning)
    lost = work + spring_energy(before) - spring_energy(springs)
    return Stretched(-stiffness[:, None] * displacement, couple, springs if len(springs) else None, lost)
