"""Errors of meshes beside their estimates, and cells that follow the estimate beside graded ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from page_tools.places import SCENES

import rigidfluid
from rigidfluid.api import FloatArray, Scene
from rigidfluid.core.geometry.quadratic_cells import mean_products
from rigidfluid.core.mesh.location import CellFinder
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.cell_gradients import velocity_gradients
from rigidfluid.core.output.vtu import read_pvd, read_vtu

DRAG, COEFFICIENT, VISCOSITY = 5.57953523384, 500.0, 0.001
"""Drag coefficient of DFG 2D-1 (John and Matthies 2001), over the force [1/N], and the viscosity [kg/s]."""
EDGES = tuple(0.016 * 2.0 ** (-i / 2) for i in range(9))
"""Edges on the body, as large as 20 times that far from it, at most .1 [m]."""
ACCURACIES = tuple(0.12 * 2.0 ** (-i / 2) for i in range(8))
SQUARES = tuple(0.12 * 2.0 ** (-i / 2) for i in range(6))
STEADY, AUTO = ("fluid.initial=steady", "time.step=0.25"), ("mesh.size=auto", "mesh.size_body=auto")
REFERENCE = ("mesh.size=0.01", "mesh.size_body=0.001", "mesh.growth=0.06", "time.end=0.25", "output.every=0.25")
CORNERS = [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]]
"""Those of a square in place of the cylinder [m]."""
FALL = ("time.step=0.004", "time.end=0.24", "output.every=0.02")
DISKS = ((0.4, 0.045), (0.3, 0.03), (0.2, 0.02), (0.15, 0.014), (0.15, 0.01), (0.1, 0.007))
"""Edges far from the falling disk and on it [cm]."""
FALLS = (0.1, 0.07, 0.05, 0.035, 0.025)
FINEST = ("mesh.size=0.06", "mesh.size_body=0.004", "mesh.growth=0.1")


class Case(NamedTuple):
    """A run on a ``mesh`` of so many ``cells``, of which a part would do if their errors were equal, the ``fewest``:
    relative errors, how many new meshes, and CPU time [s]."""

    mesh: str
    cells: float
    fewest: float
    estimate: float
    true: float
    figure: float
    meshes: int
    seconds: float


class Subject(NamedTuple):
    """An ``error`` of cases on ``graded`` meshes and on those ``by_error``, and the values of it that are compared."""

    name: str
    graded: list[Case]
    by_error: list[Case]
    error: Callable[[Case], float]
    values: tuple[float, ...]


def page(work: Work) -> Page:
    """All flows, and how many cells each way takes."""
    steady, sharp, falling = cylinders(work), squares(work), disks(work)
    subjects = [
        Subject("cylinder, gradients and pressure", *steady, lambda case: case.true, (0.05, 0.03, 0.02, 0.015, 0.01)),
        Subject("cylinder, drag", *steady, lambda case: case.figure, (3e-4, 1e-4, 3e-5, 1e-5)),
        Subject("square, gradients and pressure", *sharp, lambda case: case.true, (0.09, 0.07)),
        Subject("square, drag", *sharp, lambda case: case.figure, (5e-4, 3e-4)),
        Subject("falling disk, estimate", *falling, lambda case: case.estimate, (0.06, 0.04, 0.03)),
        Subject("falling disk, speed", *falling, lambda case: case.figure, (1e-4, 5e-5, 2e-5)),
    ]
    found = [case.estimate / case.true for cases in (*steady, *sharp) for case in cases]
    text = ABOUT.format(
        least=min(found),
        greatest=max(found),
        cells=table(NUMBERS, (row for subject in subjects for row in compared(subject))),
        cylinders=table(COLUMNS, [steady_row(case) for cases in steady for case in cases]),
        squares=table(COLUMNS, [steady_row(case) for cases in sharp for case in cases]),
        disks=table(FALLING, [disk_row(case) for cases in falling for case in cases]),
    )
    return Page("Cells that follow an estimate of their error", text, {"": errors_over_cells(subjects)})


def compared(subject: Subject) -> Iterator[tuple[str, ...]]:
    """Cells to each value of the error by both ways, and their ratio."""
    for value in subject.values:
        graded, by_error = (cells_for(cases, subject.error, value) for cases in (subject.graded, subject.by_error))
        cells = ("not reached" if np.isnan(each) else f"{each:.0f}" for each in (graded, by_error))
        ratio = "" if np.isnan(by_error / graded) else f"{by_error / graded:.2f}"
        yield subject.name, f"{value:g}", *cells, ratio


def cells_for(cases: Sequence[Case], error: Callable[[Case], float], value: float) -> float:
    """Cells from which on no error is above a value, between cases by powers; not a number where none is."""
    cells = np.array([case.cells for case in cases])
    left = np.maximum.accumulate([error(case) for case in reversed(cases)])[::-1]
    if not left[-1] <= value <= left[0]:
        return float("nan")
    after = int(np.argmax(left <= value))
    pair = slice(max(after - 1, 0), after + 1)
    return float(np.exp(np.interp(-np.log(value), -np.log(left[pair]), np.log(cells[pair]))))


def cylinders(work: Work) -> tuple[list[Case], list[Case]]:
    """DFG 2D-1 on graded meshes, and on those of accuracies."""
    exact = latest(work.run("finest", cylinder(*REFERENCE)))
    return (
        [steady_case(work, label, cylinder(*mesh), exact, DRAG) for label, mesh in graded_meshes("")],
        [steady_case(work, label, cylinder(*mesh), exact, DRAG) for label, mesh in meshes_by("", ACCURACIES, 12.0)],
    )


def squares(work: Work) -> tuple[list[Case], list[Case]]:
    """The same with a square, whose corners take ever finer cells."""
    ((_, mesh),) = meshes_by("", (0.006,), 20.0)
    run = work.run("square_finest", square(*mesh))
    exact, drag = latest(run), COEFFICIENT * run.history.bodies["fx"][-1]
    return (
        [steady_case(work, label, square(*mesh), exact, drag) for label, mesh in graded_meshes("square_")],
        [steady_case(work, label, square(*mesh), exact, drag) for label, mesh in meshes_by("square_", SQUARES, 30.0)],
    )


def graded_meshes(prefix: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Names and overrides of runs on graded meshes."""
    for edge in EDGES:
        sizes = f"mesh.size_body={edge:.4g}", f"mesh.size={min(20.0 * edge, 0.1):.4g}"
        yield f"{prefix}graded_{edge:.2g}", ("mesh.estimate=true", *sizes, "time.end=0.25", "output.every=0.25")


