"""Time that a run is expected to take."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

from rigidfluid.checks.finding import Figures, Finding
from rigidfluid.checks.machine_speed import machine_speed
from rigidfluid.checks.run_size import RunSize
from rigidfluid.core.model.system import System
from rigidfluid.core.scene.run_tables import TimeTable

QUESTION = "time"

_SPREAD = 0.6, 4.5
"""CPU time of whole runs over that of their steps in smooth motion and of their meshes. The most is that of many bodies
in contact, where steps are solved again, halved and divided."""

_MESH_SECONDS = {2: 3e-5, 3: 4e-4}
"""CPU seconds for each cell of a new mesh, the fluid carried over."""

_CONTACT_SECONDS = {True: 0.005, False: 0.1}
"""CPU seconds of a step through contacts of balls alone, and of other shapes, whose gaps take long to find."""

_DRY_SECONDS = 5e-4, 1e-3
"""CPU seconds of a step without a fluid, in the program and not for each body."""

_DRY_CONTACT_SECONDS = {True: 0.0015, False: 0.15}
"""The most CPU seconds for each body of a step through contacts without a fluid, of balls alone and of other shapes."""

_IMPLICIT_SECONDS = 0.04
"""The most CPU seconds that an implicit step without a fluid takes besides these: its iterations take about as long for
few bodies as for many."""

_UNITS = ((172800.0, 86400.0, "days"), (7200.0, 3600.0, "h"), (120.0, 60.0, "min"), (0.0, 1.0, "s"))


def run_time_findings(size: RunSize, system: System, time: TimeTable) -> Iterator[Finding]:
    """Predict the least and the greatest time of one core of this machine that a run takes."""
    steps = _steps(time)
    speed = machine_speed()
    of_cell, contact = _MESH_SECONDS[system.dimension], 0.0
    if system.law is not None:
        contact = _CONTACT_SECONDS[bool(system.balls.all())]
    parts = zip(_SPREAD, (size.start, size.most), (size.start_cost, size.most_cost), strict=True)
    least, most = (
        share * (steps * cost.step_seconds + size.meshes * (of_cell * count.cells + cost.seconds)) / speed
        for share, count, cost in parts
    )
    most += steps * contact / speed
    found: Figures = {"steps": steps, "meshes": size.meshes, "least": least, "most": most, "speed": speed}
    taken = time_in_words(least, most)
    text = f"{steps} steps and some {size.meshes} meshes take {taken} of one core at its present speed"
    yield Finding("note", QUESTION, (), text, found=found)


def dry_run_time_findings(system: System, time: TimeTable) -> Iterator[Finding]:
    """Predict the least and the greatest time of one core of this machine that a run without a fluid takes."""
    steps, speed = _steps(time), machine_speed()
    least, most = (steps * seconds / speed for seconds in _DRY_SECONDS)
    if system.law is not None:
        most += steps * len(system.bodies) * _DRY_CONTACT_SECONDS[bool(system.balls.all())] / speed
    if system.implicit:
        most += steps * _IMPLICIT_SECONDS / speed
    found: Figures = {"steps": steps, "meshes": 0, "least": least, "most": most, "speed": speed}
    text = f"{steps} steps without a fluid take {time_in_words(least, most)} of one core at its present speed"
    yield Finding("note", QUESTION, (), text, found=found)


def _steps(time: TimeTable) -> int:
    """Number of steps of the nominal length."""
    return ceil(time.end / time.step * (1.0 - 1e-12))


def time_in_words(least: float, most: float) -> str:
    """A time between two [s], in the unit that suits it."""
    _, unit, name = next(row for row in _UNITS if most >= row[0])
    shortest, longest = (float(f"{time / unit:.2g}") for time in (least, most))
    return f"{shortest:g} to {longest:g} {name}"
