"""Error bars beside true errors: drag and lift of DFG 2D-1, a falling disk, and a sphere that settles in oil."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from published import SETTLING_SPEED

from rigidfluid.core.output.error_figures import error_bars
from rigidfluid.core.output.history import History

BARS = "output.error_bars=true"
DRAG, LIFT = 5.57953523384, 0.010618948146
"""Coefficients of DFG 2D-1, converged (John and Matthies 2001)."""
COEFFICIENT = 500.0
"""Over the force, 2/(ρ Ū² 2R)."""
CYLINDERS = ((0.0196, 2), (0.0098, 2), (0.0049, 2), (0.0196, 1), (0.0098, 1), (0.0049, 1))
"""Edges on the cylinder [m], and the order of its cells."""
DISKS, TIMES = ((0.4, 0.06), (0.3, 0.03), (0.2, 0.016)), (0.04, 0.08, 0.16, 0.24, 0.32, 0.4, 0.48)
"""Cells far from the disk and on it [cm], and times [s]."""
FALL, FINEST = ("time.end=0.48", "output.every=0.04"), ("mesh.size=0.07", "mesh.size_body=0.005", "time.step=0.0005")
"""Of all disks, and of the run that they are compared with."""
SPHERES, SETTLING = (0.4,), ("time.end=0.8", "output.every=0.1")
"""Cells on the sphere [cm], and what all of its runs have."""
FINEST_SPHERE = ("mesh.size=1.4", "mesh.size_body=0.22", "time.step=0.01", "time.end=1.0", "output.every=0.1")
SPHERE_TIMES = (0.1, 0.2, 0.4, 0.6, 0.8)
"""Of the run that they are compared with, and times [s]."""


class Estimate(NamedTuple):
    """A ``figure`` of a ``case``: its ``true`` error, and those that are estimated by the ``mesh`` and by the
    ``steps``."""

    case: str
    figure: str
    value: float
    true: float
    mesh: float
    steps: float

    @property
    def effectivity(self) -> float:
        """The estimated error over the true one [1]."""
        return (self.mesh + self.steps) / self.true

    @property
    def holds(self) -> bool:
        """Tell whether the bar holds the reference."""
        return abs(self.true) <= self.bar

    @property
    def bar(self) -> float:
        """The error bar."""
        return float(error_bars(np.abs(self.mesh), np.abs(self.steps)))

    @property
    def is_good(self) -> bool:
        """Tell whether the estimate is half of the error to three times as much."""
        return 0.5 <= self.effectivity <= 3.0


def page(work: Work) -> Page:
    """Estimates beside true errors, and how many references the bars hold."""
    steady, falling, settling = list(of_cylinders(work)), list(of_disks(work)), list(of_spheres(work))
    found = steady + falling + settling
    named = {
        "drag and lift of a cylinder": steady,
        "speed of a disk": [each for each in falling if each.figure.startswith("speed")],
        "force on a disk": [each for each in falling if each.figure.startswith("force")],
        "speed of a sphere": [each for each in settling if each.figure.startswith("speed")],
        "force on a sphere": [each for each in settling if each.figure.startswith("force")],
    }
    text = ABOUT.format(
        summary=table(("figures", "number", "held", "median effectivity", "of .5 to 3"), summaries(named)),
        held=sum(each.holds for each in found),
        all=len(found),
        good=sum(each.is_good for each in found),
        cylinders=table(COLUMNS, map(row, steady)),
        disks=table(COLUMNS, map(row, falling)),
        spheres=table(COLUMNS, map(row, settling)),
        off=-finest_sphere(work).bodies["vz"].min() / SETTLING_SPEED - 1.0,
    )
    return Page("Error bars beside true errors", text, {"": estimates(named)})


def of_cylinders(work: Work) -> Iterator[Estimate]:
    """Coefficients of DFG 2D-1 on coarse meshes of curved and of straight cells."""
    for size, order in CYLINDERS:
        growth, far = (0.2, 0.04) if size > 0.01 else (0.1, 0.02)
        mesh = [f"mesh.size_body={size}", f"mesh.order={order}", f"mesh.growth={growth}", f"mesh.size={far}"]
        settled = ["fluid.initial=steady", "time.end=0.3", "output.every=0.3", BARS]
        history = work.run(f"cylinder_{size:g}_order_{order}", "dfg_cylinder.toml", mesh + settled).history
        case = f"cells of {size:g}, {'curved' if order == 2 else 'straight'}"
        for name, column, reference in (("drag", "fx", DRAG), ("lift", "fy", LIFT)):
            yield estimate(history, case, name, (column, 0.3), reference, COEFFICIENT)


def of_disks(work: Work) -> Iterator[Estimate]:
    """Speed of and force on a falling disk, compared with a run on finer cells in shorter steps."""
    reference = work.run("disk_finest", "falling_disk.toml", [*FINEST, *FALL]).history
    for far, size in DISKS:
        mesh = [f"mesh.size={far}", f"mesh.size_body={size}", "time.step=0.004", *FALL, BARS]
        history = work.run(f"disk_{size:g}", "falling_disk.toml", mesh).history
        yield from in_a_fall(history, reference, "y", f"cells of {size:g}", TIMES)


def of_spheres(work: Work) -> Iterator[Estimate]:
    """Speed of and force on a sphere that settles, compared with a run on finer cells in shorter steps."""
    scene, reference = "ten_cate_e3.toml", finest_sphere(work)
    for size in SPHERES:
        coarse = ["mesh.size=2.0", f"mesh.size_body={size}", "time.step=0.02", *SETTLING, BARS]
        history = work.run(f"sphere_{size:g}", scene, coarse).history
        yield from in_a_fall(history, reference, "z", f"cells of {size:g}", SPHERE_TIMES)


def finest_sphere(work: Work) -> History:
    """The run that spheres are compared with."""
    return work.run("sphere_finest", "ten_cate_e3.toml", FINEST_SPHERE).history


def in_a_fall(
    history: History, reference: History, axis: str, case: str, times: tuple[float, ...]
) -> Iterator[Estimate]:
    """Speed and force along an axis at some times, compared with those of a ``reference``."""
    for time in times:
        for name, column in (("speed", f"v{axis}"), ("force", f"f{axis}")):
            yield estimate(history, case, f"{name} at {time:g}", (column, time), value(reference, column, time))


def value(history: History, column: str, time: float) -> float:
    """Value of a column of the only body at a time."""
    bodies = history.bodies
    return float(bodies[column][np.argmin(abs(bodies["time"] - time))])


def estimate(
    history: History, case: str, figure: str, place: tuple[str, float], reference: float, scale: float = 1.0
) -> Estimate:
    """The estimate of a column at a time, its ``place``, beside what a ``reference`` makes of it; ``scale`` times."""
    column, time = place
    found, errors = scale * value(history, column, time), history.error_estimates
    output = np.argmin(abs(errors["time"] - time))
    by_mesh, by_steps = (scale * errors[f"{column}_{cause}"][output] for cause in ("mesh", "steps"))
    return Estimate(case, figure, found, reference - found, by_mesh, by_steps)


COLUMNS = ("mesh", "figure", "value", "true error", "by the mesh", "by the steps", "effectivity", "held")


def row(found: Estimate) -> tuple[str, ...]:
    """A row of the tables."""
    errors = (f"{each:.2g}" for each in (found.true, found.mesh, found.steps))
    return (
        *(found.case, found.figure, f"{found.value:.6g}", *errors),
        *(f"{found.effectivity:.2f}", "yes" if found.holds else "no"),
    )


def summaries(named: dict[str, list[Estimate]]) -> Iterator[tuple[str, ...]]:
    """How many are held, and how good they are, by subject."""
    for name, found in named.items():
        median, held = np.median([each.effectivity for each in found]), sum(each.holds for each in found)
        yield name, str(len(found)), str(held), f"{median:.2f}", str(sum(each.is_good for each in found))


def estimates(named: dict[str, list[Estimate]]) -> Figure:
    """Error bars over true errors."""
    figure = Figure(figsize=(6.0, 5.0), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="true error, relative", ylabel="error bar, relative", xscale="log", yscale="log")
    for name, found in named.items():
        true, bar = (
            np.array([abs(error / each.value) for each, error in zip(found, errors, strict=True)])
            for errors in ([each.true for each in found], [each.bar for each in found])
        )
        axes.plot(true, bar, "o", label=name)
    ends = np.array(axes.get_xlim())
    for factor, style in ((0.5, ":"), (1.0, "-"), (3.0, ":")):
        axes.plot(ends, factor * ends, style, color="black", linewidth=0.8)
    axes.set_xlim(*ends)
    axes.legend()
    return figure


ABOUT = """
`output.error_bars` estimates at each output [how wrong velocities and forces are](../results.md#error_estimatescsv).
The estimate beside the true error:

{summary}

The bars, 1.25 times the sizes of both errors together, hold the reference in {held} of {all} figures. The effectivity
is the estimate over the true error, both with their signs; it is between .5 and 3 in {good} figures. In the picture the
line is that of bars as large as the error; the dotted ones are at half of it and at three times as much.

## Drag and lift of DFG 2D-1

The steady flow of `scenes/dfg_cylinder.toml`, with the reference of John and Matthies (2001). On straight cells most
of the error is that of the geometry.

{cylinders}

## A falling disk

`scenes/falling_disk.toml` with steps of 4 ms, compared with cells of .005 and steps of .5 ms. From .28 s on its meshes
are new ones. The errors of its start decay slowly: those by the steps are most of it on fine cells. The force on the
disk is its mass times its acceleration. At the first output errors are taken to have grown evenly since the start,
and its bar is several times too wide; later ones know those before. In the first step on a new mesh the force jumps by
up to a thousandth, which no bar tells (`remesh_jumps` in summary.json does): two outputs here are in such a step.

{disks}

## A sphere settles in oil

`scenes/ten_cate_e3.toml` with steps of 20 ms, compared with cells of .22 and steps of 10 ms, with which the speed after
1 s is {off:+.1%} off the highest one measured (ten Cate et al. 2002). The bar of the force at .2 s is too short:
outputs are too far apart for how fast its error changes there.

{spheres}
"""
