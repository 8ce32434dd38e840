"""What the questions are about: who may meet whom, and what such a contact must hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from rigidfluid.checks.response import turning_gap
from rigidfluid.core.contact.loads import (
    closing_speed,
    held_weight,
    impact_energy,
    inverse_mass,
    pair_energy,
    stacked_weight,
)
from rigidfluid.core.contact.meetings import body_meetings, facing_normal, free, kinds, representatives, wall_meetings
from rigidfluid.core.contact.stiffness import greatest_stiffness
from rigidfluid.core.model.interfaces import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, FloatArray
from rigidfluid.core.model.wall import Wall

MOST_SHOWN = 8
"""Of the kinds of pairs, for one question."""


@dataclass(frozen=True)
class Encounters:
    """Contacts of bodies with walls, or with each other, as they are to be expected.

    ``weight`` (m,) presses the two together at rest [force], ``speed`` (m,) is that of the approach [length/time] and
    ``pair_energy`` (m,) its energy [energy]; ``stacked_weight`` (m,) and ``energy`` (m,) are the same with the bodies
    that may come to press on the contact. ``inverse_mass`` (m,) [1/mass]; ``kind`` is equal for bodies that are alike.
    """

    system: System
    law: ForceLaw
    at_walls: bool
    contacts: Contacts
    weight: FloatArray
    stacked_weight: FloatArray
    pair_energy: FloatArray
    energy: FloatArray
    speed: FloatArray
    inverse_mass: FloatArray
    kind: Mapping[int, int]

    def turning_gaps(self) -> FloatArray:
        """Where the impacts end, that the stacked weight pushes on (m,) [length]."""
        return turning_gap(self.law, self.contacts, self.energy, self.stacked_weight)

    def stiffness(self) -> FloatArray:
        """The greatest on the way to the turning gaps (m,) [force/length]."""
        return greatest_stiffness(self.law, self.contacts, self.turning_gaps())

    def names(self, row: int) -> tuple[str, str]:
        """Of the two surfaces."""
        surfaces = self.system.surfaces
        return surfaces[self.contacts.body_a[row]], surfaces[self.contacts.body_b[row]]

    def worst(self, badness: FloatArray) -> list[int]:
        """The worst row of each kind of pair, the worst of all first, but at most MOST_SHOWN."""
        first: dict[tuple[int, int], int] = {}
        for row in np.argsort(-badness, kind="stable").tolist():
            a, b = int(self.contacts.body_a[row]), int(self.contacts.body_b[row])
            low, high = sorted((self.kind[a], self.kind.get(b, -b)))
            first.setdefault((low, high), row)
        return list(first.values())[:MOST_SHOWN]


def encounters(system: System, law: ForceLaw) -> Iterator[Encounters]:
    """Of bodies with the wall that their weight presses them on, or else any wall; and with each other.

    Parameters
    ----------
    system : System
        Bodies, walls and loads.
    law : ForceLaw
        Its law.

    Yields
    ------
    Encounters
        One that is not empty for walls, and one for bodies.
    """
    bodies = representatives(system)
    kind = {body: number for number, alike in enumerate(kinds(system)) for body in alike}
    moving = free(system, bodies)
    if system.walls and moving:
        walls = [_pressing(system, body) for body in moving]
        contacts = wall_meetings(system, moving, walls)
        yield _encounters(system, law, True, contacts, _pressing_share(system, moving, contacts), kind)
    contacts = body_meetings(system, bodies)
    if len(contacts):
        yield _encounters(system, law, False, contacts, np.ones(len(contacts)), kind)


def _pressing(system: System, body: int) -> Wall:
    return max(system.walls, key=lambda wall: -float(facing_normal(system, body, wall.shape) @ system.weight[body]))


def _pressing_share(system: System, bodies: list[int], contacts: Contacts) -> FloatArray:
    """The part of the weight of each of m ``bodies`` that presses it on its wall, (m,) [1]."""
    weight = system.weight[bodies]
    pull, whole = -np.einsum("md,md->m", contacts.normal, weight), np.linalg.norm(weight, axis=1)
    share: FloatArray = np.divide(np.maximum(pull, 0.0), whole, out=np.zeros(len(bodies)), where=whole > 0.0)
    return share


def _encounters(
    system: System,
    law: ForceLaw,
    at_walls: bool,
    contacts: Contacts,
    pressing: FloatArray,
    kind: Mapping[int, int],
) -> Encounters:
    """``pressing`` (m,) is the part of the weight that acts across each contact [1]."""
    loads = system.loads
    return Encounters(
        system=system,
        law=law,
        at_walls=at_walls,
        contacts=contacts,
        weight=pressing * held_weight(contacts, loads),
        stacked_weight=pressing * stacked_weight(contacts, loads),
        pair_energy=pair_energy(contacts, loads),
        energy=impact_energy(contacts, loads),
        speed=closing_speed(contacts, loads),
        inverse_mass=inverse_mass(contacts, loads),
        kind=kind,
    )
