"""Moment of a run, at which bodies may enter and leave."""

from __future__ import annotations

from typing import NamedTuple

from rigidfluid.core.case.population import Population
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.setup.model import Model


class Moment(NamedTuple):
    """A run at a ``time``: its ``model``, ``system``, ``state``, and the ``population`` until then."""

    model: Model
    system: System
    state: State
    population: Population
    time: float
