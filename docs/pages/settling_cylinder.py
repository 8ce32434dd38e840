"""A cylinder leaves the wall of a long channel; whether the mesh keeps up with it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.mesh.adaptation.coarsening import relative_sizes
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Pose
from rigidfluid.core.output.vtu import read_pvd, read_vtu

DENSE = ["body.0.density=3.0", "time.step=0.0025", "time.end=7.8"]
COARSE = ["mesh.size_body=0.08", "mesh.size=0.5"]
RUNS: dict[str, tuple[str, float, list[str]]] = {
    "light": ("density 1.5", 1.5, []),
    "dense": ("density 3", 3.0, DENSE),
    "light_coarse": ("density 1.5, cells twice as large, step .02", 1.5, [*COARSE, "time.step=0.02"]),
    "dense_coarse": ("density 3, cells twice as large, step .005", 3.0, [*DENSE, *COARSE, "time.step=0.005"]),
}
"""By folder: the heading, the cylinder's density, and what differs from the scene as shipped."""

WACHS_2009 = {1.5: (259.5, 1.785), 3.0: (522.0, 1.764)}
"""Reynolds number and drag coefficient of the settled cylinder."""

NU = 0.008088


def page(work: Work) -> Page:
    """Paths and speeds, and the figures of the settled cylinder."""
    runs = {name: work.run(name, "settling_cylinder.toml", overrides) for name, (_, _, overrides) in RUNS.items()}
    columns = {RUNS[name][0]: figures(run, RUNS[name][1]) for name, run in runs.items()}
    names = next(iter(columns.values()))
    rows = [(name, *(column[name] for column in columns.values())) for name in names]
    text = ABOUT.format(figures=table(("figure", *columns), rows))
    return Page("A settling cylinder", text, {"": paths(runs)})


def paths(runs: dict[str, Run]) -> Figure:
    """Of the cylinders, and their Reynolds numbers along them."""
    figure = Figure(figsize=(8.0, 4.2), dpi=120, layout="constrained")
    path, speed = figure.subplots(1, 2)
    path.set(xlabel="fallen [diameters]", ylabel="from the wall [diameters]")
    speed.set(xlabel="fallen [diameters]", ylabel="Reynolds number")
    for name, run in runs.items():
        label, density, overrides = RUNS[name]
        colour = "C0" if density == 1.5 else "C1"
        style = {"color": colour, "linestyle": "--" if COARSE[0] in overrides else "-", "linewidth": 1.0}
        bodies = run.history.bodies
        fallen = bodies["y"][0] - bodies["y"]
        path.plot(fallen, bodies["x"], label=label, **style)
        speed.plot(fallen, -bodies["vy"] / NU, **style)
        speed.axhline(WACHS_2009[density][0], color=colour, ls=":")
    path.axhline(2.0, color="grey", ls=":")
    path.legend(fontsize=8)
    return figure


def cell_sizes(run: Run) -> np.ndarray:
    """At each output, of all cells the mean factor off the wanted size and the coarsest relative size, (outputs, 2)."""
    mesh, bodies = run.scene.mesh, run.history.bodies
    assert mesh is not None
    sizes, model, rows = Sizes(mesh.size, mesh.size_body, mesh.growth), model_of(run.scene), []
    for time, path in read_pvd(run.folder / "fields.pvd"):
        now, fields = int(np.argmin(np.abs(bodies["time"] - time))), read_vtu(path)
        pose = Pose(np.array([[bodies["x"][now], bodies["y"][now]]]), np.array([[bodies["angle"][now]]]))
        around = FluidDomain(model.shapes, pose, model.domain, ())
        relative = relative_sizes(fields.points, fields.cells[:, :3], around, sizes)
        rows.append((np.maximum(relative, 1.0 / relative).mean(), relative.max()))
    return np.array(rows)


def figures(run: Run, density: float) -> dict[str, str]:
    """What the page tells of one run; settled is the second half of the way."""
    bodies, summary, sizes = run.history.bodies, run.summary, cell_sizes(run)
    fallen = bodies["y"][0] - bodies["y"]
    late = fallen > 0.5 * fallen[-1]
    speed = np.ptp(fallen[late]) / np.ptp(bodies["time"][late])
    reynolds, drag = WACHS_2009[density]
    found = 0.5 * np.pi * (density - 1.0) * 10.0 / speed**2
    lost, put = run.history.energy["residual"], summary["energy"]["put_in"]
    return {
        "fallen [diameters]": f"{fallen[-1]:.1f}",
        "Reynolds number, settled (Wachs 2009)": f"{speed / NU:.1f} ({reynolds:g}, {speed / NU / reynolds - 1:+.1%})",
        "drag coefficient, settled (Wachs 2009)": f"{found:.3f} ({drag:g}, {found / drag - 1:+.1%})",
        "from the wall at the start, and settled [diameters]": (
            f"{bodies['x'][0]:g}, {bodies['x'][late].min():.2f} … {bodies['x'][late].max():.2f}"
        ),
        "cells off their wanted size, mean over the mesh: mean and highest of all outputs": (
            f"{sizes[:, 0].mean():.2f}, {sizes[:, 0].max():.2f}"
        ),
        "coarsest cell of all outputs over its wanted size": f"{sizes[:, 1].max():.2f}",
        "energy unaccounted for, largest": f"{np.abs(lost).max() / put:.2%}",
        "energy lost by re-meshing": f"{summary['energy']['transfer_loss'] / put:.1e}",
        "new meshes, and such that could not be made": f"{summary['remeshes']}, {summary['failed_remeshes']}",
        "steps": f"{summary['steps']}",
        "unknowns at the end": f"{summary['unknowns']}",
        "CPU time of one thread [s]": f"{run.cpu_seconds:.0f}",
    }


ABOUT = """`scenes/settling_cylinder.toml`: a cylinder is let go in a channel of four diameters, half a
diameter from its wall, and falls some thirty diameters. Published are the settled Reynolds numbers and drag
coefficients (Wachs, Comput. Fluids 38 (2009) 1608, after Yu et al., J. Non-Newtonian Fluid Mech. 104 (2002) 87), dotted
on the right; the middle of the channel is dotted on the left. The second half of the way counts as settled.

{figures}

A cell's relative size is the edge of a regular triangle of its area over the size wanted at its centre, gaps left out;
off by a factor, it may be too coarse or too fine.

The step is .01 at density 1.5 and .0025 at density 3, and twice that with the coarser cells."""
