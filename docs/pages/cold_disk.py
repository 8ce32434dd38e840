"""A cold disk falls through a warm channel: held cold, with a capacity of its own, and as warm as the fluid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid import Scene
from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.post.reports.plane import fine_triangles
from rigidfluid.post.reports.scale import HOT_COLOURMAP
from rigidfluid.post.reports.style import BODY

DISKS = {"as warm as the fluid": None, "held": {"value": -1.0}, "with capacity": {"value": -1.0, "capacity": 1.0}}


def page(work: Work) -> Page:
    """Speeds, fluxes and balances of three disks."""
    runs = {name: work.run(name.replace(" ", "_"), falling(work, table)) for name, table in DISKS.items()}
    head = (
        "disk",
        "speed at the end",
        "Nu at the end",
        "its value",
        "imbalance",
        "put back",
        "new meshes",
        "energy lost",
    )
    text = ABOUT + table(head, (_disk_row(name, run) for name, run in runs.items())) + AFTER
    return Page("A cold disk falls", text, {"": _picture(runs)})


def falling(work: Work, body: dict[str, float] | None) -> Scene:
    """The scene cold_disk with new meshes more often, its disk held, with a capacity, or as warm as the fluid."""
    scene = work.scene("cold_disk.toml", ["mesh.remesh_every=1.0"]).to_dict()
    scene["scalar"]["body"] = [{"on": "disk", "value": 0.0} if body is None else {"on": "disk", **body}]
    return rigidfluid.scene_from_dict(scene)


def _disk_row(name: str, run: Run) -> Iterator[str]:
    history = run.history
    fluxes, totals, energy = history.scalar_fluxes, history.scalar, history.energy
    disk = fluxes["surface"] == "disk"
    flux, value = fluxes["flux"][disk], fluxes["value"][disk]
    largest = np.abs(flux).max()
    nusselt = flux[-1] / value[-1] / np.pi / 0.0353 if value[-1] else float("nan")
    put_in = energy["gravity"].max() + energy["body_force"].max()
    yield from (name, f"{-history.bodies['vy'][-1]:.4f}")
    yield from ("" if np.isnan(nusselt) else f"{nusselt:.2f}", f"{value[-1]:+.3f}")
    yield from (f"{np.abs(totals['imbalance']).max() / largest:.0e}" if largest > 0.0 else "0",)
    yield from (f"{totals['remeshing'][-1]:.1e}", f"{history.steps['remeshes'][-1]}")
    yield f"{100.0 * energy['residual'][-1] / put_in:.3f} %"


def _picture(runs: dict[str, Run]) -> Figure:
    """Temperature about the two cold disks at four times."""
    cold = [name for name in runs if DISKS[name] is not None]
    figure = Figure(figsize=(8.0, 6.5), dpi=120, layout="constrained")
    panels = figure.subplots(len(cold), 4, squeeze=False)
    for row, name in zip(panels, cold, strict=True):
        series = dict(read_pvd(runs[name].folder / "fields.pvd"))
        for axes, moment in zip(row, (2.0, 6.0, 10.0, 14.0), strict=True):
            fields = read_vtu(series[min(series, key=lambda at, moment=moment: abs(at - moment))])
            assert fields.scalar is not None
            colours = axes.tripcolor(
                fine_triangles(fields), fields.scalar, shading="gouraud", cmap=HOT_COLOURMAP, vmin=-1.0, vmax=0.0
            )
            bodies = runs[name].history.bodies
            height = float(bodies["y"][np.argmin(np.abs(bodies["time"] - moment))])
            axes.set(xlim=(0.0, 4.0), ylim=(height - 2.0, height + 4.0), aspect="equal", facecolor=BODY, xticks=[])
            axes.set_title(f"{name}, {moment:g}", fontsize=8)
    figure.colorbar(colours, ax=figure.axes, location="bottom", label="scalar", shrink=0.5, aspect=40)
    return figure


ABOUT = """The scene `cold_disk`, with the numbers of Gan et al. (2003) at a Grashof number of 564, on a coarse mesh
and with a new mesh each unit of time. `with capacity`: the disk has the heat capacity of as much fluid, and one
temperature. `imbalance`: the greatest of any step's balance over the greatest flux of the disk. `put back`: content
that corrections at all new meshes have restored together, in absolute value; the disk's area is 0.79. `energy lost`:
residual of the account of energy at the end, over the work of gravity and buoyancy.

"""
AFTER = """

A disk that is held cold draws fluid down and falls faster; one that warms up comes back to the speed of the warm one.
The paper's regimes, at which the disk moves to a wall or sheds vortices, are not compared: its runs take far longer
channels and finer meshes than these.
"""
