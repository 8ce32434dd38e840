"""Does the run fit into memory, and how long do factors take?"""

from __future__ import annotations

from collections.abc import Iterator

from rigidfluid.checks.finding import Figures, Finding, figure
from rigidfluid.core.mesh.cell_count import expected_cells
from rigidfluid.core.model.memory import REMEDY, available_memory, gigabytes
from rigidfluid.core.model.system import System
from rigidfluid.core.run.mesh_keys import sizes_of
from rigidfluid.core.scene.scene import MeshTable

QUESTION = "memory"


def in_memory(system: System, mesh: MeshTable) -> Iterator[Finding]:
    """Compare what the backend expects to take on the mesh of the start with the memory that is available now.

    Parameters
    ----------
    system : System
        Bodies, domain and backend.
    mesh : MeshTable
        Sizes of the cells.

    Yields
    ------
    Finding
        One where the backend knows what it takes; a warning where that is more than there is.
    """
    sizes = sizes_of(mesh, system.domain)
    cells = expected_cells(system.meshed(system.pose), system.bodies, system.pose, system.walls, sizes)
    cost = system.backend.solver_cost(cells)
    if cost is None:
        return
    available = available_memory()
    found: Figures = {
        "cells": cells,
        "unknowns": cost.unknowns,
        "method": cost.method,
        "memory": cost.memory,
        "available": available,
        "seconds": cost.seconds,
    }
    text = f"about {figure(cells)} cells with {figure(cost.unknowns)} unknowns at the start; by {cost.method!r} the run"
    text += f" takes {gigabytes(cost.memory)} of memory, and {figure(cost.seconds)} s of one core each time that"
    text += " factors are made"
    if cost.memory <= available:
        yield Finding("note", QUESTION, (), text, found=found)
        return
    text += f"; {gigabytes(available)} are available"
    yield Finding("warning", QUESTION, (), text, REMEDY, found, {"memory": available})
