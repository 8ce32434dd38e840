"""Runs the validation scenes and the studies of kernels, and writes docs/validation: a page for each, most with a plot.

python docs/make_validation.py [NAME ...], the names as in CASES; all without one.
"""

from __future__ import annotations

import datetime
import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import chain
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import rigidfluid
from rigidfluid.core.mesh.coarsening import relative_sizes
from rigidfluid.core.mesh.inserter import Way
from rigidfluid.core.mesh.size_field import Sizes
from rigidfluid.core.output.history import History
from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import MeshError, StepError
from rigidfluid.evaluation.crosscheck import crosscheck
from rigidfluid.evaluation.crosscheck.comparison import PARTED
from rigidfluid.evaluation.insertion import insert
from rigidfluid.evaluation.studies import load_study, run_study
from rigidfluid.evaluation.studies.results import Results
from rigidfluid.evaluation.studies.rows import cells, short_text
from rigidfluid.registry import FLUID_BACKEND, Registry
from rigidfluid.reports.plane import fine_triangles
from rigidfluid.reports.style import BODY, COLOURMAP

ROOT = Path(__file__).parents[1]
OUT = ROOT / "docs" / "validation"
sys.path.append(str(ROOT / "tests" / "support"))

import adaptive_step as adaptive  # noqa: E402
import curved_channels  # noqa: E402
import insertion_cases as insertions  # noqa: E402
import shear_boxes  # noqa: E402
import vortex_induced as vortices  # noqa: E402
from curved_gaps import CurvedGap, curved_gaps  # noqa: E402
from dry_scenes import sphere_gas  # noqa: E402
from extreme_cases import rows as extremes  # noqa: E402
from fluid_contact_table import CASES as CONTACT_CASES  # noqa: E402
from fluid_contact_table import made  # noqa: E402
from fluid_contacts import created_and_lost, put_in  # noqa: E402
from periodic_arrays import array_of_balls, exact_array  # noqa: E402
from published import GLOWINSKI_2001, HIGHEST_REYNOLDS, KOBLITZ_2017, TERMINAL_SPEED  # noqa: E402
from spheres_in_box import BACK, BACK_FROM_SHORT, Swim, drag, swim, without_box  # noqa: E402
from spheres_on_a_line import cycle as exact_cycle  # noqa: E402
from spheres_on_a_line import drag as exact_drag  # noqa: E402
from stokes_contacts import rows as stokes_rows  # noqa: E402
from swimmer_2d import SWIMS as SWIMS_2D  # noqa: E402
from swimmer_2d import swim_figures, two_cycles  # noqa: E402
from two_spheres import angle, axis_ratio, period, rotation_in_strain  # noqa: E402
from wall_drift import wall_drift  # noqa: E402

Row = tuple[str, str, str, str]
FALLS = {
    "size_body 0.01, step 0.001": [],
    "size_body 0.025, step 0.004": ["mesh.size_body=0.025", "time.step=0.004"],
}


def run(scene: str, overrides: Iterable[str] = ()) -> tuple[History, float]:
    """A scene's history, and its wall time [s]."""
    start = time.perf_counter()
    history = rigidfluid.run(rigidfluid.load_scene(ROOT / "scenes" / scene, overrides))
    return history, time.perf_counter() - start


def table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    """A Markdown table."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def write_page(name: str, title: str, command: str, text: str, plot: bool = True) -> None:
    """One page with its date, its command and its plot, if it has one."""
    stamp = f"Made on {datetime.date.today()} by `{command}`, rigidfluid {rigidfluid.__version__}."
    picture = f"![{title}]({name}.png)\n\n" if plot else ""
    page = f"# {title}\n\n{stamp}\n\n{picture}{text}\n"
    (OUT / f"{name}.md").write_text(page, encoding="utf-8")


def falling_disk() -> None:
    """Case 1 of arXiv:2402.19093 at two resolutions."""
    runs = {label: run("falling_disk.toml", overrides) for label, overrides in FALLS.items()}
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot(xlabel="time [s]", ylabel="velocity of the disk [cm/s]")
    for (label, (history, _)), style in zip(runs.items(), ("-", "--"), strict=True):
        axes.plot(history.bodies["time"], history.bodies["vy"], style, label=f"rigidfluid, {label}")
    axes.plot(*KOBLITZ_2017.T, "s", mfc="none", label="Koblitz et al. 2017")
    axes.plot(*GLOWINSKI_2001.T, "x", label="Glowinski et al. 2001")
    axes.legend()
    figure.savefig(OUT / "falling_disk.png", dpi=120)
    head = ("figure", "reference", *FALLS)
    columns = [fall_figures(history, seconds) for history, seconds in runs.values()]
    rows = [(name, reference, *(column[name] for column in columns)) for name, reference in FALL_REFERENCES.items()]
    write_page("falling_disk", "Falling disk", "python docs/make_validation.py falling_disk", table(head, rows))


FALL_REFERENCES = {
    "highest Re, density of the solid": f"{HIGHEST_REYNOLDS} ± 1 %",
    "passes y = 2 cm at [s]": "0.434 ± 0.01",
    "passes y = 1 cm at [s]": "0.613 ± 0.01",
    "passes y = 0.5 cm at [s]": "0.703 ± 0.01",
    "off Koblitz et al. 2017, largest": "< 3 %",
    "off Glowinski et al. 2001, root mean square": "< 3 %",
    "off Glowinski et al. 2001, largest after 0.15 s": "< 3 %",
    "drift sideways before contact [cm]": "< 0.001",
    "smallest gap [cm]": "> 0",
    "energy unaccounted for": "< 2 %",
    "unknowns at the end": "",
    "remeshes": "",
    "wall time [s]": "",
}


def fall_figures(history: History, seconds: float) -> dict[str, str]:
    """The figures of FALL_REFERENCES, measured; velocities over the terminal speed."""
    bodies, summary = history.bodies, history.summary

    def off(curve: np.ndarray) -> np.ndarray:
        return (np.interp(curve[:, 0], bodies["time"], bodies["vy"]) - curve[:, 1]) / TERMINAL_SPEED

    def passes(height: float) -> str:
        return f"{np.interp(-height, -bodies['y'], bodies['time']):.4f}"

    glowinski = off(GLOWINSKI_2001)
    values = (
        f"{summary['reynolds_solid_density']:.3f}",
        *(passes(height) for height in (2.0, 1.0, 0.5)),
        f"{np.abs(off(KOBLITZ_2017)).max():.2%}",
        f"{np.sqrt(np.mean(glowinski**2)):.2%}",
        f"{np.abs(glowinski[GLOWINSKI_2001[:, 0] > 0.15]).max():.2%}",
        f"{np.abs(bodies['x'] - 1.0)[bodies['gap'] > 0.015].max():.1e}",
        f"{summary['smallest_gap']:.5f}",
        f"{summary['energy']['relative_residual']:.1e}",
        f"{summary['unknowns']}",
        f"{summary['remeshes']}",
        f"{seconds:.0f}",
    )
    return dict(zip(FALL_REFERENCES, values, strict=True))


def dfg_cylinder() -> None:
    """Schäfer & Turek's benchmark 2D-1: as shipped, and on coarser cylinders of straight and of curved cells."""
    history, seconds = run("dfg_cylinder.toml")
    bodies, measured = history.bodies, cylinder_figures(history)
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axes = figure.add_subplot(xlabel="time [s]", ylabel="distance from the reference, relative", yscale="log")
    for name, (values, reference) in measured.items():
        axes.plot(bodies["time"][1:], np.abs(values[1:] / reference - 1.0), label=name)
    axes.legend()
    figure.savefig(OUT / "dfg_cylinder.png", dpi=120)
    rows = [
        (name, f"{reference:.8g}", f"{values[-1]:.8g}", f"{values[-1] / reference - 1.0:+.4%}")
        for name, (values, reference) in measured.items()
    ]
    text = table(("figure", "reference", "measured", "difference"), rows)
    text += f"\n\n{history.summary['unknowns']} unknowns, {history.summary['steps']} steps, {seconds:.0f} s."
    text += CYLINDERS + table(("size_body", "order", "unknowns", *measured), coarser_cylinders())
    write_page("dfg_cylinder", "DFG cylinder 2D-1", "python docs/make_validation.py dfg_cylinder", text)


CYLINDERS = """

## Curved cells beside straight ones

Differences from the reference with `mesh.growth = 0.1`, `mesh.size = 0.02`. A cylinder of size_body .0098 has 36 cells
round it. The pressure is read on the cylinder, where P1 is of order 2 on cells of either kind.

"""


def cylinder_figures(history: History) -> dict[str, tuple[np.ndarray, float]]:
    """Over time, with the converged values of John & Matthies (2001)."""
    bodies, scale = history.bodies, 2.0 / (0.2**2 * 0.1)
    front, back = (history.probes["pressure"][i::2] for i in (0, 1))
    return {
        "drag coefficient": (bodies["fx"] * scale, 5.57953523384),
        "lift coefficient": (bodies["fy"] * scale, 0.010618948146),
        "pressure difference": (front - back, 0.11752016697),
    }


def coarser_cylinders() -> Iterable[tuple[str, ...]]:
    """Rows of `CYLINDERS`' table."""
    for size_body in (0.0098, 0.0049, 0.00245):
        for order in (1, 2):
            mesh = [f"mesh.size_body={size_body}", f"mesh.order={order}", "mesh.growth=0.1", "mesh.size=0.02"]
            history, _ = run("dfg_cylinder.toml", mesh)
            off = [f"{values[-1] / reference - 1.0:+.4%}" for values, reference in cylinder_figures(history).values()]
            yield f"{size_body:g}", str(order), str(history.summary["unknowns"]), *off


UNSTEADY: dict[str, list[str]] = {
    "step 0.01": ["time.step=0.01"],
    "step 0.005": ["time.step=0.005"],
    "step 0.0025": [],
    "step 0.0025, size_body 0.00245": ["mesh.size_body=0.00245"],
}
"""What differs from the scene as shipped."""

JOHN_2004 = {
    "greatest drag coefficient": 2.950921575,
    "its time [s]": 3.93625,
    "greatest lift coefficient": 0.47795,
    "its time [s] ": 5.693125,
    "pressure difference at 8 s": -0.1116,
}


def dfg_unsteady() -> None:
    """Schäfer & Turek's benchmark 2D-3: an inflow that rises and falls, on two meshes and with three steps."""
    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    drag, lift = figure.subplots(2, 1, sharex=True)
    drag.set(ylabel="drag coefficient")
    lift.set(xlabel="time [s]", ylabel="lift coefficient")
    rows = []
    for name, overrides in UNSTEADY.items():
        history, _ = run("dfg_2d3.toml", overrides)
        time_of, (of_drag, of_lift, _) = history.bodies["time"], unsteady_coefficients(history)
        drag.plot(time_of[1:], of_drag[1:], label=name)
        lift.plot(time_of[1:], of_lift[1:])
        found = unsteady_figures(history)
        off = [
            f"{value:.6g} ({value / exact - 1.0:+.2%})" for value, exact in zip(found, JOHN_2004.values(), strict=True)
        ]
        rows.append((name, *off, str(history.summary["unknowns"]), str(history.summary["steps"])))
    drag.plot(3.93625, 2.950921575, "k+", markersize=12, label="John 2004")
    lift.plot(5.693125, 0.47795, "k+", markersize=12)
    drag.legend()
    figure.savefig(OUT / "dfg_unsteady.png", dpi=120)
    reference = ("John 2004", *(f"{value:.10g}" for value in JOHN_2004.values()), "", "")
    text = table(("", *map(str.strip, JOHN_2004), "unknowns", "steps"), [reference, *rows]) + ABOUT_UNSTEADY
    write_page("dfg_unsteady", "DFG cylinder 2D-3", "python docs/make_validation.py dfg_unsteady", text)