def meshes_by(prefix: str, accuracies: Iterable[float], end: float) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Names and overrides of runs up to an ``end`` on meshes by accuracy."""
    for accuracy in accuracies:
        times = f"time.end={end}", f"output.every={end / 3.0}"
        yield f"{prefix}accuracy_{accuracy:.2g}", (f"mesh.accuracy={accuracy:.4g}", *AUTO, *times)


def cylinder(*overrides: str) -> Scene:
    """The scene of DFG 2D-1 from its steady state."""
    return rigidfluid.load_scene(SCENES / "dfg_cylinder.toml", [*STEADY, *overrides])


def square(*overrides: str) -> Scene:
    """The same with a square of the cylinder's width."""
    tables = cylinder(*overrides).to_dict()
    body = {"name": "square", "type": "polygon", "points": CORNERS, "density": 1.0, "position": [0.2, 0.2]}
    output = {"every": tables["output"]["every"]}
    return rigidfluid.scene_from_dict(
        tables | {"scene": {"name": "square", "dimension": 2}, "body": [body | {"fixed": True}], "output": output}
    )


def steady_case(work: Work, label: str, scene: Scene, exact: Fields, drag: float) -> Case:
    """A case of a steady flow."""
    run = work.run(label, scene)
    history = run.history
    errors, fields = history.mesh_error, latest(run)
    wrong = abs(float(COEFFICIENT * history.bodies["fx"][-1] / drag - 1.0))
    true = float(np.sqrt(squared_error(fields, exact) / errors["dissipation"][-1]))
    cells, meshes = len(fields.cells), int(run.summary["remeshes"])
    mesh = label.removeprefix("square_").replace("_", " ")
    return Case(mesh, cells, fewest(fields), float(errors["relative"][-1]), true, wrong, meshes, run.cpu_seconds)


