"""Remarks of a run's summary, those on boundary layers that its cells did not resolve, and on sources."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rigidfluid.core.case.population import Population
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.boundary_layer import CELLS_WANTED
from rigidfluid.core.mesh.generation.layer_cells import FEWEST_CELLS, thinnest_layer
from rigidfluid.core.model.system import System
from rigidfluid.core.output.history import History
from rigidfluid.core.setup.model import Model


@dataclass(frozen=True, slots=True)
class Remark:
    """A ``warning``, where results may be wrong, or a ``note``; what to do in ``remedy``."""

    grade: Literal["warning", "note"]
    text: str
    remedy: str


def layer_remarks(system: System, highest_speed: FloatArray, size_body: float | None) -> list[Remark]:
    """Remark if fewer than two cells lay across the thinnest boundary layer, by the ``highest_speed`` (n,) that bodies
    had [length/time], or the flow given past them; no remark in Stokes flow, nor without a fluid, where there is no
    ``size_body`` [length]."""
    problem = system.fluid
    if size_body is None or problem is None or not problem.inertia:
        return []
    speeds = np.maximum(highest_speed, system.loads.flow_speed)
    layer = thinnest_layer(system.bodies, speeds, problem.kinematic_viscosity, size_body)
    if layer is None or layer.cells >= CELLS_WANTED:
        return []
    text = (
        f"the boundary layer of {system.surfaces[layer.body]!r}, {layer.thickness:.3g} at its highest Reynolds number "
        f"of {layer.reynolds:.3g}, had {layer.cells:.2g} cells across, so that forces and torques change at new meshes"
    )
    remedy = f"Set mesh.size_body to {layer.thickness / CELLS_WANTED:.2g} or less and compare."
    return [Remark("note" if layer.cells >= FEWEST_CELLS else "warning", text, remedy)]


def source_remarks(model: Model, population: Population, time: float) -> list[Remark]:
    """Note each source with bodies that were due by a ``time`` and had no room."""
    if not model.source_tables:
        return []
    from rigidfluid.core.case.population_due import missing  # few scenes have any

    waiting = {source.name: len(missing(source, population, time)) for source in model.source_tables}
    return [
        Remark(
            "note",
            f"the source {name!r} had no room in its region for {count} that were due",
            "Widen source.region, or let bodies enter more seldom.",
        )
        for name, count in waiting.items()
        if count
    ]


def sensitivity_remarks(ended: str | None, history: History) -> list[Remark]:
    """Note that derivatives have ``ended`` before the run, and when."""
    if ended is None:
        return []
    times = history.sensitivities["time"]
    until = f"end at time {times[-1]:.6g}" if len(times) else "have no rows"
    remedy = "Differentiate from there on by runs with two values, or keep the mesh and bodies apart for longer."
    return [Remark("note", f"sensitivities {until}, as {ended}", remedy)]
