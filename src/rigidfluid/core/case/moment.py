"""Moment of a run, at which bodies may enter and leave."""

from __future__ import annotations

from typing import NamedTuple

from rigidfluid.core.case.population import Population
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.seeding.regions import Region
from rigidfluid.core.setup.model import Model

SinkRegions = tuple[Region | None, ...]
"""Regions of the sinks of a scene, None for one without."""


class Moment(NamedTuple):
    """A run at a ``time``: its ``model``, ``system``, ``state``, the ``population`` until then, and the regions of its
    sinks."""

    model: Model
    system: System
    state: State
    population: Population
    time: float
    sink_regions: SinkRegions