ABOUT_UNSTEADY = """

The inflow is 1.5 sin(πt/8) at its peak, with Reynolds numbers up to 100 and down to 0 again at 8 s
(`scenes/dfg_2d3.toml`). The wake becomes unsteady while the inflow is greatest. The drag follows the inflow, and its
acceleration: it is greatest before 4 s. The lift is that of vortices which grow from small disturbances, and is the
figure that asks for short steps. References: V. John, Int. J. Numer. Methods Fluids 44 (2004) 777, doi:10.1002/fld.679.
"""


def unsteady_coefficients(history: History) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Over time, of a greatest mean inflow of 1 m/s: drag and lift coefficient, and the pressure difference."""
    front, back = (history.probes["pressure"][i::2] for i in (0, 1))
    return 20.0 * history.bodies["fx"], 20.0 * history.bodies["fy"], front - back


def unsteady_figures(history: History) -> tuple[float, ...]:
    """Those of `JOHN_2004`."""
    time_of, (drag, lift, difference) = history.bodies["time"], unsteady_coefficients(history)
    strongest, highest = int(np.argmax(drag)), int(np.argmax(lift))
    return drag[strongest], time_of[strongest], lift[highest], time_of[highest], difference[-1]


SETTLING: dict[float, list[str]] = {
    1.5: [],
    3.0: ["body.0.density=3.0", "time.step=0.0025", "time.end=7.8", "output.every=0.5"],
}
"""Of the cylinder's density: what differs from the scene as shipped."""
WACHS_2009 = {1.5: (259.5, 1.785), 3.0: (522.0, 1.764)}
"""Reynolds number and drag coefficient of the settled cylinder."""


def settling_cylinder() -> None:
    """A cylinder leaves the wall of a long channel; whether the mesh keeps up with it."""
    with ProcessPoolExecutor(len(SETTLING)) as pool:
        runs = dict(zip(SETTLING, pool.map(settled, SETTLING), strict=True))
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    path, speed = figure.subplots(1, 2)
    path.set(xlabel="fallen [diameters]", ylabel="from the wall [diameters]")
    speed.set(xlabel="fallen [diameters]", ylabel="Reynolds number")
    for (density, (history, _)), colour in zip(runs.items(), ("C0", "C1"), strict=True):
        bodies = history.bodies
        fallen = bodies["y"][0] - bodies["y"]
        path.plot(fallen, bodies["x"], colour, label=f"density {density:g}")
        speed.plot(fallen, -bodies["vy"] / NU, colour)
        speed.axhline(WACHS_2009[density][0], color=colour, ls=":")
    path.axhline(2.0, color="grey", ls=":")
    path.legend()
    figure.savefig(OUT / "settling_cylinder.png", dpi=120)
    columns = {f"density {density:g}": settling_figures(density, *found) for density, found in runs.items()}
    names = next(iter(columns.values()))
    rows = [(name, *(column[name] for column in columns.values())) for name in names]
    text = SETTLING_CYLINDER.format(figures=table(("figure", *columns), rows))
    write_page("settling_cylinder", "A settling cylinder", "python docs/make_validation.py settling_cylinder", text)


NU = 0.008088


def settled(density: float) -> tuple[History, np.ndarray]:
    """A run, and every ten steps of its cells the mean factor off the wanted size and the coarsest relative size."""
    scene = rigidfluid.load_scene(ROOT / "scenes" / "settling_cylinder.toml", SETTLING[density])
    assert scene.mesh is not None
    sizes, rows = Sizes(scene.mesh.size, scene.mesh.size_body, scene.mesh.growth), []

    def look(now: Simulation) -> None:
        mesh = now.state.mesh
        if mesh is not None and now.state.count % 10 == 0:
            relative = relative_sizes(mesh.points, mesh.cells, now.system.bodies, now.state.pose, sizes)
            rows.append((np.maximum(relative, 1.0 / relative).mean(), relative.max()))

    simulation, start = Simulation(scene), time.process_time()
    simulation.observe(look)
    simulation.go()
    simulation.finish("complete")
    simulation.history.summary["cpu"] = time.process_time() - start
    return simulation.history, np.array(rows)


def settling_figures(density: float, history: History, sizes: np.ndarray) -> dict[str, str]:
    """What the page tells of one run; settled is the second half of the way."""
    bodies, summary = history.bodies, history.summary
    fallen = bodies["y"][0] - bodies["y"]
    late = fallen > 0.5 * fallen[-1]
    speed = np.ptp(fallen[late]) / np.ptp(bodies["time"][late])
    reynolds, drag = WACHS_2009[density]
    found = 0.5 * np.pi * (density - 1.0) * 10.0 / speed**2
    lost, put = history.energy["residual"], summary["energy"]["put_in"]
    return {
        "fallen [diameters]": f"{fallen[-1]:.1f}",
        "Reynolds number, settled (Wachs 2009)": f"{speed / NU:.1f} ({reynolds:g}, {speed / NU / reynolds - 1:+.1%})",
        "drag coefficient, settled (Wachs 2009)": f"{found:.3f} ({drag:g}, {found / drag - 1:+.1%})",
        "from the wall at the start, and settled [diameters]": (
            f"{bodies['x'][0]:g}, {bodies['x'][late].min():.2f} … {bodies['x'][late].max():.2f}"
        ),
        "cells off their wanted size, mean over the mesh: mean and highest of the run": (
            f"{sizes[:, 0].mean():.2f}, {sizes[:, 0].max():.2f}"
        ),
        "coarsest cell of the run over its wanted size": f"{sizes[:, 1].max():.2f}",
        "energy unaccounted for, largest": f"{np.abs(lost).max() / put:.2%}",
        "energy lost by re-meshing": f"{summary['energy']['transfer_loss'] / put:.1e}",
        "new meshes, and such that could not be made": f"{summary['remeshes']}, {summary['failed_remeshes']}",
        "steps": f"{summary['steps']}",
        "unknowns at the end": f"{summary['unknowns']}",
        "CPU time of one thread [s]": f"{summary['cpu']:.0f}",
    }


SETTLING_CYLINDER = """`scenes/settling_cylinder.toml`: a cylinder is let go in a channel of four diameters, half a
diameter from its wall, and falls some thirty diameters. Published are the settled Reynolds numbers and drag
coefficients (Wachs, Comput. Fluids 38 (2009) 1608, after Yu et al., J. Non-Newtonian Fluid Mech. 104 (2002) 87), dotted
on the right. The cylinder leaves the wall, and sways towards the middle. Settled is here the second half of the way.

{figures}

A cell's relative size is the edge of a regular triangle of its area over the size wanted at its centre, gaps left out;
off by a factor, it may be too coarse or too fine.

The step is .01 at density 1.5 and .0025 at density 3. With .005 at density 3, tried first, 2.3 % of the energy were
unaccounted for."""


def window() -> None:
    """A disk falls through a long channel, all of it meshed and in windows of several lengths."""
    runs = {ends: in_window(ends) for ends in WINDOWS}
    whole = runs[None]
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    speed, off = figure.subplots(1, 2)
    speed.set(xlabel="time [s]", ylabel="speed of the disk [cm/s]")
    off.set(xlabel="time [s]", ylabel="off the whole channel's speed [1]", yscale="log", ylim=(1e-7, 1e-1))
    for ends, history in runs.items():
        bodies = history.bodies
        label, style = ("whole channel", "k") if ends is None else ("{:g} ahead, {:g} behind".format(*ends), "--")
        speed.plot(bodies["time"], -bodies["vy"], style, label=label)
        off.plot(bodies["time"], np.abs(off_the_whole(history, whole)), style)
    speed.legend()
    figure.savefig(OUT / "window.png", dpi=120)
    head = ("ahead [cm]", "behind [cm]", *window_figures(whole, whole))
    ways = [("whole channel", "") if ends is None else tuple(f"{end:g}" for end in ends) for ends in runs]
    rows = [(*way, *window_figures(run, whole).values()) for way, run in zip(ways, runs.values(), strict=True)]
    text = WINDOW.format(figures=table(head, rows))
    write_page("window", "A window in a long channel", "python docs/make_validation.py window", text)


WINDOWS = (None, (2.0, 3.0), (1.0, 3.0), (4.0, 3.0), (2.0, 1.5), (2.0, 6.0), (4.0, 6.0))
WINDOW = """`scenes/falling_disk_window.toml`: the disk of the [falling disk](falling_disk.md) falls through a channel
20 times as long as wide. Its mesh is a window of the channel that goes with it. For comparison the whole channel is
meshed, with the same wanted sizes of cells. The final speed is that of the last tenth of a second; the largest
difference of the speeds is over the final one. CPU times, of one thread, are over that of the whole channel in the same
run.

{figures}

Ahead the fluid is held at rest, which the disk feels: half a channel's width from it by more than a per cent, two
widths from it no more than the new mesh of the whole channel after 2.1 s. Behind the wake leaves through the open end.
The energy that it takes along is in the balance."""


def in_window(ends: tuple[float, float] | None) -> History:
    """The fall with so much ahead and behind in the window, or in the whole channel; with its CPU time."""
    tables = rigidfluid.load_scene(ROOT / "scenes" / "falling_disk_window.toml").to_dict()
    if ends is None:
        del tables["domain"]["window"]
    else:
        tables["domain"]["window"] |= {"ahead": ends[0], "behind": ends[1]}
    start = time.process_time()
    history = rigidfluid.run(rigidfluid.scene_from_dict(tables))
    history.summary["cpu"] = time.process_time() - start
    return history


def off_the_whole(history: History, whole: History) -> np.ndarray:
    """Speed less that in the whole channel, over its final speed, at each step [1]."""
    found, expected = history.bodies, whole.bodies
    return (expected["vy"] - found["vy"]) / final_speed(whole)


def final_speed(history: History) -> float:
    """Mean of the last tenth of a second."""
    bodies = history.bodies
    return float(-np.mean(bodies["vy"][bodies["time"] > bodies["time"][-1] - 0.1]))


def window_figures(history: History, whole: History) -> dict[str, str]:
    """What the page tells of one run."""
    summary, speed = history.summary, final_speed(history)
    energy, put = history.energy, summary["energy"]["put_in"]
    return {
        "final speed [cm/s]": f"{speed:.4f}",
        "off the whole channel's": f"{speed / final_speed(whole) - 1:+.3%}",
        "off it at any time": f"{np.abs(off_the_whole(history, whole)).max():.3%}",
        "unknowns": f"{summary['unknowns']} ({summary['unknowns'] / whole.summary['unknowns']:.0%})",
        "CPU": f"{summary['cpu'] / whole.summary['cpu']:.0%}",
        "meshes": f"{1 + summary['remeshes']}",
        "energy out through the ends, of all put in": f"{-energy['boundary'][-1] / put:.2%}",
        "residual, lowest … highest": f"{energy['residual'].min() / put:.1e} … {energy['residual'].max() / put:.1e}",
        "created, lost": "{created:.1e}, {lost:.1e}".format(**summary["energy"]),
    }


