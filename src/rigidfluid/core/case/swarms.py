"""Swarms of a scene become bodies of its own, before the scene as a whole is checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from typing import Any

from rigidfluid.core.scene.swarm_tables import SwarmTable
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.seed import Occupied, seed
from rigidfluid.errors import PluginError, SceneError


def with_seeded_bodies(
    data: Mapping[str, Any], swarms: Sequence[SwarmTable], seed_of_all: int, occupied: Occupied
) -> dict[str, Any]:
    """Tables of a scene with the bodies of its ``swarms`` after its own; each swarm avoids those before it.

    None lies across periodic surfaces where one of them all is longer than the periods. Raises SceneError or
    PluginError for swarms that are wrong or find no room.
    """
    tables, after = _seeded(data, swarms, seed_of_all, occupied)
    longest = max((body.bounding_radius for body in after.others.bodies), default=0.0)
    if 2.0 * longest >= occupied.lattice.shortest:
        tables, _ = _seeded(data, swarms, seed_of_all, replace(occupied, lattice=occupied.domain.alone))
    return tables


def _seeded(
    data: Mapping[str, Any], swarms: Sequence[SwarmTable], seed_of_all: int, occupied: Occupied
) -> tuple[dict[str, Any], Occupied]:
    """Tables with the bodies of all swarms, and what is occupied then."""
    bodies, tables = list(data.get("body", [])), []
    for number, table in enumerate(swarms):
        record = table.seeded
        if record is None:
            found = seed(table, f"swarm.{number}", Draws(seed_of_all, number), occupied)
            bodies += found.tables
            record, occupied = found.record, replace(occupied, others=found.bodies)
        tables.append({**data["swarm"][number], "seeded": record.model_dump()})
    return {**data, "body": bodies, "swarm": tables}, occupied


@contextmanager
def told_by_swarms(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[None]:
    """Name, in errors of bodies that were seeded, the swarm and the body, by the tables before and after seeding."""
    try:
        yield
    except (SceneError, PluginError) as error:
        owners = list(_owners(before, after))
        raise error.renamed(lambda subject: _renamed(subject, owners)) from None


def _owners(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[str]:
    """Place of each body that messages name: of a seeded one its swarm and name."""
    own = len(before.get("body", ()))
    yield from (f"body.{number}" for number in range(own))
    bodies = iter(after["body"][own:])
    for number, (old, new) in enumerate(zip(before["swarm"], after["swarm"], strict=True)):
        if "seeded" not in old:
            names = [body["name"] for body in islice(bodies, new["seeded"]["number"])]
            yield from (f"swarm.{number}.body {name!r}" for name in names)


def _renamed(subject: str, owners: Sequence[str]) -> str:
    key, _, rest = subject.partition(".")
    number, _, rest = rest.partition(".")
    if key != "body" or not number.isdecimal() or int(number) >= len(owners):
        return subject
    return f"{owners[int(number)]}.{rest}" if rest else owners[int(number)]