def fewest(fields: Fields) -> float:
    """Part of the cells that would do for the same estimate if all errors were equal, which go with the sixth power of
    the edge."""
    assert fields.cell_errors is not None
    part = fields.cell_errors / fields.cell_errors.sum()
    return float(np.sum(np.cbrt(part)) ** 1.5 / len(part))


def latest(run: Run) -> Fields:
    """The fields at the end."""
    return read_vtu(read_pvd(run.folder / "fields.pvd")[-1][1])


def squared_error(fields: Fields, exact: Fields) -> float:
    """μ‖∇e‖² + ‖e_p‖²/μ over the finer cells of the ``exact`` flow, the other one read at their nodes [W/m]."""
    nodes, vertices = exact.points[exact.cells], fields.cells[:, :3]
    cell, place = CellFinder(fields.points, vertices).find(nodes.reshape(-1, 2))
    slopes = np.einsum("nk,nkij->nij", place, velocity_gradients(fields)[cell, :3])
    pressure = np.einsum("nk,nk->n", place, fields.pressure[vertices[cell]]).reshape(nodes.shape[:2])
    wrong = slopes.reshape(*nodes.shape, 2) - velocity_gradients(exact)
    between = (pressure - exact.pressure[exact.cells])[..., None]
    return VISCOSITY * integral(exact, wrong.reshape(*nodes.shape[:2], 4)) + integral(exact, between) / VISCOSITY


def integral(fields: Fields, values: FloatArray) -> float:
    """∫ |v|² of quadratic ``values`` (M, 6, c) of cells."""
    volumes = np.abs(cell_volumes(fields.points, fields.cells[:, :3]))
    return float(np.einsum("m,mac,ab,mbc->", volumes, values, mean_products(3), values))


def disks(work: Work) -> tuple[list[Case], list[Case]]:
    """The falling disk on graded meshes, and on those of accuracies; errors of its speed."""
    known = work.run("disk_finest", "falling_disk.toml", [*FALL, *FINEST]).history.bodies["vy"]
    graded = [
        of_disk(work, f"disk_{edge:g}", f"{edge:g} cm", known, f"mesh.size={far}", f"mesh.size_body={edge}",
                "mesh.estimate=true")
        for far, edge in DISKS
    ]  # fmt: skip
    by_error = [
        of_disk(work, f"disk_accuracy_{accuracy:g}", f"accuracy {accuracy:g}", known, f"mesh.accuracy={accuracy}",
                "mesh.size=auto", "mesh.size_body=auto")
        for accuracy in FALLS
    ]  # fmt: skip
    return graded, by_error


def of_disk(work: Work, label: str, mesh: str, known: FloatArray, *overrides: str) -> Case:
    """A case of the falling disk: the root mean square of the error of its speed, over that at the end."""
    run = work.run(label, "falling_disk.toml", [*FALL, *overrides])
    history = run.history
    wrong = float(np.sqrt(np.mean((history.bodies["vy"] - known) ** 2)) / abs(known[-1]))
    cells = float(history.steps["cells"].mean())
    estimate = float(np.median(history.mesh_error["relative"]))
    return Case(mesh, cells, np.nan, estimate, np.nan, wrong, int(run.summary["remeshes"]), run.cpu_seconds)


NUMBERS = ("error of", "at most", "graded", "by accuracy", "ratio")
COLUMNS = ("mesh", "cells", "fewest", "new meshes", "estimate", "true", "effectivity", "drag", "CPU s")
FALLING = ("mesh", "cells in the mean", "new meshes", "estimate, in the middle", "speed", "CPU s")


def steady_row(case: Case) -> tuple[str, ...]:
    """A row of the tables of steady flows."""
    errors = f"{case.estimate:.4f}", f"{case.true:.4f}", f"{case.estimate / case.true:.2f}", f"{case.figure:.1e}"
    return case.mesh, f"{case.cells:.0f}", f"{case.fewest:.2f}", str(case.meshes), *errors, f"{case.seconds:.1f}"


