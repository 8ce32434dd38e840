"""Cells that follow the error of forces, beside graded ones: how many an error of the force takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table

from pages.mesh_estimate import AUTO, COEFFICIENT, cylinder, square
from rigidfluid.api import FloatArray, Scene

CYLINDER = np.array([5.57953523384, 0.010618948146]) / COEFFICIENT
"""Drag and lift of DFG 2D-1 (John and Matthies 2001) [N]."""
EDGES = tuple(0.016 * 2.0 ** (-i / 4) for i in range(17))
"""Edges on the body, as large as 20 times that far from it, at most .1 [m]."""
ACCURACIES = (0.008, 0.004, 0.002, 0.001, 0.0005, 0.00025, 0.00012)
SQUARES = (0.016, 0.008, 0.004, 0.002, 0.001)
FINEST = 0.0003


class Case(NamedTuple):
    """A run on a ``mesh``, its ``cells`` at the end, how many new ``meshes`` were made, the ``error`` of the force over
    it, and CPU time [s]."""

    mesh: str
    cells: int
    meshes: int
    error: float
    seconds: float


class Subject(NamedTuple):
    """Cases on ``graded`` meshes and on those ``by_force``, and the errors for which cells are compared."""

    name: str
    graded: list[Case]
    by_force: list[Case]
    values: tuple[float, ...]


def page(work: Work) -> Page:
    """Both bodies, and how many cells each way takes."""
    subjects = [
        Subject("cylinder", *both(work, "", cylinder, CYLINDER, ACCURACIES, 12.0), (3e-4, 1e-4, 5e-5, 3e-5, 2e-5)),
        Subject("square", *both(work, "square_", square, sharp(work), SQUARES, 30.0), (6e-4, 4e-4, 3e-4, 2e-4)),
    ]
    bounds = [float(case.mesh.split()[-1]) / case.error for subject in subjects for case in subject.by_force]
    text = ABOUT.format(
        least=min(bounds),
        greatest=max(bounds),
        cells=table(NUMBERS, (row for subject in subjects for row in compared(subject))),
        cylinders=table(COLUMNS, map(row, [*subjects[0].graded, *subjects[0].by_force])),
        squares=table(COLUMNS, map(row, [*subjects[1].graded, *subjects[1].by_force])),
        finest=FINEST,
    )
    return Page("Cells that follow the error of forces", text, {"": errors_over_cells(subjects)})


def sharp(work: Work) -> FloatArray:
    """Force on the square with the finest cells [N]."""
    ((_, mesh),) = by_force("", (FINEST,), 20.0)
    return latest(work.run("square_finest", square(*mesh)).history.bodies)


def latest(bodies: dict[str, FloatArray]) -> FloatArray:
    """Force (2,) at the end [N]."""
    return np.array([bodies["fx"][-1], bodies["fy"][-1]])


def both(
    work: Work, prefix: str, scene: Callable[..., Scene], exact: FloatArray, accuracies: Sequence[float], end: float
) -> tuple[list[Case], list[Case]]:
    """A body on graded meshes, and on those of accuracies of its force."""

    def case(label: str, overrides: tuple[str, ...]) -> Case:
        run = work.run(label, scene(*overrides))
        error = float(np.linalg.norm(latest(run.history.bodies) - exact) / np.linalg.norm(exact))
        cells = int(run.history.steps["cells"][-1])
        mesh = label.removeprefix(prefix).replace("_", " ")
        return Case(mesh, cells, int(run.summary["remeshes"]), error, run.cpu_seconds)

    return (
        [case(label, mesh) for label, mesh in graded(prefix)],
        [case(label, mesh) for label, mesh in by_force(prefix, accuracies, end)],
    )


def graded(prefix: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Names and overrides of runs on graded meshes."""
    for edge in EDGES:
        sizes = f"mesh.size_body={edge:.4g}", f"mesh.size={min(20.0 * edge, 0.1):.4g}"
        yield f"{prefix}graded_{edge:.2g}", (*sizes, "time.end=0.25", "output.every=0.25")


