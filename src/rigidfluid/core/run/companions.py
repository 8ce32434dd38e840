"""Runs that go along with a run for what its scene wants to know of it: sensitivities, and error bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigidfluid.core.model.state import State
from rigidfluid.core.output.records import Records
from rigidfluid.core.run.step import Tools

if TYPE_CHECKING:
    from rigidfluid.core.run.error_bars import ErrorBars
    from rigidfluid.core.run.sensitivities import SavedNeighbours, Sensitivities
    from rigidfluid.core.run.simulation import Simulation


class Companions:
    """Companions of a run from its first state on; without any, nothing is done and nothing is loaded."""

    def __init__(self) -> None:
        self._sensitivities: Sensitivities | None = None
        self._bars: ErrorBars | None = None

    def begin_sensitivities(self, simulation: Simulation) -> None:
        """Let the neighbours begin that its scene wants, in its first state."""
        model = simulation.model
        if model.output.sensitivities:
            from rigidfluid.core.run.sensitivities import Sensitivities  # few scenes have any

            stepper = simulation.stepper
            tools = Tools(
                simulation.system, stepper.scheme, simulation.clock, simulation.mesh_updater, simulation.watch
            )
            self._sensitivities = Sensitivities(model.document, tools, simulation.state, model.output.sensitivities)

    def begin_error_bars(self, simulation: Simulation) -> None:
        """Let the run in longer steps begin, if its scene wants error bars; it takes the way from the start by
        itself."""
        if simulation.model.output.error_bars:
            from rigidfluid.core.run.error_bars import ErrorBars  # few scenes want them

            self._bars = ErrorBars(simulation)

    @property
    def sensitivities_ended(self) -> str | None:
        """Why there are no derivatives any more; None where there are, and where there have been none."""
        return None if self._sensitivities is None else self._sensitivities.ended

    @property
    def has_sensitivities(self) -> bool:
        """Tell whether there are neighbours, or have been."""
        return self._sensitivities is not None

    def follow(self, simulation: Simulation, before: State) -> None:
        """Go along with the step that has led to the present state."""
        if self._sensitivities is not None:
            with simulation.watch("sensitivities"):
                self._sensitivities.follow(simulation.system, before, simulation.state)
        if self._bars is not None:
            self._bars.note(simulation)

    def save(self) -> SavedNeighbours | None:
        """Keep the neighbours as they are now, None without any."""
        return None if self._sensitivities is None else self._sensitivities.save()

    def go_back(self, simulation: Simulation, neighbours: SavedNeighbours | None) -> None:
        """Go along with a run that has gone back to where its ``neighbours`` were saved."""
        if self._sensitivities is not None and neighbours is not None:
            self._sensitivities.go_back(neighbours)
        if self._bars is not None:
            self._bars.go_back(simulation)

    def step_rows(self, simulation: Simulation) -> Records:
        """Rows of the present state."""
        if self._sensitivities is None:
            return {}
        return {"sensitivities": list(self._sensitivities.rows((simulation.time, simulation.state.count)))}

    def output_rows(self, simulation: Simulation) -> Records:
        """Rows of the present state that are there at outputs alone; the state keeps the errors for the next ones."""
        if self._bars is None:
            return {}
        with simulation.watch("error bars"):
            rows, simulation.state = self._bars.estimate(simulation)
        return {"error_estimates": rows}
