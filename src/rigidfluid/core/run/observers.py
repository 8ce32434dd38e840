"""Functions that a run calls after its steps, each at its own times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from rigidfluid.core.run.schedule import Schedule

if TYPE_CHECKING:
    from rigidfluid.core.run.simulation import Simulation

Observer = Callable[["Simulation"], None]


class Observers:
    """Observers of one run, in the order in which they are called."""

    def __init__(self) -> None:
        self._all: list[tuple[Schedule, Observer]] = []

    def add(self, schedule: Schedule, observer: Observer) -> None:
        """Call another one, after all others, when its ``schedule`` says so."""
        self._all.append((schedule, observer))

    def call(self, simulation: Simulation) -> None:
        """Call those that are due in the present state."""
        for schedule, observer in self._all:
            if schedule.due(simulation.state.tick):
                schedule.reached(simulation.state.tick)
                observer(simulation)

    @property
    def latest(self) -> tuple[float, ...]:
        """When each was called last [time]."""
        return tuple(schedule.latest for schedule, _ in self._all)

    def go_back(self, latest: Sequence[float]) -> None:
        """Forget the calls after these times, one for each of the first observers [time]."""
        for (schedule, _), time in zip(self._all, latest, strict=False):
            schedule.latest = time