def lammps() -> None:
    """200 spheres in a box here and in LAMMPS: until chaos parts them, and in the mean."""
    start = time.perf_counter()
    early = crosscheck(sphere_gas(1_000), steps=4).rows
    late = crosscheck(sphere_gas(100_000), steps=1, samples=2_000)
    seconds, (row,) = time.perf_counter() - start, late.rows
    apart = np.linalg.norm(late.ours.position - late.theirs.position, axis=2).max(axis=1)
    shown = late.ours.time <= 1.5
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axes = figure.add_subplot(xlabel="time", ylabel="largest distance of a sphere's two positions", yscale="log")
    axes.plot(late.ours.time[shown], np.maximum(apart[shown], 1e-17), label=f"rigidfluid and LAMMPS, step {row.step:g}")
    axes.axhline(PARTED * 0.04, ls=":", label="a hundredth of the smallest radius")
    axes.legend()
    figure.savefig(OUT / "lammps.png", dpi=120)
    head = ("step", "position", "velocity", "energy", "momentum", "position, from LAMMPS' with the shortest step")
    columns = ("step", "position", "velocity", "energy", "momentum", "from_finest")
    until = [tuple(f"{getattr(one, column):.2g}" for column in columns) for one in early]
    means = [
        (name, f"{ours:.5g}", f"{theirs:.5g}", f"{ours / theirs - 1.0:+.2%}")
        for name in ("energy", "momentum", "pressure")
        for ours, theirs in [(getattr(row.ours, name), getattr(row.theirs, name))]
    ]
    text = f"""200 spheres of three radii and two densities fly about in a box of side 1 and collide by the law `centre`
(LAMMPS: tables). Both programs take the same velocity Verlet steps.

Largest differences until time 0.1, by step; energy and momentum over their largest values:

{table(head, until)}

With the same step both follow one path, up to rounding and what collisions make of it. Against LAMMPS' shortest step
ours converges at second order.

Over {100_000:,} steps of {row.step:g} the rounding grows until the histories part, at time {row.parted:g}. Means over
all of the time, {len(late.ours.time):,} samples, with the size of the total momentum:

{table(("mean", "rigidfluid", "LAMMPS", "difference"), means)}

{seconds:.0f} s for all runs."""
    write_page("lammps", "200 spheres beside LAMMPS", "python docs/make_validation.py lammps", text)


def stability() -> None:
    """Stiff and extreme contacts, and what each must do."""
    text = f"""The scenes and their limits are those of `tests/stability/test_extreme_contacts.py`. Unless the case says
otherwise, a ball has a radius of 0.1 and a density of 1, boxes have a side of 1, and speeds are of order 1.

* smallest gap: the least of the run; above zero there was no overlap at any step.
* rejected steps: none means that the contacts were met by the step as given. Up to ten where films of fluid open, which
  steps are made to follow.
* energy unaccounted for: the largest residual of the balance, of either sign, over the most energy that was stored.
  The residual is what came in, less what went out by viscosity, dampers and re-meshing, less what is stored more than
  at the start.
* energy created by the first step: what the residual was below zero after it, over what was put in. Bodies that start
  in a fluid at rest set it into motion at once.
* energy created, energy lost: how far the residual fell below what it was after the first step, and how far it rose
  above, over what was put in: the energy stored at the start, and the most that gravity, faces and driven bodies had
  worked by any time. What viscosity took hides nothing of what was created, but what was lost
  before may. Of what was lost, `path_friction` is taken off: friction in impacts shorter than a step, which
  the balance does not see. It excuses no energy that was created.

In a fluid at most 3 % may be created, with steps of a millisecond and below 1 %; and at most 30, 15, 7 and 4 % be lost
with steps of 4, 2, 1 and .5 ms. A case that does not do what is demanded of it stays in the table, and says **no**.

{table(("case", "demanded", "found", "pass"), extremes(processes=2))}"""
    write_page("stability", "Stiff and extreme contacts", "python docs/make_validation.py stability", text, plot=False)


IN_FLUID = ("dropped", "bounce", "cradle", "cradle_light", "head_on", "light", "stacked", "squeezed", "film")
AT_REST = ("resting", "resting_stiff", "settling")


def contacts_in_fluid() -> None:
    """Energy created and lost by stiff contacts in a fluid, over the step."""
    steps = (4.0, 2.0, 1.0, 0.5, 0.25)
    energies = [
        found for case in IN_FLUID for stepping in ("substeps", "implicit") for found in tries(case, stepping, steps)
    ]
    resting = [found for case in AT_REST for found in tries(case, "substeps", (10.0, 4.0, 1.0))]
    head = ("case", "stepping", "step [ms]", "created [%]", "lost [%]", "friction [%]", "first step [%]", "figures")
    over = [" ".join(found[:3]) for found in energies + resting if exceeds(found)]
    text = CONTACTS_IN_FLUID.format(
        over=", ".join(over) or "none", energies=table(head, energies), resting=table(head, resting)
    )
    command = "python docs/make_validation.py contacts_in_fluid"
    write_page("contacts_in_fluid", "Stiff contacts in a fluid", command, text, plot=False)


def stokes_contacts() -> None:
    """Contacts in a fluid without inertia: rest, speeds and energy over the step."""
    head = ("case", "stepping", "step [s]", "force / weight", "speed, late [cm/s]", "gap, less exact [cm]")
    head += ("created [%]", "lost [%]", "steps", "CPU [s]")
    text = STOKES_CONTACTS.format(rows=table(head, stokes_rows()))
    command = "python docs/make_validation.py stokes_contacts"
    write_page("stokes_contacts", "Contacts in Stokes flow", command, text, plot=False)


MOST_LOST = {4.0: 30.0, 2.0: 15.0, 1.0: 7.0, 0.5: 4.0}


def exceeds(found: tuple[str, ...]) -> bool:
    """Whether a row is above what is aimed at: created 3 %, from 1 ms down 1 %; lost as in MOST_LOST."""
    _, _, step, created, lost, *_ = found
    if not created:
        return True
    most = 3.0 if float(step) > 1.0 else 1.0
    return float(created) > most or float(lost) > MOST_LOST.get(float(step), np.inf)


def tries(case: str, stepping: str, steps: tuple[float, ...]) -> Iterable[tuple[str, ...]]:
    """A row for each step of a case that is meant for this stepping."""
    for step in steps:
        scene = made(case, 1e-3 * step, stepping)
        if scene is None:
            continue
        try:
            history = rigidfluid.run(scene)
        except StepError as error:
            yield case, stepping, f"{step:g}", "", "", "", "", f"stops: {error.found}"
            continue
        friction = history.energy["path_friction"][-1] / max(put_in(history), np.finfo(float).tiny)
        created, lost, first = created_and_lost(history)
        shares = (f"{100.0 * share:.2f}" for share in (created, lost, friction, first))
        yield case, stepping, f"{step:g}", *shares, CONTACT_CASES[case][1](history).replace("|", "\\|")


def walls() -> None:
    """Flows along curved walls and through oblique ends against their exact solutions."""
    layers = (2, 4, 8, 16)
    bends = [curved_channels.flow_in_bend(count) for count in layers]
    exact = curved_channels.flux_through_bend()
    fluxes = [abs(curved_channels.flux_of(flow) / exact - 1.0) for flow in bends]
    speeds = [curved_channels.error_in_bend(flow) for flow in bends]
    torques = {}
    for name, spins in {"inner": (1.0, 0.0), "outer": (0.0, 1.0)}.items():
        flows = [curved_channels.flow_between_cylinders(count, *spins) for count in layers]
        expected = curved_channels.torque_between_cylinders(*spins)
        found = [flow.advance.hydrodynamic_wrench.torque[0, 0] for flow in flows]
        torques[name] = [abs(torque / expected - 1.0) for torque in found]
    columns = {
        "bend: flux": fluxes,
        "bend: velocity": speeds,
        **{f"cylinders, {name} turning: torque": values for name, values in torques.items()},
    }
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot(xlabel="layers of cells", ylabel="relative error", xscale="log", yscale="log")
    for (name, values), style in zip(columns.items(), ("o-", "s-", "x-", "+--"), strict=True):
        axes.plot(layers, values, style, label=name)
    axes.plot(layers, [2.0 * count**-3.0 for count in layers], "k:", label="order 3")
    axes.legend(fontsize=8)
    figure.savefig(OUT / "walls.png", dpi=120)
    rows = [
        (
            str(count),
            *(f"{values[i]:.1e} ({order(values, i)})" if i else f"{values[i]:.1e}" for values in columns.values()),
        )
        for i, count in enumerate(layers)
    ]
    text = (
        "Stokes flow in 2D between circles of radius 0.5 and 1, cells curved along them, from coarse to fine. The bend "
        "turns through 2 rad, with a pressure on its two ends, which lie across no axis; errors of its flux and its "
        "velocity (root mean square over its own) against u(r) = (G/2μ)(A r + B/r - r ln r). Between cylinders the "
        "disk inside turns, or the wall outside (`angular_velocity` of a `wall`); error of the torque on the "
        "disk against 4πμ(Ω₂ - Ω₁)R₁²R₂²/(R₂² - R₁²). In brackets the order of convergence.\n\n"
    )
    text += table(("layers", *columns), rows)
    arrays = [
        (str(layers), name, f"{(force := array_of_balls(d, layers)):.3f}", f"{force / exact_array(d) - 1.0:+.2%}")
        for d, name in ((2, "cylinders"), (3, "spheres"))
        for layers in ((2, 4, 8, 16) if d == 2 else (2, 4, 6))
    ]
    text += (
        "\n\n## Periodic surfaces\n\n"
        "Cubic arrays of balls of radius 0.2 and distance 1 in Stokes flow that a pressure drop drives, periodic in "
        "all directions: force on each over viscosity and mean velocity, against the series of Sangani and Acrivos "
        "1982, doi:10.1016/0301-9322(82)90029-5 and 10.1016/0301-9322(82)90047-7. The first of them has coefficients "
        "of three digits and ends with the cube of the volume fraction, which is 0.126 here.\n\n"
    )
    text += table(("layers", "of", "force", "off"), arrays)
    write_page("walls", "Curved walls and oblique ends", "python docs/make_validation.py walls", text)


def order(errors: list[float], i: int) -> str:
    """Of convergence by the last halving before the error of number ``i``."""
    return f"{np.log2(errors[i - 1] / errors[i]):.1f}"


def studied(name: str, plot: str = "") -> Results:
    """A study, run; its plot is kept, by its own name unless another is given."""
    with tempfile.TemporaryDirectory() as folder:
        results, _ = run_study(load_study(ROOT / "studies" / f"{name}.toml"), Path(folder), fresh=True)
        shutil.copy(Path(folder) / "study.png", OUT / f"{plot or name}.png")
    return results


def kernel_study(name: str, title: str) -> None:
    """A study of a kernel: its plot, and its runs in a table."""
    results, rows = studied(name), []
    for key, settings in zip(results.prints, results.plan, strict=True):
        outcome, front = results.outcomes.get(key), "yes" if key in results.front else ""
        figures = ("failed",) * 3 if outcome is None else (
            f"{outcome.figure:.1e}", f"{outcome.seconds:.1e}", str(outcome.unknowns)
        )  # fmt: skip
        rows.append((*cells(results.study.knobs, settings), *figures, front))
    text = f"Error of the {results.target.of} against {results.target.against}.\n\n"
    text += table((*results.study.knobs, "error", "seconds", "vertices", "Pareto front"), rows)
    text += f"\n\nThe same with a page of its own: `rigidfluid study studies/{name}.toml`."
    write_page(name, title, f"python docs/make_validation.py {name}", text)


def scene_rows(results: Results) -> str:
    """The runs of a study of a scene in a table: error and seconds, or that they failed."""
    rows, (group, knob) = [], results.study.knobs
    for key, settings in zip(results.prints, results.plan, strict=True):
        outcome, front = results.outcomes.get(key), "yes" if key in results.front else ""
        names = short_text(settings[group], results.study.tables.vary[group]), f"{settings[knob]:g}"
        figures = ("failed", "", "") if outcome is None else (
            f"{results.errors[key]:.1e}", f"{outcome.seconds:.2f}", str(outcome.steps)
        )  # fmt: skip
        rows.append((*names, *figures, front))
    return table((group, knob, "error", "seconds", "steps", "Pareto front"), rows)


