"""Results of a run as it has them in memory, like those of a folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rigidfluid.core.case.load import scene_of_results
from rigidfluid.core.case.population import Population, assemble_ever
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.output.history import History
from rigidfluid.core.output.vtu import read_pvd
from rigidfluid.core.output.writer import SERIES
from rigidfluid.core.setup.description import refuse_description
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.state_tables import bodies_by_state

if TYPE_CHECKING:
    from rigidfluid.core.run.simulation import Simulation

_REMEDY = "Give the Simulation."


def results_of(run: Simulation | History) -> Results:
    """Results of a simulation until now, or of a run that has ended, without energies, joints and contacts.

    Raises OutputError for a run without bodies, and for the history of one that goes on or whose model was made in
    Python: it does not know its bodies.
    """
    if not isinstance(run, History):
        return _results(run.history, run.origin, run.population)
    if run.folder is not None:
        return read_results(run.folder, motion_only=True)
    summary = run.summary
    if not summary:
        raise OutputError("history", "that of a run which goes on", "one with a summary", _REMEDY)
    refuse_description(summary["scene"], Path("history"), _REMEDY)
    changes: dict[str, Any] = summary.get("population", Population().changes)
    return _results(run, model_of(scene_of_results(summary["scene"])), Population.from_dict(changes))


def _results(history: History, origin: Model, population: Population) -> Results:
    """Results of a run that began with the model ``origin``, whose bodies have changed since as the population says."""
    table = history.bodies
    there = set(table["body"].tolist())
    model = population.ever(origin, there) if population else origin
    system = assemble_ever(model)
    names = (*system.surfaces[: len(system.bodies)], *system.motions.names)
    if not names:
        raise OutputError("history", "no bodies", "a run of bodies", "Read the fields and energies of the run itself.")
    found = bodies_by_state(table, names, Path("bodies"))
    count, folder = len(system.bodies), history.folder
    return Results(
        summary=history.summary,
        model=model,
        system=system,
        time=found["time"][:, 0],
        bodies={name: values[:, :count] for name, values in found.items()},
        energy={},
        series=() if folder is None or not (folder / SERIES).exists() else read_pvd(folder / SERIES),
        wholes={name: values[:, count:] for name, values in found.items()},
        contact_counts=np.zeros(0),
        folder=Path() if folder is None else folder,
    )
