"""Bodies that are due to enter or leave, by the sources and sinks of a scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from rigidfluid.core.case.moment import Moment
from rigidfluid.core.case.population import Population
from rigidfluid.core.case.sinks import leaving_bodies
from rigidfluid.core.model.types import Pose
from rigidfluid.core.scene.exchange_tables import SourceTable
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.placement import Others
from rigidfluid.core.seeding.seed import Occupied, Seeded, seed
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import SceneError

_SOURCES = 1_000_000
"""First number of draws of sources: swarms have lower ones."""


def population_due(now: Moment) -> Population:
    """The population with those who are due to leave or enter now; the same if nobody is. Raises SceneError for a
    source whose next body has no room in its region even without others."""
    population, leaving = now.population, leaving_bodies(now)
    if not leaving and not any(missing(table, population, now.time) for table in now.model.source_tables):
        return population
    for row in leaving:
        population = population.without(now.system.surfaces[row])
    others = _others(now, leaving)
    for number in range(len(now.model.source_tables)):
        population, others = _after_source(now, number, population, others)
    return population


def _others(now: Moment, leaving: Sequence[int]) -> Others:
    """Bodies that stay, and their images across periodic surfaces, in and next to the domain."""
    stay, lattice = np.setdiff1d(np.arange(len(now.system.bodies)), leaving), now.system.lattice
    offsets = np.array(list(product((0, -1, 1), repeat=len(lattice.vectors))), dtype=np.int64)
    wrapped, rows = lattice.wrapped(now.state.pose.position[stay]), np.tile(stay, len(offsets))
    position = (lattice.displacement(offsets)[:, None] + wrapped).reshape(-1, wrapped.shape[1])
    return Others(tuple(now.system.bodies[row] for row in rows), Pose(position, now.state.pose.orientation[rows]))


def _after_source(now: Moment, number: int, population: Population, others: Others) -> tuple[Population, Others]:
    """Population and bodies with those that are due from one source, as far as there is room for them."""
    source = now.model.source_tables[number]
    for count in missing(source, population, now.time):
        try:
            found = _seeded(now.model, number, count, others)
        except SceneError:
            body_alone(now.model, number, count)  # without room even alone it would wait for ever
            break
        population, others = population.with_body(_named(found, source, count), now.time), found.bodies
    return population, others


def missing(source: SourceTable, population: Population, time: float) -> list[int]:
    """Counts of the bodies of a source that are due by a ``time`` and have not entered."""
    known = {table["name"] for table in population.entered}
    return [count for count in range(source.due(time)) if f"{source.name}{count}" not in known]


def body_alone(model: Model, number: int, count: int) -> Mapping[str, Any]:
    """Table of the body of that ``count`` from a source, where nobody else is; raises SceneError or PluginError where
    the source is wrong or the body has no room."""
    nobody = Others((), Pose(np.zeros((0, model.dimension)), np.zeros((0, 1 if model.dimension == 2 else 4))))
    return _named(_seeded(model, number, count, nobody), model.source_tables[number], count)


def _named(found: Seeded, source: SourceTable, count: int) -> Mapping[str, Any]:
    return {**found.tables[0], "name": f"{source.name}{count}"}


def _seeded(model: Model, number: int, count: int, others: Others) -> Seeded:
    draws = Draws(model.seed, _SOURCES + number, count)
    occupied = Occupied(model.domain, others, model.domain.alone, model.registry)
    return seed(model.source_tables[number].swarm(count), f"source.{number}", draws, occupied, grow=False)