def contact_stepping() -> None:
    """Ways to step through contacts, without a fluid and in one, and force laws."""
    dry, wet, laws = (scene_rows(studied(f"contact_{name}")) for name in ("stepping", "stepping_in_fluid", "laws"))
    text = CONTACT_STEPPING.format(dry=dry, wet=wet, laws=laws)
    write_page("contact_stepping", "Stepping through contacts", "python docs/make_validation.py contact_stepping", text)


def backends_study() -> None:
    """The falling disk by all fluid backends; left out where one is not installed, as its rows would be lost."""
    backends = load_study(ROOT / "studies" / "backends.toml").tables.vary["fluid.backend"]
    usable = {entry.name for entry in Registry.load().entries if entry.kind is FLUID_BACKEND and entry.available}
    if missing := sorted(set(backends) - usable):
        print(f"backends_study is left out: no backend {', '.join(missing)} here")
        return
    results = studied("backends", plot="backends_study")
    command = "OMP_NUM_THREADS=1 tools/dolfinx run python3 docs/make_validation.py backends_study"
    text = BACKENDS_STUDY.format(cores=os.cpu_count(), figures=backend_rows(results))
    write_page("backends_study", "Fluid backends: error against run time", command, text)


def backend_rows(results: Results) -> str:
    """A row for each mesh and step: what is the same of all backends, and the seconds of each."""
    rows: dict[tuple[str, str], dict[str, str]] = {}
    figures: dict[tuple[str, str], list[float]] = {}
    for key, settings in zip(results.prints, results.plan, strict=True):
        place = f"{settings['mesh.size_body']:g}", f"{settings['time.step']:g}"
        outcome, backend = results.outcomes[key], settings["fluid.backend"]
        same = {"unknowns": f"{outcome.unknowns}", "error": f"{results.errors[key]:.1e}"}
        rows.setdefault(place, same)[f"{backend} [s]"] = f"{outcome.seconds:.2f}"
        figures.setdefault(place, []).append(outcome.figure)
    for place, values in figures.items():
        rows[place]["heights apart"] = f"{max(values) - min(values):.0e}"
    head = ("mesh.size_body", "time.step", *next(iter(rows.values())))
    return table(head, [(*place, *row.values()) for place, row in rows.items()])


BACKENDS_STUDY = """`studies/backends.toml`: the falling disk until .2 s; the error is that of its height. On {cores}
cores, of which `OMP_NUM_THREADS=1` leaves one to each run; all backends in one Python, DOLFINx and OpenBLAS from
Debian 13.

{figures}

The last column is the largest difference of the heights that the backends find: round-off. So the error says nothing
about a backend, and the time alone can choose: the points of a mesh and a step lie side by side in the plot.

**What to choose when.**

* `scikit-fem` unless there is a reason: it comes with rigidfluid, needs neither compiler nor MPI, and none of the
  others is faster by much on one core.
* `dolfinx` where it is installed, with OpenBLAS: the fastest of the three, by a tenth to a third. It alone shares a run
  among processes, and in 3D its `schur` solver needs far less memory.
* `ngsolve` to check a result with another library's elements. It integrates three to four times as slowly as
  `scikit-fem`, and solves by the same factors; the steps take a third to a half longer.
* Whichever it is, refine mesh and step together. Here the mesh decides: from step .0025 on a shorter step gains
  nothing until `size_body` is below .0125.

See [backends](../backends.md) for what each can do, and [the seconds of a step by stage](backends.md)."""


CONTACT_STEPPING = """Three ways through contacts: one explicit substep a step (`contact.substeps = 1`), as many
substeps as contacts need (the default), and one implicit step (`contact.stepping = "implicit"`). Runs that failed are
in the tables and not in the plots; explicit runs with long steps end in overlap, also after the step was cut a
thousandfold, or are far off. Seconds are of a machine that did other work as well.

**What to choose.** Substeps, unless there is a reason: they are right with long steps, and in a fluid they hold bodies
at rest with the stiffest laws. Implicit contacts where the energy must not drift, however long the run and the step
are; not with dampers that steps do not resolve. One explicit substep only where the step resolves every contact.

## Two disks without a fluid

`studies/contact_stepping.toml`, the plot above. Substeps find the moment of an impact within a step, and are exact to
four digits with the longest steps. They stay the same through an impact, however many steps it lasts. In the second
one the disks hit a wall and, before they leave it, the floor; where that is foreseen in a later step, substeps change
in the midst of the impact, which costs some energy, most with steps of 5e-5. The implicit step keeps the energy to
1e-8 at all steps; its error is when the impact takes place, so it is of first order until steps resolve the contact,
and then of second.

{dry}

## A disk in a fluid

![A disk in a fluid](contact_stepping_in_fluid.png)

`studies/contact_stepping_in_fluid.toml`: the speed on the way up after an impact. The reference is known to 5e-4.
Until the step resolves the impact its error depends on where in a step the impact falls, so that single runs are right
by luck.

{wet}

## Force laws

![Force laws](contact_laws.png)

`studies/contact_laws.toml`: energy gained or lost with one explicit substep a step, for laws of equal strength: all
stop the fastest blow at a quarter of the range. The three smooth laws want about the same steps: `barrier` is the first
to go wrong with long steps, as it is the stiffest near contact. The force of `spring-dashpot` has a kink at the range,
so short steps gain less there.

{laws}"""


STOKES_CONTACTS = """The scenes are those of `tests/support/stokes_contacts.py`: disks of radius .1 cm in a fluid of
density 1 and viscosity .3, pressed by their weight onto a wall with the range .03 cm; what is derived, and how, is in
[numerics](../numerics.md#contacts), and what it was before in [the decision](../decisions/43-stokes-contacts.md).

* force / weight: of the contacts with walls, its mean over the last fifth of the run, and the extremes there.
* speed: the highest in that fifth, and the highest ever. A disk sinks at 1.1 to 1.3 cm/s.
* gap: at the end, less the one at which the contact bears the weight exactly, by bisection; of several bodies the
  least ever.
* created, lost: the extremes of the energy balance's residual after the first step, over what was put in.
* steps: made in all. Runs begin with steps of a 64th that at most double. A body starts from rest where it should move
  at once, and the second step's prediction knows of it: most of what is lost at steps of .1 s is that.

{rows}"""

CONTACTS_IN_FLUID = """The scenes are those of `tests/support/fluid_contacts.py`: disks of radius .1 cm and density 3 in
water, with contacts that are ten to a thousand times shorter than a step; what is derived, and how, is in
[numerics](../numerics.md#contacts).

* created: the most negative residual of the energy balance after the first step, less the first step's own; lost: the
  most positive. Both over what was put in, energy stored at the start and the most that gravity and driven
  bodies had worked.
* friction: `path_friction`, what the bodies' friction took between the fluid's solutions, over the same. It explains up
  to so much of what was lost; it is no part of the residual.
* first step: what it created.

Aimed at are at most 3 % created, and 1 % with steps of 1 ms and less, and at most 30, 15, 7 and 4 % lost with steps of
4, 2, 1 and .5 ms. Above that are: {over}.

A step in which an impact would lose much is shortened, to an eighth at most, so that the longer steps lose about as
much as each other. In the squeezed channel both walls push the disk all the time, and all steps are short.

{energies}

## Rest

F/W is the contact's force over the weight in the last fifth of the run, mean and extremes. Where next to nothing was
put in, the shares of energy mean little.

{resting}"""


def taken_up(scene: Scene, out: Path) -> None:
    """A run in a folder, completed from where it was stopped."""
    if not (out / "summary.json").exists() or json.loads((out / "summary.json").read_text())["status"] != "complete":
        rigidfluid.run(scene, out, resume=(out / "state.h5").exists())


def kept(out: Path) -> History:
    """The history of a run in a folder."""
    history = History(2, folder=out)
    history.summary = json.loads((out / "summary.json").read_text())
    return history


def hundred_disks() -> None:
    """Case 6 of arXiv:2402.19093 to its end, from a run that is taken up where it was stopped."""
    out = ROOT / "out" / "hundred_disks"
    scene = rigidfluid.load_scene(ROOT / "scenes" / "hundred_disks.toml")
    taken_up(scene, out)
    history = kept(out)
    summary = history.summary
    bodies, energy, count = history.bodies, history.energy, len(scene.body)
    time, *state = (bodies[name].reshape(-1, count) for name in ("time", "x", "y", "vx", "vy", "gap"))
    shown = [int(np.argmin(np.abs(time[:, 0] - t))) for t in (0.0, 1.0, 2.0, 3.0, scene.time.end)]
    figure = Figure(figsize=(12.0, 4.8), layout="constrained")
    for step, axes in zip(shown, figure.subplots(1, len(shown)), strict=True):
        for x, y, body in zip(state[0][step], state[1][step], scene.body, strict=True):
            axes.add_patch(Circle((x, y), body.radius, facecolor="steelblue", edgecolor="black", linewidth=0.3))
        axes.set(xlim=(0, 1), ylim=(0, 2), aspect="equal", title=f"t = {time[step, 0]:.1f} s", xticks=[], yticks=[])
    figure.savefig(OUT / "hundred_disks.png", dpi=80)
    seconds, speed = summary["wall_time_per_stage"], np.hypot(state[2], state[3]).max(axis=1)
    contacts = len(history.contacts["time"]) / summary["steps"]
    stages = table(
        ("stage", "share of the run [%]"), ((k, f"{100 * v / sum(seconds.values()):.0f}") for k, v in seconds.items())
    )
    text = HUNDRED_DISKS.format(
        time=time[-1, 0],
        steps=summary["steps"],
        rejected=summary["rejected_steps"],
        remeshes=summary["remeshes"],
        unknowns=summary["unknowns"],
        hours=summary["wall_time"] / 60.0,
        contacts=contacts,
        gap=summary["smallest_gap"],
        fastest=speed.max(),
        last=speed[-1],
        kinetic=energy["kinetic"][-1],
        transfer=summary["energy"]["transfer_loss"],
        created=100 * summary["energy"]["created"],
        lost=100 * summary["energy"]["lost"],
        put_in=summary["energy"]["put_in"],
        stages=stages,
    )
    write_page("hundred_disks", "A hundred disks settle", "python docs/make_validation.py hundred_disks", text)


HUNDRED_DISKS = """`scenes/hundred_disks.toml` as shipped: the paper's law, box and step.

| | |
| --- | --- |
| end [s] | {time:.3g} |
| steps, rejected, new meshes | {steps}, {rejected}, {remeshes} |
| unknowns at the end | {unknowns:,} |
| wall time of one thread [min] | {hours:.0f} |
| contacts in range, mean over the steps | {contacts:.0f} |
| smallest gap [cm] | {gap:.4f} |
| highest speed of the run, and at its end [cm/s] | {fastest:.2f}, {last:.1e} |
| energy put in, created, lost | {put_in:.2f} erg/cm, {created:.3f} %, {lost:.3f} % |
| lost by re-meshing [erg/cm] | {transfer:.4f} |

{stages}"""