def disk_row(case: Case) -> tuple[str, ...]:
    """A row of the table of falling disks."""
    errors = f"{case.estimate:.3f}", f"{case.figure:.1e}"
    return case.mesh, f"{case.cells:.0f}", str(case.meshes), *errors, f"{case.seconds:.1f}"


def errors_over_cells(subjects: Sequence[Subject]) -> Figure:
    """The errors of each subject over its cells, for both ways."""
    figure = Figure(figsize=(8.0, 9.0), dpi=120, layout="constrained")
    for axes, subject in zip(figure.subplots(3, 2).ravel(), subjects, strict=True):
        axes.set(title=subject.name, xlabel="cells", ylabel="relative error", xscale="log", yscale="log")
        for name, cases in (("graded", subject.graded), ("by accuracy", subject.by_error)):
            axes.plot([case.cells for case in cases], [subject.error(case) for case in cases], "o-", label=name)
    for axes, subject in list(zip(figure.axes, subjects, strict=True))[:3:2]:
        for colour, cases in zip(("C0", "C1"), (subject.graded, subject.by_error), strict=True):
            cells, estimates = zip(*[(case.cells, case.estimate) for case in cases], strict=True)
            axes.plot(cells, estimates, "x:", color=colour, label="estimated")
        axes.legend()
    return figure


ABOUT = """
With `mesh.estimate` a run estimates [the error of its mesh](../howto/mesh-by-error.md), and with `mesh.accuracy` cells
follow the estimate. Here it is beside the true error, and such cells are beside graded ones: an edge on the body, and
`growth = 0.2`, the default.

**The estimate** is {least:.2f} to {greatest:.2f} times the true error of velocity gradients and pressure, on all
meshes of the cylinder and of the square, graded or not.

**Cells** from which on the error is no greater:

{cells}

At the same error of gradients and pressure, which is what the estimate is of, cells that follow it are fewer. Around
the cylinder they are half of the graded ones at 1.5 %, and less below. With coarser cells they are more, and must be:
graded ones suit a single round body so well that up to some 2,500 of them no isotropic cells of the same estimate are
fewer than half, as the column `fewest` below tells. Those by accuracy are near the fewest. Around a square, whose
corners no grading by the distance knows of, they are less than a third.

They are not made for drag, as [cells for forces](mesh_for_forces.md) are: its error goes with the square of that error,
weighted by where the flow acts on the body, and through zero as cells change. Graded meshes do as well until it is 1e-4
of the cylinder's drag, and about as well for the square. In the first steps of the fall all accuracies have the same
coarse mesh, which leaves an error of 4e-5 in the speed.

Greater upper bounds do not help: with `growth = 0.5` the first mesh of the cylinder has 579 cells in place of 799, and
the last ones have 830 with an estimate of .079, 1,459 with .043 and 2,780 with .020.

## Steady flow past a cylinder

`scenes/dfg_cylinder.toml` from its steady state in steps of .25 s, with edges on the cylinder as given and 20 times as
long far away, at most .1 m, so that .0014 m is about the scene as shipped; or `mesh.size = "auto"` and an accuracy, up
to 12 s. The true error is the distance from the flow on cells of .001 m with `growth = 0.06`, in the norm
√(μ‖∇e‖² + ‖e_p‖²/μ), over the root of the dissipation. Drag is compared with John and Matthies (2001).

{cylinders}

## A square in place of the cylinder

With the same width; up to 30 s. All are compared with cells for an accuracy of .006. New meshes are more: the errors
of cells at corners are of lower order than is taken of all.

{squares}

## A falling disk

`scenes/falling_disk.toml` to .24 s in steps of 4 ms. The error of the speed is its root mean square over all steps,
over the speed at the end, from a run with the same steps on cells of .004 cm. The start from rest has a thin layer: the
cells that it takes are too many later, and are kept for twenty steps.

{disks}
"""
