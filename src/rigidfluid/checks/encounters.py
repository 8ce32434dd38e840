"""What the questions are about: who may meet whom, and what such a contact must hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.interfaces import ForceLaw
from rigidfluid.core.loads import closing_speed, held_weight, impact_energy, inverse_mass
from rigidfluid.core.meetings import body_meetings, free, kinds, representatives, wall_meetings
from rigidfluid.core.system import System
from rigidfluid.core.types import Contacts, FloatArray, Wall

MOST_SHOWN = 8
"""Of the kinds of pairs, for one question."""


@dataclass(frozen=True)
class Encounters:
    """Contacts of bodies with walls, or with each other, as they are to be expected.

    ``weight`` (m,) presses the two together at rest [force], ``energy`` (m,) is that of the approach [energy],
    ``speed`` (m,) [length/time], ``inverse_mass`` (m,) [1/mass]; ``kind`` is equal for bodies that are alike.
    """

    system: System
    law: ForceLaw
    at_walls: bool
    contacts: Contacts
    weight: FloatArray
    energy: FloatArray
    speed: FloatArray
    inverse_mass: FloatArray
    kind: Mapping[int, int]

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
        pull = -np.einsum("md,md->m", contacts.normal, system.weight[moving])
        yield _encounters(system, law, True, contacts, np.maximum(pull, 0.0), kind)
    contacts = body_meetings(system, bodies)
    if len(contacts):
        yield _encounters(system, law, False, contacts, held_weight(contacts, system.loads), kind)


def _pressing(system: System, body: int) -> Wall:
    return max(system.walls, key=lambda wall: -float(wall.normal @ system.weight[body]))


def _encounters(
    system: System,
    law: ForceLaw,
    at_walls: bool,
    contacts: Contacts,
    weight: FloatArray,
    kind: Mapping[int, int],
) -> Encounters:
    loads = system.loads
    energy, speed = impact_energy(contacts, loads), closing_speed(contacts, loads)
    return Encounters(system, law, at_walls, contacts, weight, energy, speed, inverse_mass(contacts, loads), kind)
