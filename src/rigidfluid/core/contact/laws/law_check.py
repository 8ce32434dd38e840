"""Spot checks of laws: energies from which their forces follow."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.contact.pairs.gap_curvature import with_gap_curvatures
from rigidfluid.core.contact.pairs.representative_contacts import contacts_at_gaps, pair_contacts, wall_contacts
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.guarded import part_error
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.model.contacts import joined, normal_part, select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Motion

_FRACTIONS = np.array([0.11, 0.37, 0.83])
"""Gaps over the range, none of which is where a law is likely to have a corner."""

_STEP = 1e-4
"""Step of central differences over the range."""

_TOLERANCE = 1e-3
"""Greatest difference of a slope, over the largest: those by differences are good to 1e-5 for the steepest laws."""


def check_laws(system: System) -> None:
    """Raise PluginError unless each law's force is -dU/dgap along the normal, its stiffness -dF/dgap, and its damping
    and couples take power, in a hypothetical contact in which it acts."""
    for interaction in system.interactions:
        contacts = _some_contact(system, interaction)
        if len(contacts):
            _check_law(interaction.law, contacts_at_gaps(contacts, interaction.law.range * _FRACTIONS[None]))


def _some_contact(system: System, interaction: Interaction) -> Contacts:
    """A contact that an interaction acts in; none where it acts between no two of the first surfaces and its own."""
    count = len(system.bodies)
    own = [number for group in interaction.surfaces for number in group[:2] if number < count]
    bodies = list(dict.fromkeys([*own, *range(min(count, 3))]))
    hypothetical = [pair_contacts(system, bodies)]
    hypothetical += [wall_contacts(system, [body] * len(system.walls), system.walls) for body in bodies]
    contacts = joined(hypothetical)
    contacts = select(contacts, np.flatnonzero(interaction.acts_in(contacts))[:1])
    return with_gap_curvatures(contacts, system, system.pose)


def _check_law(law: ForceLaw, contacts: Contacts) -> None:
    force, stiffness = law.force(contacts), law.stiffness(contacts)
    along = normal_part(force, contacts)
    across = np.linalg.norm(force - along[:, None] * contacts.normal, axis=1)
    if np.any(across > _TOLERANCE * np.abs(along)):
        wrong = _wrong(contacts, across, across > 0.0, "forces along the normal, and damping besides")
        raise part_error(law, "force", wrong)
    _check_slope(law, "force", contacts, along, law.energy)
    _check_slope(law, "stiffness", contacts, stiffness, lambda one: normal_part(law.force(one), one))
    for velocity in (contacts.normal, -contacts.normal):
        motion = Motion(velocity, np.ones(len(contacts)))
        power = np.sum(law.damping(contacts, motion) * velocity, axis=1)
        _refuse_power(law, "damping", contacts, power, "force times velocity")
    if law.couples:
        turning = np.ones_like(motion.angular_velocity)
        motion = Motion(np.zeros_like(contacts.normal), motion.mass, turning)
        power = np.sum(law.couple(contacts, motion) * turning, axis=1)
        _refuse_power(law, "couple", contacts, power, "couple times angular velocity")


def _refuse_power(law: ForceLaw, key: str, contacts: Contacts, power: FloatArray, product: str) -> None:
    """Raise PluginError where a ``power`` (m,), the ``product``, is above zero."""
    if np.any(power > 0.0):
        raise part_error(law, key, _wrong(contacts, power, power > 0.0, f"powers, {product}, of 0 or less"))


def _check_slope(
    law: ForceLaw, key: str, contacts: Contacts, found: FloatArray, column: Callable[[Contacts], FloatArray]
) -> None:
    """Raise PluginError unless what is ``found`` is minus the slope of a ``column``."""
    step = _STEP * law.range
    shifted = contacts_at_gaps(contacts, contacts.gap[:, None] + [-step, step])
    before, after = column(shifted).reshape(-1, 2).T
    slope = (before - after) / (2.0 * step)
    wrong = np.abs(found - slope) > _TOLERANCE * np.abs(slope).max() + 1e-9 * np.abs(found).max()
    if wrong.any():
        of = "the energy" if key == "force" else "the force"
        allowed = f"{slope[wrong][0]:.6g}, minus the slope of {of}"
        raise part_error(law, key, _wrong(contacts, found, wrong, allowed))


def _wrong(contacts: Contacts, values: FloatArray, wrong: BoolArray, allowed: str) -> Wrong:
    """The first of the ``values`` that are ``wrong``, and its gap."""
    return Wrong(f"{values[wrong][0]:.6g} at a gap of {contacts.gap[wrong][0]:.6g}", allowed)
