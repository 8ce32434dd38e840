"""The contacts that the questions are about: which bodies may touch which, and what such a contact must hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rigidfluid.checks.response import turning_gap
from rigidfluid.core.contact.laws.loads import (
    closing_speed,
    held_weight,
    impact_energy,
    inverse_mass,
    pair_energy,
    stacked_weight,
)
from rigidfluid.core.contact.laws.stiffness import greatest_stiffness
from rigidfluid.core.contact.laws.work_to_stop import share_left
from rigidfluid.core.contact.pairs.gap_curvature import with_effective_radii
from rigidfluid.core.contact.pairs.representative_contacts import (
    body_classes,
    facing_normal,
    free,
    pair_contacts,
    representatives,
    wall_contacts,
)
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.interactions import Interaction, acting_together
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts

MOST_SHOWN = 8
"""Greatest number of kinds of pairs that one question reports."""


@dataclass(frozen=True)
class DesignContacts:
    """Contacts of bodies with walls, or with each other, as they are to be expected.

    ``weight`` (m,) presses the two together at rest [force], ``speed`` (m,) is that of the approach [length/time] and
    ``pair_energy`` (m,) the energy that the film leaves of it [energy]; ``stacked_weight`` (m,) and ``energy`` (m,) are
    the same with the bodies that may come to press on the contact. ``inverse_mass`` (m,) [1/mass]; ``kind`` is equal
    for bodies that are alike.
    The same ``interactions`` act in all of them, together as the ``law``.
    """

    system: System
    interactions: tuple[Interaction, ...]
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
        """Gaps at which the impacts end while the stacked weight pushes on (m,) [length]."""
        return turning_gap(self.law, self.contacts, self.energy, self.stacked_weight)

    def stiffness(self) -> FloatArray:
        """Greatest stiffness on the way to the turning gaps (m,) [force/length]."""
        return greatest_stiffness(self.law, self.contacts, self.turning_gaps())

    def effective_radius(self) -> FloatArray:
        """Radius of the ball at a flat wall that squeezes a film alike, NaN where it is not known (m,) [length]."""
        system = self.system
        return with_effective_radii(self.contacts, system.bodies, system.walls, system.pose).effective_radius

    def smallest_gap(self) -> float | None:
        """Largest of the smallest gaps that the scene asks for in these contacts, None if it asks for none [length]."""
        return max((one.smallest_gap for one in self.interactions if one.smallest_gap is not None), default=None)

    def names(self, row: int) -> tuple[str, str]:
        """Names of the two surfaces."""
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


class RepresentativeContacts(NamedTuple):
    """Contacts made up of bodies ``at_walls`` or with each other in which the same ``interactions`` act; none is where
    there are walls or pairs that no law keeps apart. ``pressing`` (m,): the part of the weight that acts across [1]."""

    at_walls: bool
    interactions: tuple[Interaction, ...]
    contacts: Contacts
    pressing: FloatArray


def representative_contacts(system: System) -> Iterator[RepresentativeContacts]:
    """Contacts of bodies with the wall that their weight presses them on, or else any wall, and then with each other,
    grouped by the interactions that act together."""
    bodies = representatives(system)
    moving = free(system, bodies)
    if system.walls and moving:
        contacts = wall_contacts(system, moving, [_pressing_wall(system, body) for body in moving])
        yield from _group_by_interactions(system, True, contacts, _pressing_share(system, moving, contacts))
    contacts = pair_contacts(system, bodies)
    if len(contacts):
        yield from _group_by_interactions(system, False, contacts, np.ones(len(contacts)))


def design_contacts(system: System) -> Iterator[DesignContacts]:
    """Representative contacts in which a law that repels acts, with the loads and speeds expected of them."""
    kind = {body: number for number, alike in enumerate(body_classes(system)) for body in alike}
    for design in representative_contacts(system):
        law = acting_together(design.interactions)
        if law is not None and law.keeps_apart:
            yield _design(system, law, design, kind)


def _group_by_interactions(
    system: System, at_walls: bool, contacts: Contacts, pressing: FloatArray
) -> Iterator[RepresentativeContacts]:
    acts = np.array([interaction.acts_in(contacts) for interaction in system.interactions]).reshape(-1, len(contacts))
    for acting in dict.fromkeys(map(tuple, acts.T.tolist())):
        here = np.all(acts == np.array(acting)[:, None], axis=0)
        together = tuple(one for one, acting_here in zip(system.interactions, acting, strict=True) if acting_here)
        yield RepresentativeContacts(at_walls, together, select(contacts, here), pressing[here])


def _pressing_wall(system: System, body: int) -> Wall:
    return max(system.walls, key=lambda wall: -float(facing_normal(system, body, wall.shape) @ system.weight[body]))


def _pressing_share(system: System, bodies: list[int], contacts: Contacts) -> FloatArray:
    """The part of the weight of each of m ``bodies`` that presses it on its wall, (m,) [1]."""
    weight = system.weight[bodies]
    pull, whole = -np.einsum("md,md->m", contacts.normal, weight), np.linalg.norm(weight, axis=1)
    share: FloatArray = np.divide(np.maximum(pull, 0.0), whole, out=np.zeros(len(bodies)), where=whole > 0.0)
    return share


def _design(system: System, law: ForceLaw, design: RepresentativeContacts, kind: Mapping[int, int]) -> DesignContacts:
    loads, contacts = system.loads, design.contacts
    nearest = [one.law.loads.smallest_gap for one in design.interactions if one.law.loads is not None]
    share = share_left(contacts, loads, law.range, max(nearest, default=law.range))
    return DesignContacts(
        system=system,
        interactions=design.interactions,
        law=law,
        at_walls=design.at_walls,
        contacts=contacts,
        weight=design.pressing * held_weight(contacts, loads),
        stacked_weight=design.pressing * stacked_weight(contacts, loads),
        pair_energy=share * pair_energy(contacts, loads),
        energy=share * impact_energy(contacts, loads),
        speed=closing_speed(contacts, loads),
        inverse_mass=inverse_mass(contacts, loads),
        kind=kind,
    )
