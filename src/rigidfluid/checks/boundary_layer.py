"""Are there cells across the boundary layers of moving bodies?"""

from __future__ import annotations

from collections.abc import Iterator

from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.mechanics.boundary_layer import CELLS_WANTED
from rigidfluid.core.mesh.generation.layer_cells import FEWEST_CELLS, thinnest_layer
from rigidfluid.core.model.system import System
from rigidfluid.core.scene.mesh_tables import MeshTable

QUESTION = "layer"


def layer_findings(system: System, mesh: MeshTable) -> Iterator[Finding]:
    """Compare the thickness d/√Re of the thinnest boundary layer, at the expected speeds, with the cells on its body,
    in a fluid with inertia; a warning where less than one cell fits."""
    problem, speeds = system.fluid, system.loads.travel_speed
    if problem is None or not problem.inertia or speeds is None:
        return
    layer = thinnest_layer(system.bodies, speeds, problem.kinematic_viscosity, mesh.size_body)
    if layer is None:
        return
    name = system.surfaces[layer.body]
    found = {"reynolds": layer.reynolds, "thickness": layer.thickness, "cells": layer.cells}
    text = f"{name}: {figure(layer.cells)} cells across a boundary layer of {figure(layer.thickness)}, at the Reynolds"
    text += f" number of {figure(layer.reynolds)} that its speed may reach"
    if layer.cells >= CELLS_WANTED:
        yield Finding("note", QUESTION, (name,), text, found=found)
        return
    size = layer.thickness / CELLS_WANTED
    text += f"; {CELLS_WANTED:g} are wanted, for forces and torques that do not change at new meshes"
    enough = {"size_body": size}
    if layer.cells >= FEWEST_CELLS:
        text += f": mesh.size_body = {round_down(size)}"
        yield Finding("note", QUESTION, (name,), text, found=found, enough=enough)
        return
    remedy = f'Set mesh.size_body to {round_down(size)} or less, or to "auto".'
    yield Finding("warning", QUESTION, (name,), text, remedy, found, enough)