COARSER = ["mesh.size_body=2.4e-4", "mesh.size=1.2e-3", "mesh.refine.0.size=4e-4"]
FINER = ["mesh.size_body=6e-5", "mesh.size=3e-4", "mesh.refine.0.size=1e-4"]
UNTIL_BOTH_ARE_THROUGH = ["time.step=4e-5", "time.end=0.008"]
OTHERWISE = ["body.0.position=[-0.0068, 0.0017]", "body.1.position=[-0.0068, -0.0017002125]"]
HIGHER = ["boundary.0.pressure=5410.0", "time.step=4e-6", "time.end=0.00095", "output.every=2e-5"]
STENOSIS = {
    "coarse": ("d/3.5, 4e-5", [*COARSER, *UNTIL_BOTH_ARE_THROUGH]),
    "step4": ("d/7, 4e-5", UNTIL_BOTH_ARE_THROUGH),
    "fine": ("d/14, 4e-5", [*FINER, *UNTIL_BOTH_ARE_THROUGH]),
    "step2": ("d/7, 2e-5", ["time.step=2e-5", "time.end=0.008"]),
    "shipped": ("d/7, 1e-5, as shipped", []),
    "mirrored": ("d/7, 4e-5, the lower disk farther out", [*OTHERWISE, *UNTIL_BOTH_ARE_THROUGH]),
    "contact": ("d/7, 4e-5, law `contact`", ["contact.law=contact", *UNTIL_BOTH_ARE_THROUGH]),
    "strong": ("d/7, 4e-6, 5410 dyn/cm²", HIGHER),
}
"""By folder: mesh.size_body and time.step, and what differs from the scene as shipped."""
DIAMETER, MOMENTS = 8.5e-4, (0.0042, 0.0054, 0.0060, 0.0066)


def stenosis() -> None:
    """Case 7 of arXiv:2402.19093, its halvings and its other readings, each from where it was stopped."""
    folder, rows = ROOT / "out" / "stenosis", []
    for name, (label, overrides) in STENOSIS.items():
        try:
            taken_up(rigidfluid.load_scene(ROOT / "scenes" / "stenosis.toml", overrides), folder / name)
        except StepError as error:
            print(f"{name}: {error}")
        history = kept(folder / name)
        rows.append((label, *stenosis_figures(history)))
        if name == "shipped":
            picture_of_stenosis(history, folder / name).savefig(OUT / "stenosis.png", dpi=100)
    head = ("disk's edges, step [s]", "order", "the first at -3d [ms]", "in the throat [ms]", "between them [ms]")
    head += ("the second goes back [d]", "smallest gap [d]", "created, lost [%]")
    head += ("steps, rejected, new meshes, failed", "unknowns")
    text = ABOUT_STENOSIS.format(figures=table(head, rows))
    write_page("stenosis", "Two disks in a stenosed artery", "python docs/make_validation.py stenosis", text)


def way_of(history: History, name: str) -> dict[str, np.ndarray]:
    """The rows of one body, lengths in diameters of the disks and times in ms."""
    bodies = history.bodies
    own = bodies["body"] == name
    units = {"time": 1e-3, "x": DIAMETER, "y": DIAMETER, "gap": DIAMETER}
    return {column: bodies[column][own] / unit for column, unit in units.items()}


def picture_of_stenosis(history: History, folder: Path) -> Figure:
    """The flow at four moments, the disks' paths, their gaps, and the balance of energy."""
    figure = Figure(figsize=(12.0, 10.0), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(5, 6))
    series, moments = dict(read_pvd(folder / "fields.pvd")), top.subplots(2, 2, sharex=True, sharey=True).ravel()
    for axes, moment in zip(moments, MOMENTS, strict=True):
        at = min(series, key=lambda time: abs(time - moment))
        fields = read_vtu(series[at])
        speed, triangles = np.linalg.norm(fields.velocity, axis=1), fine_triangles(fields)
        triangles.x, triangles.y = triangles.x / DIAMETER, triangles.y / DIAMETER
        colours = axes.tripcolor(triangles, speed, shading="gouraud", cmap=COLOURMAP, vmin=0.0, vmax=7.0)
        axes.set(title=f"{1e3 * at:.1f} ms", xlim=(-10, 10), aspect="equal", facecolor=BODY)
    top.colorbar(colours, ax=moments, label="speed [cm/s]")
    panels = bottom.subplot_mosaic([["path", "path"], ["gap", "energy"]])
    panels["path"].set(
        xlabel="along the channel [d]", ylabel="across [d]", xlim=(-16, 16), ylim=(-4, 4), aspect="equal"
    )
    panels["gap"].set(xlabel="time [ms]", ylabel="gap [d]", ylim=(0, 2))
    panels["energy"].set(xlabel="time [ms]", ylabel="residual over energy put in [%]")
    for side in (-4.0, 4.0):
        panels["path"].add_patch(Circle((0.0, side), 3.125, facecolor="lightgrey"))
    paths = {name: way_of(history, name) for name in ("upper", "lower")}
    for name, way in paths.items():
        panels["path"].plot(way["x"], way["y"], label=name)
        for moment in MOMENTS:
            centre = [np.interp(1e3 * moment, way["time"], way[along]) for along in ("x", "y")]
            panels["path"].add_patch(Circle(centre, 0.5, fill=False))
        panels["gap"].plot(way["time"], way["gap"], label=f"{name} to the nearest")
    upper, lower = paths.values()
    apart = np.hypot(upper["x"] - lower["x"], upper["y"] - lower["y"]) - 1.0
    panels["gap"].plot(upper["time"], apart, "k:", label="between the disks")
    panels["gap"].axhline(3e-4 / DIAMETER, color="grey", ls="--", label="contact.range")
    energy, put_in = history.energy, history.summary["energy"]["put_in"]
    panels["energy"].plot(1e3 * energy["time"], 100 * energy["residual"] / put_in)
    panels["path"].legend()
    panels["gap"].legend()
    return figure


def stenosis_figures(history: History) -> tuple[str, ...]:
    """What the page tells of one run."""
    ways = {name: way_of(history, name) for name in ("upper", "lower")}
    passes = {name: np.interp(0.0, way["x"], way["time"], right=np.inf) for name, way in ways.items()}
    first, second = sorted(passes, key=passes.__getitem__)
    x, summary = ways[second]["x"], history.summary
    counts = ("steps", "rejected_steps", "remeshes", "failed_remeshes")
    return (
        f"{first}, {second}",
        f"{np.interp(-3.0, ways[first]['x'], ways[first]['time']):.4f}",
        f"{passes[first]:.4f}, {passes[second]:.4f}",
        f"{passes[second] - passes[first]:.4f}",
        f"{(np.maximum.accumulate(x) - x).max():.3f}",
        f"{summary['smallest_gap'] / DIAMETER:.4f}",
        f"{100 * summary['energy']['created']:.3f}, {100 * summary['energy']['lost']:.3f}",
        ", ".join(str(summary[name]) for name in counts),
        f"{summary['unknowns']}",
    )


ABOUT_STENOSIS = """`scenes/stenosis.toml`, case 7 of arXiv:2402.19093: pressure drives two disks of diameter
d = 8.5e-4 cm through a channel that two round bumps narrow to 1.75d. They are as heavy as the fluid and start 8d before
the throat, 2d above and below the middle; the upper one is d/4000 farther out. Published is the order alone: the lower
disk passes first, and the upper one stops, goes back and follows (Van Landeghem et al.; Li et al., Phys. Rev. E 69
(2004) 031919). So it is here. In the picture the circles on the paths are the disks at the four moments.

{figures}

* At -3d: when the disk that passes first is 3d before the throat; in the throat: when the first and the second are in
  its middle; `inf` is never. The second goes back by so much against the stream. Gaps are the smallest of the run.
  Created and lost are the signed residual of the energy, over what the pressure put in; of what was lost, friction
  in impacts is taken off.
* **Halvings.** The order stays. The time at -3d differs by .0051 and .0008 ms when edges are halved twice, by .0082
  and .0018 ms when steps are; the time between the two by .0004, .0003 and .0057, .0030 ms. The times in the throat
  differ by .02 ms between steps and between finer meshes, by .08 ms from the coarsest: where the disks meet, the lead
  of one grows fourteenfold in .2 ms, so a lead that a mesh changes by a fifth moves all that follows by .015 ms.
* **What decides the order.** At 4 ms the lead is 4.0e-4 d, and -4.2e-4 d where the lower disk is the one farther out
  (the sixth row): meshes that are not symmetric add 1e-5 d. So it is the d/4000 that decides, with edges of d/7; with
  d/14 the lead is 5.8e-4 d, so its sign is sure and its size is not. With d/3.5 the lead is 1.2e-3 d, most of it the
  mesh's: the order is right there by luck, and a coarser mesh far from the disks (`mesh.size` 8e-4) had the upper one
  first.
* **The law.** The force joins centres: at most d·range²/ε = 7.65 dyn/cm between the disks and 10.2 at walls. Where
  the disks block the throat it gives 1.2 dyn/cm at a gap of .23d. The form that joins contact points gives .40 and
  .53 at most and nothing at contact: it does not hold them apart. They enter the throat together, touch, and the mesh
  fails at 6.42 ms.
* **The pressure.** The paper's "541 Pa" is 5410 dyn/cm². The disks then pass within .8 ms; the law is at its limit,
  with gaps of .001d, and the upper disk hardly goes back. With 541 dyn/cm² they pass within the paper's .01 s as in
  its pictures: that is what the scene has.
* **To the outlet.** The scene ends at 14.5 ms, the lower disk 1.4d before the outlet. Nothing repels a disk there,
  and the mesh fails .005d before it, at 15.17 ms."""


def adaptive_step() -> None:
    """Errors over CPU seconds, with fixed steps and with tolerances, of two scenes."""
    figure, tables = Figure(figsize=(12.0, 7.0), layout="constrained"), []
    cases = {"falling disk": adaptive.FALLING, "flow started at once": adaptive.STARTED}
    for panels, (title, case) in zip(figure.subplots(2, 3), cases.items(), strict=True):
        reference, *runs = adaptive.outcomes(case)
        errors = [case.errors(run.history, reference.history) for run in runs]
        fixed, free = slice(len(case.steps)), slice(len(case.steps), None)
        shown = ("velocity, rms", "passage, greatest [s]") if case is adaptive.FALLING else list(errors[0])[:2]
        for axes, name in zip(panels, shown, strict=False):
            for where, style, label in ((fixed, "o-", "fixed steps"), (free, "s-", "tolerances")):
                seconds = [run.seconds for run in runs[where]]
                axes.loglog(seconds, [found[name] for found in errors[where]], style, label=label)
            axes.set(xlabel="CPU seconds", ylabel=f"error of {name}", title=title)
        for run in runs[free]:
            times = run.history.energy["time"]
            panels[-1].step(times[1:], np.diff(times), where="pre", label=run.label)
        panels[-1].set(xlabel="time [s]", ylabel="step [s]", yscale="log", title=title)
        panels[0].legend()
        panels[-1].legend()
        rows = [step_row(*pair) for pair in zip(runs, errors, strict=True)]
        tables.append(table(("", "CPU s", "steps", "rejected", *errors[0], "created [%]", "lost [%]"), rows))
    figure.savefig(OUT / "adaptive_step.png", dpi=100)
    text = ADAPTIVE_STEP.format(falling=tables[0], started=tables[1])
    command = "OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 python docs/make_validation.py adaptive_step"
    write_page("adaptive_step", "Steps by a tolerance", command, text)


def step_row(run: adaptive.Outcome, errors: dict[str, float]) -> tuple[str, ...]:
    """A run in the table: what it cost, its errors, and its balance of energy."""
    summary = run.history.summary
    cost = f"{run.seconds:.1f}", f"{summary['steps']}", f"{summary['rejected_steps']}"
    balance = (f"{100.0 * summary['energy'][name]:.3f}" for name in ("created", "lost"))
    return run.label, *cost, *(f"{error:.1e}" for error in errors.values()), *balance


