"""Stiffness parameters that `auto` has chosen, and the loads they follow from."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from rigidfluid.core.contact.laws.loads import closing_speed, impact_energy, stacked_weight
from rigidfluid.core.contact.laws.repulsion import AUTO, Repulsion
from rigidfluid.core.contact.laws.work_to_stop import share_left
from rigidfluid.core.contact.pairs.representative_contacts import free, pair_contacts, representatives, wall_contacts
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Loads
from rigidfluid.core.model.wrapped_law import bare


def chosen_strengths(system: System) -> list[dict[str, Any]]:
    """Values of ε that `auto` has computed: the largest and the smallest at walls, and the same between bodies; none
    where the scene gives numbers.

    Each row has ``between`` (two names), ``epsilon``, ``impact_speed``, ``impact_energy``, ``weight_work`` and
    ``smallest_gap``.
    """
    return [row for interaction in system.interactions for row in _chosen(system, interaction)]


def _chosen(system: System, interaction: Interaction) -> Iterator[dict[str, Any]]:
    law = bare(interaction.law)
    if not isinstance(law, Repulsion) or law.loads is None:
        return
    between, at_walls = law.options.epsilon, law.options.epsilon_wall
    bodies = representatives(system)
    if system.walls and (at_walls or between) == AUTO:
        moving = free(system, bodies)
        own = {surface for group in interaction.surfaces for surface in group}
        wall = next((wall for wall in system.walls if wall.surface in own), system.walls[0])
        contacts = wall_contacts(system, moving, [wall] * len(moving))
        yield from _extremes(system, law, law.loads, select(contacts, interaction.acts_in(contacts)))
    if between == AUTO:
        contacts = pair_contacts(system, bodies)
        yield from _extremes(system, law, law.loads, select(contacts, interaction.acts_in(contacts)))


def _extremes(system: System, law: Repulsion, loads: Loads, contacts: Contacts) -> Iterator[dict[str, Any]]:
    if len(contacts) == 0:
        return
    epsilon = law.epsilon(contacts)
    speed = closing_speed(contacts, loads)
    energy = impact_energy(contacts, loads) * share_left(contacts, loads, law.range, loads.smallest_gap)
    work = stacked_weight(contacts, loads) * (law.range - loads.smallest_gap)
    for i in sorted({int(np.argmax(epsilon)), int(np.argmin(epsilon))}):
        yield {
            "between": [system.surfaces[contacts.body_a[i]], _other(system, contacts, i)],
            "epsilon": float(epsilon[i]),
            "impact_speed": float(speed[i]),
            "impact_energy": float(energy[i]),
            "weight_work": float(work[i]),
            "smallest_gap": loads.smallest_gap,
        }


def _other(system: System, contacts: Contacts, i: int) -> str:
    """Name of the second surface; all walls are alike."""
    b = int(contacts.body_b[i])
    return system.surfaces[b] if b < len(system.bodies) else "wall"