def by_force(prefix: str, accuracies: Sequence[float], end: float) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Names and overrides of runs up to an ``end`` on meshes by the accuracy of forces."""
    for accuracy in accuracies:
        times = f"time.end={end}", f"output.every={end}"
        yield f"{prefix}accuracy_{accuracy:g}", (f"mesh.accuracy={accuracy}", 'mesh.goal="forces"', *AUTO, *times)


def compared(subject: Subject) -> Iterator[tuple[str, ...]]:
    """Cells to each value of the error by both ways, and their ratio."""
    for value in subject.values:
        found = [cells_for(cases, value) for cases in (subject.graded, subject.by_force)]
        cells = ("not reached" if np.isnan(each) else f"{each:.0f}" for each in found)
        ratio = "" if np.isnan(found).any() else f"{found[1] / found[0]:.2f}"
        yield subject.name, f"{value:g}", *cells, ratio


def cells_for(cases: Sequence[Case], value: float) -> float:
    """Cells from which on no error is above a value, between cases by powers; not a number where none is."""
    ordered = sorted(cases, key=lambda case: case.cells)
    cells, left = np.array([case.cells for case in ordered]), np.array([case.error for case in ordered])
    left = np.maximum.accumulate(left[::-1])[::-1]
    if not left[-1] <= value <= left[0]:
        return float("nan")
    after = int(np.argmax(left <= value))
    pair = slice(max(after - 1, 0), after + 1)
    return float(np.exp(np.interp(-np.log(value), -np.log(left[pair]), np.log(cells[pair]))))


NUMBERS = ("force on the", "error at most", "graded", "by the force", "ratio")
COLUMNS = ("mesh", "cells", "new meshes", "error of the force", "CPU s")


def row(case: Case) -> tuple[str, ...]:
    """A row of the tables of runs."""
    return case.mesh, str(case.cells), str(case.meshes), f"{case.error:.1e}", f"{case.seconds:.1f}"


def errors_over_cells(subjects: Sequence[Subject]) -> Figure:
    """The error of the force on each body over the cells, for both ways."""
    figure = Figure(figsize=(8.0, 3.6), dpi=120, layout="constrained")
    for axes, subject in zip(figure.subplots(1, 2), subjects, strict=True):
        axes.set(title=subject.name, xlabel="cells", ylabel="relative error of the force", xscale="log", yscale="log")
        for name, cases in (("graded", subject.graded), ("by the force", subject.by_force)):
            axes.plot([case.cells for case in cases], [case.error for case in cases], "o-", label=name)
        axes.legend()
    return figure


ABOUT = """
With `mesh.goal = "forces"` cells follow [the error of the bodies' forces](../howto/mesh-by-error.md): residuals of the
flow, weighted by dual flows. Here they are beside graded ones, an edge on the body and `growth = 0.2`, the default. The
error is that of drag and lift together, as each goes through zero when cells change.

**Cells** from which on the error is no greater:

{cells}

Around the square they are about a third of the graded ones or less. Around the cylinder they are as few where the
error is small. Where it may be 1e-4 and more they are hardly fewer, since graded ones suit a single round body.

The accuracy that was asked for is {least:.0f} to {greatest:.0f} times the error in the end: parts of the error that
cancel are not counted on, and half of it is aimed at. Graded cells err less from time to time, as their parts cancel
too, but with no warning. Each time when a mesh is judged, dual flows are solved on one of halved edges: such runs take
several times as long as steps on a mesh that stays.

## Steady flow past a cylinder

`scenes/dfg_cylinder.toml` from its steady state in steps of .25 s, with edges on the cylinder as given and 20 times as
long far away, at most .1 m; or `mesh.size = "auto"` and an accuracy, up to 12 s. Drag and lift are compared with John
and Matthies (2001).

{cylinders}

## A square in place of the cylinder

With the same width; up to 30 s. All are compared with cells for an accuracy of {finest:g}.

{squares}
"""
