"""Schäfer & Turek's benchmark 2D-1: as shipped, and on coarser cylinders of straight and of curved cells."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from rigidfluid.core.output.history import History


def page(work: Work) -> Page:
    """The figures against their references, and over the size of the cells."""
    run = work.run("as_shipped", "dfg_cylinder.toml")
    measured = figures(run.history)
    rows = [
        (name, f"{reference:.8g}", f"{values[-1]:.8g}", f"{values[-1] / reference - 1.0:+.4%}")
        for name, (values, reference) in measured.items()
    ]
    text = table(("figure", "reference", "measured", "difference"), rows)
    text += (
        f"\n\n{run.summary['unknowns']} unknowns, {run.summary['steps']} steps, {run.cpu_seconds:.0f} s of CPU time."
    )
    text += CURVED + table(("size_body", "order", "unknowns", *measured, "CPU s"), coarser(work))
    return Page("DFG cylinder 2D-1", text, {"": differences(run)})


def differences(run: Run) -> Figure:
    """From the references, over time."""
    bodies = run.history.bodies
    figure = Figure(figsize=(7.0, 3.6), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="time [s]", ylabel="distance from the reference, relative", yscale="log")
    for name, (values, reference) in figures(run.history).items():
        axes.plot(bodies["time"][1:], np.abs(values[1:] / reference - 1.0), label=name)
    axes.legend()
    return figure


CURVED = """

## Curved cells beside straight ones

Differences from the reference with `mesh.growth = 0.1`, `mesh.size = 0.02`. A cylinder of size_body .0098 has 36 cells
round it. The pressure is read on the cylinder, where P1 is of order 2 on cells of either kind.

"""


def figures(history: History) -> dict[str, tuple[np.ndarray, float]]:
    """Over time, with the converged values of John & Matthies (2001)."""
    bodies, scale = history.bodies, 2.0 / (0.2**2 * 0.1)
    front, back = (history.probes["pressure"][i::2] for i in (0, 1))
    return {
        "drag coefficient": (bodies["fx"] * scale, 5.57953523384),
        "lift coefficient": (bodies["fy"] * scale, 0.010618948146),
        "pressure difference": (front - back, 0.11752016697),
    }


def coarser(work: Work) -> Iterable[tuple[str, ...]]:
    """Rows of `CURVED`'s table."""
    for size_body in (0.0098, 0.0049, 0.00245):
        for order in (1, 2):
            mesh = [f"mesh.size_body={size_body}", f"mesh.order={order}", "mesh.growth=0.1", "mesh.size=0.02"]
            run = work.run(f"size_body_{size_body:g}_order_{order}", "dfg_cylinder.toml", mesh)
            off = [f"{values[-1] / reference - 1.0:+.4%}" for values, reference in figures(run.history).values()]
            yield f"{size_body:g}", str(order), str(run.summary["unknowns"]), *off, f"{run.cpu_seconds:.0f}"
