"""Does the run fit into memory, and how long does it take?"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

import numpy as np

from rigidfluid.checks.design_contacts import design_contacts
from rigidfluid.checks.finding import Figures, Finding, figure
from rigidfluid.checks.machine_speed import machine_speed
from rigidfluid.checks.resolution import narrowest_gaps
from rigidfluid.checks.settled_pose import settled_pose
from rigidfluid.core.mesh.cell_count import Count, expected_count
from rigidfluid.core.mesh.size_field import Sizes
from rigidfluid.core.model.memory import REMEDY, available_memory, gigabytes
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, SolverCost
from rigidfluid.core.run.mesh_keys import sizes_of
from rigidfluid.core.scene.scene import MeshTable, TimeTable
from rigidfluid.core.setup.parts import Parts

QUESTION = "memory"

_SPREAD = 0.5, 3.0
"""Least and most time of a run over that of its steps far from contacts: in contacts the fluid is solved again, steps
are halved, meshes are made."""

_TIMES = ((172800.0, 86400.0, "days"), (7200.0, 3600.0, "h"), (120.0, 60.0, "min"), (0.0, 1.0, "s"))


def in_memory(parts: Parts, system: System, mesh: MeshTable, time: TimeTable) -> Iterator[Finding]:
    """Compare what the backend expects to take with the memory that is available now, and say how long a run takes.

    The larger counts, of the mesh of the start and of that with bodies settled on walls and on each other.

    Parameters
    ----------
    parts : Parts
        For a detector that needs no mesh.
    system : System
        Bodies, domain and backend.
    mesh : MeshTable
        Sizes of the cells.
    time : TimeTable
        Steps.

    Yields
    ------
    Finding
        One where the backend knows what it takes; a warning where that is more than there is.
    """
    sizes = sizes_of(mesh, system.domain)
    start = _count(system, system.pose, sizes)
    at_start = system.backend.solver_cost(*start)
    if at_start is None:
        return
    gap = _narrowest_gap(system, sizes)
    settled = _count(system, settled_pose(system, parts.exact_detector, gap), sizes)
    most = max(start, settled)
    cost = system.backend.solver_cost(*most)
    assert cost is not None
    steps = ceil(time.end / time.step)
    available = available_memory()
    found: Figures = {
        "cells": start.cells,
        "unknowns": at_start.unknowns,
        "most_cells": most.cells,
        "most_unknowns": cost.unknowns,
        "gap": gap,
        "method": cost.method,
        "memory": cost.memory,
        "available": available,
        "seconds": cost.seconds,
        "steps": steps,
        **_run_seconds(steps, at_start, cost),
    }
    text = f"about {figure(start.cells)} cells with {figure(at_start.unknowns)} unknowns at the start, at most"
    text += f" {figure(most.cells)} with {figure(cost.unknowns)}; by {cost.method!r} the run takes"
    text += f" {gigabytes(cost.memory)} of memory, and {figure(cost.seconds)} s of one core each time that factors are"
    text += f" made; {steps} steps take {_in_words(found)} of one core"
    if cost.memory <= available:
        yield Finding("note", QUESTION, (), text, found=found)
        return
    text += f"; {gigabytes(available)} are available"
    yield Finding("warning", QUESTION, (), text, REMEDY, found, {"memory": available})


def _count(system: System, pose: Pose, sizes: Sizes) -> Count:
    return expected_count(system.meshed(pose), system.bodies, pose, system.walls, sizes)


def _narrowest_gap(system: System, sizes: Sizes) -> float:
    """The least gap that laws leave, no less than the finest cells resolve [length]."""
    gaps = [narrowest_gaps(met) for met in design_contacts(system)]
    held = np.concatenate([[np.inf], *gaps])
    least = float(np.nanmin(held))
    finest = sizes.cells_per_gap * sizes.smallest
    return finest if np.isinf(least) else max(least, finest)


def _run_seconds(steps: int, start: SolverCost, most: SolverCost) -> dict[str, float]:
    """Least and most time of the run on one core of this machine [s], NaN where the backend does not know."""
    speed = machine_speed()
    shortest, longest = (
        share * steps * cost.step_seconds / speed for share, cost in zip(_SPREAD, (start, most), strict=True)
    )
    return {"least_time": shortest, "most_time": longest}


def _in_words(found: Figures) -> str:
    least, most = float(found["least_time"] or 0.0), float(found["most_time"] or 0.0)
    _, unit, name = next(row for row in _TIMES if most >= row[0])
    return f"{least / unit:.2g} to {most / unit:.2g} {name}"