ADAPTIVE_STEP = """`time.tolerance` beside fixed steps, on one mesh size each. Errors are those against the same
scene with a step of
.25 ms (falling disk) and 3.125 ms (flow started at once); CPU seconds of one thread, start and meshes included.
Runs with a tolerance have a longest step of 32 ms and .4 s. How steps are chosen is in
[numerics](../numerics.md#steps-by-a-tolerance).

**What to choose.** A tolerance where phases differ: a flow or a body that starts at once, a body that lands, comes
to rest or starts late. .001 is a good first guess. Fixed steps where the motion changes little, where only
positions count, and in bounces.

## A falling disk until it has landed

`scenes/falling_disk.toml` with `size_body` .025; about 6 s of each run are start and new meshes. Passage: of 2, 1
and .5 cm.

* Velocity: tolerances of .001 and .0003 give the same error as fixed steps with three fifths of the steps and three
  quarters to four fifths of the time, interpolated between fixed steps. One of .01 is no better than fixed steps.
* Times of passage and heights: fixed steps win, thirty- to a hundredfold in the times. Their errors are small by
  cancellation. With 8 ms the first step ends .05 cm/s too slow, .9 % of the greatest speed; what height is lost by
  that, Adams–Bashforth 2 takes back later with the other sign: it is off by 5e-4 cm at .02 s and by 7e-5 cm at .43
  s. With a tolerance the start is exact, and the later errors, all of one sign, add up.
* Errors are in proportion to the tolerance: of the height 1.8e-3 cm on a way of 3.9 cm with .003, and 2.1e-4 with
  .0003.

{falling}

## A flow started at once

`scenes/dfg_cylinder.toml` with `size_body` .006: a cylinder that is held in a stream which starts in the first
step. The mesh stays as it is.

* Drag after .2 s: the same error as with fixed steps in half the time.
* Drag from .02 s on: 1.3 % in 1.9 s with a tolerance, and in 16.8 s with fixed steps. Longer fixed steps show the
  pulse of pressure that starts the flow, and in the second step its counterpart of the other sign.
* A tolerance of .0003 shortens the fourth step eightfold, and the drag is off by 14 % at some time from .02 s on.
* The kinetic energy gains little: a tolerance costs four fifths of the time of a fixed step with the same error.
* What is lost, 15 %, is the work of the pulse in the second step, whatever the steps; the third one gives it back.

{started}

## Changes of step, and impacts

At most one step in 28 is rejected. A further step of the falling disk costs 21 ms with tolerances, 15 to 22 ms with
fixed steps: changes of step, about a dozen in a run, cost nothing that shows.

In an impact a tolerance says nothing: contacts have their substeps. `scenes/bounce_in_fluid.toml`, measured apart:
the velocity after the bounce is off by up to .022 and .0063 cm/s with fixed steps of .25 and .125 ms, in 2.3 and
3.3 s; by .022 and .0065 cm/s with tolerances of .0003 and .0001, in 3.5 and 4.4 s."""


WAYS: dict[Way, int] = {"fill": 20, "level_set": 5}
"""How many arrangements in the plane are tried in each way; in space it is one."""

INSERTION = """Balls and ellipsoids in turn, at random places and angles, none nearer than 0.12 to anything. The
stenosis is 32 by 8 with a throat of 1.75, its bodies have radii of .25 to .5, and facets are .1 on them and up to .5
on the walls; the tube has radius 1, its bodies .2 to .35, and facets are .08 and .4. `quality` is that of the worst
cell, the least of all arrangements and the median. `vertices off`: farthest vertex of a body from its shape.
`middles`: farthest middle of a facet, over what facets as long as the longest cut off the narrowest curvature, h²/8R
in the plane and h²/6R in space. `walls kept`: share of the vertices of curved walls that are in the mesh to the last
bit. Seconds are CPU seconds of one arrangement.

"""

SHOWN = """

## The scenes `insertion_2d.toml` and `insertion_3d.toml`

A collection of shapes in a vessel from a mesh file, and three balls in a row, an egg and bodies from STL files in a
bent tube from a STEP file, as in the appendix of arXiv:2402.19093. `given vertices kept`: corners of a shape made of
facets that are in the mesh to the last bit. A level set does not come onto the re-entrant corner of the arrow, body 6.
Colours show the pieces of the boundary, and in space the quality of
cells in a slice.

"""


WALLS_THAT_STAY = """
## Walls that stay

A disk of diameter 1 goes through the throat of the stenosis, and the mesh is made anew at 50 stops. Facets of the bumps
are kept or halved with the new vertex on the circle. `vertices off`: farthest vertex of a bump from its circle.

"""

GAPS = """

## Gaps to curved walls

Of a disk of radius .5 and an ellipse with semi-axes .6 and .3 beside and in the throat, by the detector on the mesh,
against the exact one. Bound: (h_w²/R + h_b²/r)/8 for the facets of wall and body that are nearest to each other.

"""


def insertion() -> None:
    """Bodies in curved and irregular domains by filling between facets, and by cutting along a level set."""
    head = ("case", "way", "failed", "cells", "quality", "vertices off", "middles", "walls kept", "walls' area", "s")
    rows = [insertion_row(name, way) for name in insertions.CASES for way in WAYS]
    text = INSERTION + table(head, rows) + SHOWN
    head = ("scene", "way", "surface", "shape", "facets", "given vertices kept", "vertices off", "middles off")
    shown = [("insertion_2d", "fill"), ("insertion_2d", "level_set"), ("insertion_3d", "fill")]
    text += table(head, (row for scene, way in shown for row in inserted_rows(scene, way)))
    text += "\n\n![Shapes in a vessel](insertion_2d.png)\n\n![Bodies in a bent tube](insertion_3d.png)\n"
    text += WALLS_THAT_STAY + table(
        ("new meshes", "area less the exact one", "vertices off", "quality", "facets"), drift()
    )
    head = ("body", "at", "facets", "gap", "error", "bound")
    text += GAPS + table(head, map(gap_row, curved_gaps()))
    write_page("insertion", "Insertion of bodies", "python docs/make_validation.py insertion", text, plot=False)


def drift() -> Iterable[tuple[str, ...]]:
    """Rows of what becomes of the stenosis' walls, after every tenth new mesh, and the worst of all."""
    found = list(wall_drift())
    for one in found[::10]:
        yield _drift_row(str(one.remeshings), one.area_error, one.off_wall, one.quality, one.curved_facets)
    worst = max(one.off_wall for one in found), min(one.quality for one in found)
    yield _drift_row("worst of all", max(one.area_error for one in found), *worst, found[-1].curved_facets)


def _drift_row(name: str, area: float, off: float, quality: float, facets: int) -> tuple[str, ...]:
    return name, f"{area:.4f}", f"{off:.0e}", f"{quality:.2f}", str(facets)


def gap_row(gap: CurvedGap) -> tuple[str, ...]:
    """One row of `insertion`'s last table."""
    place = f"({gap.place[0]:g}, {gap.place[1]:g})"
    return gap.shape, place, f"{gap.size:g}", f"{gap.exact:.4f}", f"{gap.error:.1e}", f"{gap.bound:.1e}"


def insertion_row(name: str, way: Way) -> tuple[str, ...]:
    """One row of `insertion`'s first table."""
    case, found, failed = insertions.CASES[name](), [], 0
    count = WAYS[way] if case.domain.dimension == 2 else 1
    for seed in range(count):
        try:
            found.append(insertions.outcome(case, seed, way))
        except MeshError as error:
            print(f"{name}, {way}, seed {seed}: {error}")
            failed += 1
    qualities = [outcome.quality for outcome in found]
    return (
        name,
        way,
        f"{failed} of {count}",
        f"{np.mean([outcome.cells for outcome in found]):.0f}",
        f"{min(qualities):.2f} / {np.median(qualities):.2f}",
        f"{max(outcome.vertices_off for outcome in found):.0e}",
        f"{max(outcome.middles_off for outcome in found):.2f}",
        f"{min(outcome.kept for outcome in found):.0%}",
        f"{max(outcome.area_change for outcome in found):.0e}",
        f"{np.mean([outcome.seconds for outcome in found]):.1f}",
    )


def inserted_rows(scene: str, way: Way) -> Iterable[tuple[str, ...]]:
    """A row for each surface of a scene's mesh, whose picture is kept where it was filled."""
    with tempfile.TemporaryDirectory() as folder:
        loaded = rigidfluid.load_scene(ROOT / "scenes" / f"{scene}.toml", [f"mesh.inserter={way}"])
        try:
            figures, _ = insert(loaded, Path(folder))
        except MeshError as error:
            yield scene, way, f"fails at {error.subject}: {error.found}", "", "", "", "", ""
            return
        if way == "fill":
            shutil.copy(Path(folder) / "mesh.png", OUT / f"{scene}.png")
    size = f"{figures.cells} cells, quality {figures.worst_quality:.2f}"
    yield scene, way, size, "", "", "", "", ""
    for surface in figures.surfaces:
        kept = "" if surface.given_corners is None else f"{surface.kept_corners} of {surface.given_corners}"
        off = f"{surface.vertices_off:.0e}", f"{surface.middles_off:.1e}"
        yield "", "", surface.name, surface.kind, str(surface.facets), kept, *off


VORTEX_RUNS = {
    19.8: ["body.0.spring.stiffness=[0.0,9.9]"],
    9.88: [],
    4.74: ["body.0.spring.stiffness=[0.0,2.37]", "time.end=125.0"],
}
"""By k*; each goes on until its amplitude is steady."""


def vortex_induced() -> None:
    """A cylinder on springs of three stiffnesses, and fixed, in a stream at Re = 100."""
    tables = rigidfluid.load_scene(ROOT / "scenes" / "vortex_induced.toml", ["time.end=80.0"]).to_dict()
    cylinder = {key: value for key, value in tables["body"][0].items() if key not in ("free", "spring")}
    held = rigidfluid.scene_from_dict(tables | {"body": [cylinder | {"fixed": True}]})
    swinging = {k: run("vortex_induced.toml", overrides)[0] for k, overrides in VORTEX_RUNS.items()}
    vortex_page(rigidfluid.run(held), swinging)


def vortex_page(held: History, swinging: dict[float, History]) -> None:
    """From the histories of the cylinder that is held and of those on springs, by k*."""
    figure = Figure(figsize=(8.0, 5.6), layout="constrained")
    panels = figure.subplots(len(swinging), 1, sharex=True)
    for axes, (stiffness, history) in zip(panels, swinging.items(), strict=True):
        axes.plot(history.bodies["time"], history.bodies["y"], linewidth=0.8)
        published = vortices.PUBLISHED.get(stiffness)
        for sign in (-1.0, 1.0) if published else ():
            axes.axhline(sign * published.amplitude, color="black", linewidth=0.8, linestyle="--")
        axes.set(ylabel="y/D", title=f"k* = {stiffness}")
    panels[-1].set_xlabel("time · U/D")
    figure.savefig(OUT / "vortex_induced.png", dpi=120)
    head = ("k*", "U/(f_n D)", "of", "amplitude/D", "frequency · D/U", "lift, amplitude", "drag, mean")
    rows = list(vortex_rows("fixed", "", vortices.FIXED, held))
    for stiffness, history in swinging.items():
        reduced = f"{2.0 * np.pi * np.sqrt(5.0 / stiffness):.2f}"
        rows += vortex_rows(str(stiffness), reduced, vortices.PUBLISHED.get(stiffness), history)
    head += ("amplitude grows in 5 periods", "energy created", "unknowns", "remeshes")
    command = "python docs/make_validation.py vortex_induced"
    write_page("vortex_induced", "Vortex-induced vibration", command, f"{table(head, rows)}\n\n{VORTEX_TEXT}")


