"""A run that is kept in memory, to go back to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rigidfluid.core.case.population import Population
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FluidState
from rigidfluid.core.output.extremes import Extremes
from rigidfluid.core.run.stepper import Counts
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.run.sensitivities import SavedNeighbours


@dataclass(frozen=True)
class SavedRun:
    """A run of a ``model`` as `Simulation.save` kept it."""

    model: Model
    population: Population
    state: State
    memory: FluidState
    system: System
    counts: Counts
    extremes: Extremes
    rows: dict[str, int]
    reached: tuple[float, ...]
    neighbours: SavedNeighbours | None


def require_saved(saved: object, model: Model) -> None:
    """Raise SceneError unless this is a saved run of the ``model``."""
    if not isinstance(saved, SavedRun):
        raise SceneError("restore", repr(saved), "what save() gave", "Keep that, and restore it.")
    if saved.model is not model and saved.model.document != model.document:
        found, allowed = f"a run of {saved.model.name!r} or of other values", "one of the same scene or model"
        raise SceneError("restore", found, allowed, "Restore it in a Simulation of its own scene.")