VORTEX_TEXT = """A cylinder of diameter D is free across a stream U alone and hangs on a spring, without damper
(`scenes/vortex_induced.toml`): Re = UD/ν = 100, mass m* = m/(½ρD²) = 5 and stiffness k* = k/(½ρU²) per length; f_n is
√(k/m)/2π, without added mass. Figures are of the last five periods; dashed lines are the published amplitudes. The box
reaches 20 D to the inlet and to either side (blockage 2.5 %) and 30 D to the outlet, and the sides let the fluid slip.

Published: D. Shiels, A. Leonard, A. Roshko, J. Fluids Struct. 15 (2001) 3, doi:10.1006/jfls.2000.0330, table 2, by a
vortex method in an unbounded fluid; the figures are taken from works that quote them. At k* = 9.88 and 4.74
vortices and cylinder swing together (lock-in), away from the frequency at which a fixed cylinder sheds. At k* = 19.8
the cylinder hardly moves; nothing published was at hand to compare with.

Energy is created in coarse cells far downstream, from when vortices come there, and not by the spring. With cells of
0.7 D there (a second `[[mesh.refine]]` from [8, -5] to [30, 5], 24229 unknowns) the residual at k* = 4.74 and time 75
is 0.13 in place of -1.91, and amplitude, frequency and drag are 0.4591, 0.1531 and 1.7065 then."""


def vortex_rows(name: str, reduced: str, published: vortices.Swing | None, history: History) -> Iterable[tuple]:
    """What was published, if anything, and what was measured."""
    if published is not None:
        yield name, reduced, "Shiels et al.", *(f"{value:g}" for value in published), "", "", "", ""
    summary, found = history.summary, vortices.measured(history)
    grows = f"{vortices.growth(history):.1%}" if found.amplitude else ""
    cost = (f"{summary['energy']['created']:.2%}", str(summary["unknowns"]), str(summary["remeshes"]))
    yield name, reduced, "rigidfluid", *(f"{value:.4f}" for value in found), grows, *cost


HALVES = (20.0, 30.0, 45.0)
PAIR = 2.2553


def swimmer_3d() -> None:
    """The three-sphere swimmer in cubes of three sizes, against the exact flow without walls."""
    exact = {stroke: float(exact_cycle(10.0, stroke).sum()) for stroke in (0.5, 1.0, 2.0, 4.0)}
    boxes = {far: [swim(half, far) for half in HALVES] for far in ("wall", "pressure")}
    small, *_, large = boxes["wall"]
    shorter = {stroke: small if stroke == 4.0 else swim(stroke=stroke) for stroke in exact}
    others = {name: swim(overrides=overrides) for name, overrides in OTHER_SWIMS.items()}
    text = SWIMMER_3D + table(("half-width", *boxes), box_rows(boxes, exact[4.0]))
    text += EACH_STROKE + table(("", *PHASES), stroke_rows(large))
    text += LAW_OF_STROKES + table(("stroke", "measured/stroke²", "exact/stroke²", "off"), law_rows(shorter, exact))
    rows = [swim_row(name, found) for name, found in {"as shipped": small, **others}.items()]
    text += OTHERS + table(("", "displacement", "off the line", "unknowns", "steps", "CPU s"), rows)
    widths = (f"half-width {half:g}" for half in HALVES)
    text += DRAG + table(("spheres", *widths, "no box", "exact", "off"), drag_rows())
    seconds = sum(found.seconds for found in [*chain(*boxes.values()), *shorter.values(), *others.values()])
    text += f"\n\nThe swims of this page took {(seconds - small.seconds) / 60.0:.0f} minutes of CPU time."
    figure = Figure(figsize=(6.0, 3.6), layout="constrained")
    axes = figure.add_subplot(xlabel="(arm/half-width of the cube)⁵", ylabel="displacement in a cycle [radii]")
    nearness = (10.0 / np.array(HALVES)) ** 5
    for far, swims in boxes.items():
        axes.plot(nearness, [found.displacement for found in swims], "o-", label=f"faces of type {far}")
    axes.plot(0.0, exact[4.0], "k+", markersize=12, label="exact, no walls")
    axes.legend()
    figure.savefig(OUT / "swimmer_3d.png", dpi=120)
    write_page("swimmer_3d", "Swimmer in three dimensions", "python docs/make_validation.py swimmer_3d", text)


SWIMMER_3D = """Three spheres of radius 1 in a row, whose arms of 10 shorten and lengthen by 4 in turn
(`scenes/swimmer_3d.toml`): Stokes flow, and spheres too light to have inertia. Exact are series of Stokes' stream
function about each sphere, in a fluid without walls (`tests/support/spheres_on_a_line.py`,
doi:10.1017/S0022112071002854). Displacements are those of the middle sphere, in radii.

## How far walls matter

The swimmer is in the middle of a cube. All faces are walls; or no fluid moves along them, and the traction across
them is zero (`pressure`).

What a box reflects to the swimmer is smooth there, and the middle of a cube is a centre of symmetry: velocities per
force are a constant, 1/half-width, then terms of second order in the places of both spheres, 1/half-width³, then of
fourth, 1/half-width⁵. The constant moves all spheres alike in proportion to the total force, which is zero. Terms of
second order cancel in a cycle as far as forces are in proportion to velocities: the common velocity is Σ x² dx/dt, a
derivative. What is left of them is smaller by radius/arm, so that the fourth order is what shows, with either kind of
faces.

"""
EACH_STROKE = """

Each cube has a mesh of its own, and what finer meshes change, below, is as much as what walls do.

## Stroke by stroke

In the largest closed cube:

"""
LAW_OF_STROKES = """

A cycle is what is left of strokes that are nine times as long: an error of .3 % in the two that go forth alone would
be one of 5 % in the cycle.

## Displacement and stroke

In the smallest closed cube. The displacement is proportional to the square of the stroke where that is short; arms
with long strokes are shorter on average.

"""
OTHERS = """

## Steps, meshes and the way back

In the smallest closed cube. The mesh is moved with the spheres and not made anew: one that begins round short arms is
stretched when they lengthen, and is less accurate then.

"""
DRAG = """

## Drag

Errors of mesh and box apart: spheres move along their line, and what is listed is the drag on one of them over 6πμ,
in closed cubes. A box makes it 1/(1/drag - k/half-width), so that a line through 1/drag leads beyond it. What is off
there is the mesh's error. All three spheres of the swimmer have the same, and a factor common to all forces does not
change how it swims.

"""


PHASES = ("left in", "right in", "left out", "right out")
OTHER_SWIMS = {
    "half the step": ["time.step=0.125"],
    "strokes reversed": [BACK],
    "strokes reversed, begun with short arms": [BACK_FROM_SHORT],
    "size_body 0.5": ["mesh.size_body=0.5"],
    "growth 0.4": ["mesh.growth=0.4"],
    "size_body 0.5, growth 0.4": ["mesh.size_body=0.5", "mesh.growth=0.4"],
}


def box_rows(boxes: dict[str, list[Swim]], exact: float) -> Iterable[tuple[str, ...]]:
    """Displacements by size of the cube, and beyond it by several powers."""
    for number, half in enumerate(HALVES):
        yield f"{half:g}", *(signed_off(swims[number].displacement, exact) for swims in boxes.values())
    for power in (3, 4, 5):
        beyond = [without_box(HALVES, [found.displacement for found in swims], power) for swims in boxes.values()]
        yield f"∞, by 1/half-width^{power}", *(signed_off(value, exact) for value in beyond)
    yield "exact", *([f"{exact:.5f}"] * len(boxes))


def stroke_rows(found: Swim) -> Iterable[tuple[str, ...]]:
    """Each stroke beside the exact one."""
    exact = exact_cycle(10.0, 4.0)
    yield "measured", *(f"{value:+.5f}" for value in found.strokes)
    yield "exact, no walls", *(f"{value:+.5f}" for value in exact)
    yield "off", *(f"{value:+.2%}" for value in found.strokes / exact - 1.0)


def law_rows(swims: dict[float, Swim], exact: dict[float, float]) -> Iterable[tuple[str, ...]]:
    """Displacement over the square of the stroke."""
    for stroke, found in swims.items():
        values = (f"{value / stroke**2:.5f}" for value in (found.displacement, exact[stroke]))
        yield f"{stroke:g}", *values, f"{found.displacement / exact[stroke] - 1.0:+.2%}"


def swim_row(name: str, found: Swim) -> tuple[str, ...]:
    """One cycle's figures."""
    numbers = f"{found.displacement:+.5f}", f"{found.across:.0e}", f"{found.unknowns}", f"{found.steps}"
    return name, *numbers, f"{found.seconds:.0f}"


def drag_rows() -> Iterable[tuple[str, ...]]:
    """Drag of one sphere and of two, in the cubes and beyond them."""
    for name, places in (("one", [0.0]), (f"two, {PAIR} apart", [-PAIR / 2.0, PAIR / 2.0])):
        exact = float(exact_drag(np.array(places), np.ones(len(places)))[0])
        found = np.array([drag(places, half) for half in HALVES])
        beyond = 1.0 / without_box(HALVES, 1.0 / found, 1)
        boxed = (f"{value:.4f}" for value in found)
        yield name, *boxed, f"{beyond:.4f}", f"{exact:.4f}", f"{beyond / exact - 1.0:+.2%}"


def signed_off(value: float, exact: float) -> str:
    """A value and how far it is off."""
    return f"{value:.5f} ({value / exact - 1.0:+.2%})"


def swimmer_near_wall() -> None:
    """The swimmer that is tilted towards a wall, by both readings of the law's range: its path, and pictures of it.

    The paths are the same until a gap is below .24, so that the second one starts where the first is before that.
    """
    first, _ = run("swimmer_near_wall.toml", ["time.end=1400.0"])
    tables = rigidfluid.load_scene(ROOT / "scenes" / "swimmer_near_wall.toml", ["time.end=676.0"]).to_dict()
    whole = of_body(first, "swimmer")
    there = int(np.flatnonzero(whole["time"] == APART_UNTIL)[0])
    tables["mechanism"][0] |= {"position": [whole["x"][there], whole["y"][there]], "angle": whole["angle"][there]}
    tables["contact"]["range"] = 0.24
    second = rigidfluid.run(rigidfluid.scene_from_dict(tables))
    second.bodies["time"] = second.bodies["time"] + APART_UNTIL
    write_near_wall({"range .03, as printed": first, "range .24, for its size": second})


APART_UNTIL = 144.0
SNAPSHOTS = 5


def write_near_wall(runs: dict[str, History]) -> None:
    """The page, from histories by label."""
    figure = Figure(figsize=(8.0, 9.0), layout="constrained")
    places, angles, gaps = figure.subplots(3, 1)
    for (label, history), colour in zip(runs.items(), ("C0", "C3"), strict=True):
        whole, right = of_body(history, "swimmer"), of_body(history, "swimmer.right")
        places.plot(whole["x"], whole["y"], colour, linewidth=0.8, label=label)
        angles.plot(whole["time"], np.degrees(whole["angle"]), colour, linewidth=0.8, label=label)
        gaps.plot(right["time"], right["gap"], colour, linewidth=0.8, label=label)
    shown = next(iter(runs.values()))
    for moment in 4.0 * np.round(np.linspace(0.0, shown.bodies["time"][-1], SNAPSHOTS) / 4.0):
        for name in ("left", "middle", "right"):
            ball = of_body(shown, f"swimmer.{name}")
            now = int(np.argmin(np.abs(ball["time"] - moment)))
            places.add_patch(Circle((ball["x"][now], ball["y"][now]), 1.0, facecolor="none", edgecolor="k"))
    places.axhline(0.0, color="k")
    places.set(xlabel="x", ylabel="y", aspect="equal")
    angles.set(xlabel="time", ylabel="angle [degrees]")
    gaps.set(xlabel="time", ylabel="gap of the right ball", ylim=(0.0, 1.0))
    for axes in (places, angles, gaps):
        axes.legend(fontsize=8)
    figure.savefig(OUT / "swimmer_near_wall.png", dpi=120)
    head = (
        "reading",
        "until",
        "least gap",
        "lowest centre",
        "steepest [degrees]",
        "at the end",
        "largest contact force",
    )
    head += ("created [%]", "lost [%]")
    text = SWIMMER_NEAR_WALL.format(rows=table(head, [near_wall_row(*named) for named in runs.items()]))
    write_page("swimmer_near_wall", "A swimmer near a wall", "python docs/make_validation.py swimmer_near_wall", text)


def of_body(history: History, name: str) -> dict[str, np.ndarray]:
    """The columns of one body."""
    mine = history.bodies["body"] == name
    return {key: column[mine] for key, column in history.bodies.items()}


def near_wall_row(label: str, history: History) -> tuple[str, ...]:
    """Of one reading."""
    whole = of_body(history, "swimmer")
    angle, force = np.degrees(whole["angle"]), np.hypot(whole["cfx"], whole["cfy"])
    gaps = f"{history.bodies['gap'].min():.4f}", f"{whole['y'].min():.2f}"
    shares = (f"{100.0 * share:.3f}" for share in created_and_lost(history)[:2])
    return (
        label,
        f"{whole['time'][-1]:g}",
        *gaps,
        f"{angle.min():.1f}",
        f"{angle[-1]:.1f}",
        f"{force.max():.2f}",
        *shares,
    )


SWIMMER_NEAR_WALL = """`scenes/swimmer_near_wall.toml`: the swimmer of radius 1 and arms 10 of arXiv:2402.19093 in a
channel of 150 × 40, from (15, 10). The tilt of -π/24 is Feel++'s, the paper states none. Stokes flow, viscosity 1,
density .1; a cycle takes 4. The printed range .03 and ε 5e-8 are those of a swimmer of an eighth of the size; for this
one the range is .24. Circles are the balls of the first reading at whole cycles. The second one starts where the first
is at 144, before any gap is below .24.

The swimmer comes to the wall, is turned towards it on its way, and then away from it again. With the range as printed
the wall alone does so: the film bears it at a gap of four times that range, and there is no contact. It passes the
parallel and then glides along the wall, ever more slowly away from it. With the range .24 each stroke presses the right
ball onto the contact; that turns the swimmer back sooner and farther, and it leaves. No bodies overlap.

The mesh is coarse (cells of .6 on the balls). The path depends on it: with the same mesh made at other times, two
cycles from 144 on lead .15 less far.

{rows}
"""


def swimmer() -> None:
    """The three-sphere swimmer in 2D: steps, meshes, boxes, angles, orders of strokes and the fluid's inertia."""
    runs = {label: two_cycles(overrides) for label, overrides in SWIMS_2D.items()}
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    axes = figure.add_subplot(xlabel="time", ylabel="way along x [r]")
    bodies = runs["as shipped"].bodies
    for name, style in (("left", "C0"), ("middle", "C1"), ("right", "C2")):
        mine = bodies["body"] == f"swimmer.{name}"
        axes.plot(bodies["time"][mine], bodies["x"][mine] - bodies["x"][mine][0], style, linewidth=1.0, label=name)
    mine = bodies["body"] == "swimmer"
    axes.plot(bodies["time"][mine], bodies["x"][mine], "k", label="whole")
    axes.legend()
    figure.savefig(OUT / "swimmer.png", dpi=120)
    head = ("case", *swim_figures(runs["as shipped"]))
    rows = [(label, *swim_figures(history).values()) for label, history in runs.items()]
    text = SWIMMER_2D.format(figures=table(head, rows))
    write_page("swimmer", "A three-sphere swimmer", "python docs/make_validation.py swimmer", text)


SWIMMER_2D = """`scenes/swimmer.toml`: three disks of radius r = 1 on arms of length 10, which shorten by 4 at speed 4
and lengthen again, one after the other: left in, right in, left out, right out. A cycle takes 4. The channel is closed
and 100 long, 40 wide; Stokes flow, viscosity 1, density of the bodies 0.1. `advance` is the displacement along the
swimmer's axis, `across` that across it, both of the centre of mass, `turned` the rotation, all of the second cycle; the
first one begins at rest. `off` is over 0.2910 r, what a quasi-static computation gives for this channel (resistances of
the three disks, Taylor–Hood elements, facets .15: .29104). Feel++ publishes .29 for it.

{figures}

The displacement is that of the reference, whatever the step. The first cycle differs from it, as it begins at rest: for
a time of mass over drag the bodies keep that momentum, and that time is shorter than the longer steps, which do not
resolve it. With a hundredth of the bodies' density the first cycle is as the second. At each corner of a stroke the
velocities change at once, and there the run begins anew with short steps. In Stokes flow that costs 5 more steps a
corner. Without it the second cycle would be off by as little (.29058), but the balance of energy by 2.8 % instead of
0.07 %, as a whole step would be booked at the rate of the stroke before.

Turned by 90° in a square box the swimmer advances as far. Turned by 30° it feels that the box is square.

With the fluid's inertia a corner sets the fluid in motion at once, in a layer that is thinner than any cell at first:
displacement and balance of energy converge with the first order of the step. Feel++ has a figure with inertia, .26, but
in other units and for another fluid, so it is no reference here."""


def dumbbell_in_shear() -> None:
    """A pair of balls that turns in shear against the exact theory of two spheres, in boxes and as without one."""
    exact = {distance: rotation_in_strain(distance)[0] for distance in (2.0 + 1e-6, 2.2, 3.0, 4.0, 6.0)}
    boxes = {3.0: (6.0, 9.0, 12.0), 2.2: (9.0, 12.0)}
    cases = [(distance, half) for distance, halves in boxes.items() for half in halves]
    found = {(distance, half): shear_boxes.rates(half, distance) for distance, half in cases}
    for distance, halves in boxes.items():
        pairs = zip(*(found[distance, half] for half in halves[-2:]), strict=True)
        across, along = (shear_boxes.without_box(halves[-2:], pair) for pair in pairs)
        found[distance, np.inf] = across, along
    turned = shear_boxes.angles(rigidfluid.load_scene(ROOT / "scenes" / "dumbbell_in_shear.toml"))
    across, along = found[3.0, 9.0]
    by_rates, half_turn = np.pi / np.sqrt(across * along), shear_boxes.time_of(-np.pi, turned)
    at_rates = angle(across - along, turned[:, 0] * (across + along))
    write_page(
        "dumbbell_in_shear",
        "A dumb-bell in shear",
        "python docs/make_validation.py dumbbell_in_shear",
        DUMBBELL
        + table(
            ("distance of centres", "A", "B", "axis ratio", "period"),
            (
                (
                    f"{distance:g}",
                    f"{(1 + r) / 2:.5f}",
                    f"{(1 - r) / 2:.5f}",
                    f"{axis_ratio(r):.4f}",
                    f"{period(r):.3f}",
                )
                for distance, r in exact.items()
            ),
        )
        + RATES
        + table(
            ("distance of centres", "walls at", "A", "off", "B", "off", "period", "off"),
            (dumbbell_row(exact[key[0]], *key, *found[key]) for key in sorted(found)),
        )
        + TURN
        + table(
            ("half a turn", "time"),
            (
                ("simulated, walls at 9", f"{half_turn:.3f}"),
                ("by the rates in that box", f"{by_rates:.3f} ({half_turn / by_rates - 1.0:+.2%})"),
                ("by the rates without a box", f"{np.pi / np.sqrt(np.prod(found[3.0, np.inf])):.3f}"),
                ("exact, without a box", f"{period(exact[3.0]) / 2:.3f}"),
            ),
        )
        + f"\n\nThe angle is at most {np.abs(turned[:, 1] - at_rates).max():.3f} rad off what the rates say.",
    )
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot(xlabel="time · shear rate", ylabel="angle from the flow [rad]")
    axes.plot(*turned.T, "o", mfc="none", ms=4, label="simulated, walls at 9 radii")
    times = np.linspace(0.0, turned[-1, 0], 300)
    axes.plot(times, angle(across - along, times * (across + along)), "-", label="by the rates in that box")
    axes.plot(times, angle(exact[3.0], times), "k--", label="exact, without a box")
    axes.legend()
    figure.savefig(OUT / "dumbbell_in_shear.png", dpi=120)


DUMBBELL = """Two equal balls of radius 1 on a rod that the fluid does not feel turn in the Stokes flow u = (y, 0, 0) as

    dφ/dt = -(A sin²φ + B cos²φ),   A + B = 1,   period 2π/√(A B),

φ their angle from the flow, like an ellipsoid of revolution of axis ratio √(A/B). A and B are exact here: Lamb's
solution about both balls, by least squares on their surfaces to 9 digits and more (`tests/support/two_spheres.py`). The
literature has 1.982 (Nir & Acrivos 1973, doi:10.1017/S0022112073001527) and 15.62 (Wakiya 1971) where they touch.

"""

RATES = """

## Rates at rest

From a moment of the pair along the flow, and one across it, free of force and torque, in cubes whose upper and lower
walls slide; the flow is given at both ends, and the sides let it slip. A + B = 1 by the cube's symmetry. The last row
of each distance is the value without a box, from the two larger ones and an effect that goes with the inverse cube of
the walls' distance.

"""

TURN = """

## Half a turn

`scenes/dumbbell_in_shear.toml`, balls 3 radii apart, a step of 0.15; the mesh is made anew as they turn.

"""


def dumbbell_row(exact: float, distance: float, half: float, across: float, along: float) -> tuple[str, ...]:
    """One of `RATES`' table."""
    time = 2.0 * np.pi / np.sqrt(across * along)
    values = ((across, (1 + exact) / 2), (along, (1 - exact) / 2), (time, period(exact)))
    row = [f"{distance:g}", f"{half:g}" if np.isfinite(half) else "none"]
    for value, reference in values:
        row += [f"{value:.4g}", f"{value / reference - 1.0:+.2%}"]
    return tuple(row)


CASES = {
    "insertion": insertion,
    "adaptive_step": adaptive_step,
    "hundred_disks": hundred_disks,
    "falling_disk": falling_disk,
    "dfg_cylinder": dfg_cylinder,
    "dfg_unsteady": dfg_unsteady,
    "settling_cylinder": settling_cylinder,
    "stenosis": stenosis,
    "window": window,
    "swimmer": swimmer,
    "vortex_induced": vortex_induced,
    "distance_field": partial(kernel_study, "distance_field", "Distance field of a circle"),
    "detectors": partial(kernel_study, "detectors", "Gaps of detectors among ellipses"),
    "lammps": lammps,
    "contact_stepping": contact_stepping,
    "contacts_in_fluid": contacts_in_fluid,
    "stokes_contacts": stokes_contacts,
    "swimmer_near_wall": swimmer_near_wall,
    "stability": stability,
    "backends_study": backends_study,
    "walls": walls,
    "dumbbell_in_shear": dumbbell_in_shear,
    "swimmer_3d": swimmer_3d,
}


if __name__ == "__main__":
    OUT.mkdir(exist_ok=True)
    for case in sys.argv[1:] or CASES:
        CASES[case]()
