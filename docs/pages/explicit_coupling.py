"""Flow and bodies as one system, and solved in turn: light bodies, contacts and re-meshing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from page_tools.kept_rows import Row
from page_tools.settings import Settings

from pages._coupling_runs import EXPLICIT, FACTOR, FINE, ITERATED, MOST, ONE, WAYS, Case, rows_of
from pages._staggered import FIRST_RELAXATION, RADIUS, TOLERANCE, Disk, disk_scene

DENSITIES = (10.0, 5.0, 3.0, 2.0, 1.5, 1.2, 1.05, 0.5, 0.1)
STEPS = (2e-3, 1e-3, 0.5e-3)
STEP = 1e-3
"""Step of which errors are told [s]."""
SIX = [Disk(d, 0.15 + 0.23 * i, 0.4 + 0.05 * (-1) ** i) for i, d in enumerate((0.1, 3.0, 0.1, 0.5, 0.1, 1.2))]
SHOWN = 0.5
"""Density of the disk whose velocity is shown."""
FLOOR, LID, MANY = "density 10, onto the floor", "density .1, onto the lid", "six disks"
CASES = {
    **{f"{density:g}": Case([Disk(density)], 0.05, STEPS, shown=density == SHOWN) for density in DENSITIES},
    FLOOR: Case([Disk(10.0)], 0.3, STEPS[1:], shown=True),
    LID: Case([Disk(0.1)], 0.3, STEPS[1:], shown=True),
    MANY: Case(SIX, 0.04, (STEP,), width=1.45),
}
COLOURS = dict(zip(WAYS, ("C0", "C3", "C2"), strict=True))
LINES = dict(zip(STEPS, ("-", "--", ":"), strict=True))


def page(work: Work) -> Page:
    """Three ways, by density and step; contacts with new meshes; six disks."""
    rows = work.rows(lambda: (row for name, case in CASES.items() for row in rows_of(name, case)))
    work.watch("density .5", Settings(tables=disk_scene([Disk(0.5)], free=True, step=STEP, end=0.05).to_dict()))
    single = [row for row in rows if row["case"] in _names()]
    stable = [density for density in DENSITIES if all(row["ended"] for row in _of(rows, density, EXPLICIT))]
    text = ABOUT.format(
        limit=limit_table(rows),
        errors=errors_table(rows),
        cases=cases_table(rows),
        stable=_told(stable),
        unstable=_told([density for density in DENSITIES if density not in stable]),
        added=_told([row["added"] for row in _of(rows, SHOWN, EXPLICIT)]),
        sooner=_told([1e3 * row["until"] for row in _of(rows, SHOWN, EXPLICIT)]),
        shown=f"{SHOWN:g}",
        most=f"{max(row['fastest'] for row in rows if row['way'] == ONE):.4f}",
        one=_range([100 * row["speed_off"] for row in single if row["way"] == ONE and row["step"] == STEP]),
        heavy=_heavy(rows),
        solves=_range([row["solves"] for row in single if row["way"] == ITERATED]),
        six=f"{_one(rows, MANY, ITERATED)['solves']:.1f}",
        six_cost=f"{_one(rows, MANY, ITERATED)['ms'] / _one(rows, MANY, ONE)['ms']:.0f}",
        lid_cost=f"{_one(rows, LID, ITERATED)['ms'] / _one(rows, LID, ONE)['ms']:.1f}",
        coarse=_balances(rows, STEPS[1]),
        finer=_balances(rows, STEPS[2]),
        ended=sum(row["ended"] for row in rows if row["way"] == ITERATED),
        iterated=sum(row["way"] == ITERATED for row in rows),
        tolerance=f"{TOLERANCE:g}",
        relaxation=f"{FIRST_RELAXATION:g}",
        allowed=MOST[ITERATED],
        factor=f"{FACTOR:g}",
    )
    return Page("Light bodies beside explicit coupling", text, {"": plots(rows)})


def limit_table(rows: Sequence[Row]) -> str:
    """By density: greatest speeds of explicit coupling, or when it ends, and flow solves of iterated coupling."""
    columns = [(way, step) for way in (EXPLICIT, ITERATED) for step in STEPS]
    head = ("density ratio", *(f"{way}, {1e3 * step:g} ms" for way, step in columns))
    lines = []
    for density in DENSITIES:
        found = {(row["way"], row["step"]): row for row in rows if row["case"] == f"{density:g}"}
        cells = (_cell(found[column]) for column in columns)
        lines.append((f"{density:g}", *cells))
    return table(head, lines)


def _cell(row: Row) -> str:
    if not row["ended"]:
        return f"ends at {1e3 * row['until']:.3g} ms"
    return f"{row['fastest']:.3f}" if row["way"] == EXPLICIT else f"{row['solves']:.1f}"


def errors_table(rows: Sequence[Row]) -> str:
    """By density, with one step: errors of the velocity, energy created, CPU time of a step, of all three ways."""
    figures = {"velocity off [%]": "speed_off", "energy created [%]": "created", "CPU ms a step": "ms"}
    head = ("density ratio", *(f"{name}: {way}" for name in figures for way in WAYS))
    lines = []
    for density in DENSITIES:
        found = {row["way"]: row for row in rows if row["case"] == f"{density:g}" and row["step"] == STEP}
        cells = (_figure(found[way], key) for key in figures.values() for way in WAYS)
        lines.append((f"{density:g}", *cells))
    return table(head, lines)


def _figure(row: Row, key: str) -> str:
    if key == "ms":
        return f"{row[key]:.1f}"
    return f"{100.0 * row[key]:.3f}" if key in row else "-"


def cases_table(rows: Sequence[Row]) -> str:
    """Of all runs with contacts, new meshes or several disks: how they end, errors, energy, flow solves, CPU time."""
    head = ("case", "step [ms]", "way", "ends", "new meshes", "smallest gap", "height off", "energy created [%]")
    lines = []
    for row in rows:
        if row["case"] not in _names():
            ends = "at its end" if row["ended"] else f"at {1e3 * row['until']:.3g} ms"
            off = f"{row['height_off']:.4f}" if "height_off" in row and row["way"] != FINE else "-"
            told = (f"{row['remeshes']}", f"{row['gap']:.3f}", off, _figure(row, "created"))
            cost = f"{row['solves']:.1f}", f"{row['ms']:.1f}"
            way = "one system" if row["way"] == FINE else row["way"]
            lines.append((row["case"], f"{1e3 * row['step']:g}", way, ends, *told, *cost))
    return table((*head, "flow solves a step", "CPU ms a step"), lines)


def _names() -> list[str]:
    return [f"{density:g}" for density in DENSITIES]


def _of(rows: Sequence[Row], density: float, way: str) -> list[Row]:
    return [row for row in rows if row["case"] == f"{density:g}" and row["way"] == way]


def _one(rows: Sequence[Row], case: str, way: str, step: float = STEP) -> Row:
    return next(row for row in rows if (row["case"], row["way"], row["step"]) == (case, way, step))


def _balances(rows: Sequence[Row], step: float) -> str:
    """Energy that each way created of the heavy disk that bounces; below zero it was lost."""
    return ", ".join(f"{100.0 * _one(rows, FLOOR, way, step)['created']:+.2g} % ({way})" for way in WAYS)


def _told(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.3g}" for value in values) or "none"


def _range(values: Sequence[float]) -> str:
    return f"{min(values):.2g} to {max(values):.2g}"


def _heavy(rows: Sequence[Row]) -> str:
    """What explicit coupling and one system are off at the highest density, and what a step of each takes."""
    explicit, one = (_one(rows, f"{DENSITIES[0]:g}", way) for way in (EXPLICIT, ONE))
    off = f"its velocity is {100 * explicit['speed_off']:.2g} % off, that of one system {100 * one['speed_off']:.2g} %"
    return f"{off}; a step takes {explicit['ms']:.1f} and {one['ms']:.1f} ms of CPU time"


def plots(rows: Sequence[Row]) -> Figure:
    """Velocities of a light disk; when explicit coupling ends; flow solves; paths with contacts and new meshes."""
    figure = Figure(figsize=(10.0, 8.0), dpi=100, layout="constrained")
    velocities, ends, solves, paths = figure.subplots(2, 2).ravel()
    draw_velocities(velocities, rows)
    draw_ends(ends, rows)
    draw_solves(solves, rows)
    draw_paths(paths, rows)
    return figure


def draw_velocities(axes: Axes, rows: Sequence[Row]) -> None:
    """Of the disk that is shown, by all steps."""
    for row in rows:
        if row["case"] == f"{SHOWN:g}" and row["way"] in (ONE, EXPLICIT):
            label = f"{row['way']}, {1e3 * row['step']:g} ms"
            style = {"color": COLOURS[row["way"]], "linestyle": LINES[row["step"]], "label": label}
            axes.plot(1e3 * np.array(row["times"]), row["velocities"], **style)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set(xlabel="time [ms]", ylabel="velocity [cm/s]", title=f"a disk of density {SHOWN:g} rises")
    axes.legend(fontsize=8)


def draw_ends(axes: Axes, rows: Sequence[Row]) -> None:
    """When each run is ten times too fast, over the density; runs to their end above."""
    for step in STEPS:
        found = [_one(rows, name, EXPLICIT, step) for name in _names()]
        label = f"explicit, {1e3 * step:g} ms"
        style = {"color": COLOURS[EXPLICIT], "linestyle": LINES[step], "label": label}
        lost = [(density, row["until"]) for density, row in zip(DENSITIES, found, strict=True) if not row["ended"]]
        axes.plot([density for density, _ in lost], [1e3 * until for _, until in lost], marker="x", **style)
    kept = [density for density in DENSITIES if all(row["ended"] for row in _of(rows, density, EXPLICIT))]
    end = 1e3 * CASES[_names()[0]].end
    axes.plot(kept, [end] * len(kept), "o", color=COLOURS[EXPLICIT], mfc="none", label="explicit, to its end")
    axes.plot(DENSITIES, [1.15 * end] * len(DENSITIES), "o", color=COLOURS[ONE], label="one system, to its end")
    axes.set(xscale="log", yscale="log", xlabel="density over the fluid's", ylabel="ten times too fast at [ms]")
    axes.set_yticks((2, 5, 10, 20, 50), ("2", "5", "10", "20", "50"))
    axes.minorticks_off()
    axes.set_title("how long runs hold")
    axes.legend(fontsize=8)


def draw_solves(axes: Axes, rows: Sequence[Row]) -> None:
    """Flow solves a step, over the density."""
    for step in STEPS:
        found = [_one(rows, name, ITERATED, step)["solves"] for name in _names()]
        label = f"iterated, {1e3 * step:g} ms"
        axes.plot(DENSITIES, found, color=COLOURS[ITERATED], linestyle=LINES[step], marker=".", label=label)
    densities = [disk.density for disk in SIX]
    many = _one(rows, MANY, ITERATED)["solves"]
    axes.hlines(many, min(densities), max(densities), color=COLOURS[ITERATED], linewidth=3, label="iterated, six disks")
    axes.axhline(1.0, color=COLOURS[ONE], label="one system")
    axes.set(xscale="log", ylim=(0.0, None), xlabel="density over the fluid's", ylabel="flow solves a step")
    axes.set_title("what stability costs")
    axes.legend(fontsize=8, loc="center left")


def draw_paths(axes: Axes, rows: Sequence[Row]) -> None:
    """Heights with contacts, and when meshes were made."""
    for case in (FLOOR, LID):
        for way in WAYS:
            row = _one(rows, case, way)
            label = f"{way}, 1 ms" if case == FLOOR else None
            axes.plot(row["times"], row["heights"], color=COLOURS[way], label=label, zorder=WAYS.index(way) == 0)
            if not row["ended"]:
                axes.plot(row["times"][-1], row["heights"][-1], "x", color=COLOURS[way], markersize=10)
        fine = _one(rows, case, FINE, 0.25e-3)
        axes.plot(fine["times"], fine["heights"], "k:", linewidth=1, label="fine" if case == FLOOR else None)
        made = _one(rows, case, ONE)["made"]
        axes.plot(
            made, np.interp(made, fine["times"], fine["heights"]), "k|", label="new mesh" * (case == FLOOR) or None
        )
    axes.axhspan(0.0, RADIUS, color="0.9")
    axes.axhspan(0.8 - RADIUS, 0.8, color="0.9")
    axes.set(ylim=(0.0, 0.8), xlabel="time [s]", ylabel="height of the centre [cm]")
    axes.set_title("densities 10 (falls) and .1 (rises)")
    axes.legend(fontsize=8, loc="center right")


ABOUT = """A disk is let go in a closed box full of fluid. Three ways to couple flow and disk have the same flow solver
(P2–P1 elements, BDF2), the same meshes and the same contacts:

* **one system**: rigidfluid as it is. Fluid and bodies are solved together, once in a step.
* **explicit**: the disk moves by the flow's force of the step before, and the flow is told its velocity.
* **iterated**: the same, but a step is taken again until force and velocity agree to {tolerance} of the greatest
  speed, with Aitken's relaxation (Küttler and Wall, Comput. Mech. 43 (2008) 61), which begins at {relaxation} at most.
  {allowed} flow solves are allowed.

The last two are made with the [public interface](../control.md), and BDF2 moves their disks too. Radius .1 cm, box .8
cm, viscosity .05 g/(cm s), gravity 200 cm/s², edges of .04 cm on a disk and .1 cm elsewhere. All is held against one
system with steps of .25 ms. A run ends where a speed is {factor} times the greatest of that.

## Light bodies

Each column is for a coupling and a step. It lists for `explicit` the greatest speed in 50 ms over the right one, or the
time at which the run ends; for `iterated` the solutions of the flow per step. One system has at most {most} times the
right speed.

{limit}

Explicit coupling holds at density ratios of {stable} with all three steps, and does not at {unstable}. The limit
follows from the added mass: the force of a flow that is told an acceleration is -m_a times that, so each step
multiplies the error of the acceleration by -m_a/m. In the first step the disk feels an added mass of {added} times the
fluid that it displaces (steps of 2, 1 and .5 ms), so the disk should have at least about that density. **Shorter steps
do not help.** The factor of a step stays, and there are more steps: at a ratio of {shown} runs end at {sooner} ms.
This is what Causin, Gerbeau and Nobile (Comput. Methods Appl. Mech. Engrg. 194 (2005) 4506) derive, and Förster, Wall
and Ramm (ibid. 196 (2007) 1278) show for flexible structures.

Of the runs with iterated coupling on this page, {ended} of {iterated} come to their end. For one disk it takes
{solves} flow solves in a step. A single disk that goes straight up or down is the best case for Aitken's relaxation,
which is a secant method then.

## What it costs where all hold

Steps of 1 ms. Velocity off: root of the mean square over the time, over the greatest speed. Energy created: what
disks, fluid and contacts have and the fluid has lost, less the work of gravity, over that.

{errors}

**Heavy bodies do not need one system.** At a density ratio of 10, explicit coupling: {heavy}. Its error is of first
order, since the force is a step old. In rigidfluid one system has three unknowns more for each disk, which a step
hardly feels; explicit coupling is the simpler choice where the flow solver is a program that cannot be changed. One
system is off by {one} % over all densities.

## Contacts, new meshes, many disks

A heavy disk falls onto the floor, bounces and comes to rest; a light one rises to the lid. Both have new meshes on
their way. Then six disks of densities .1, 3, .1, .5, .1 and 1.2 are let go beside each other, without contacts. Gaps
and heights are in radii; height off is the root of the mean square over time and disks. Contacts of the last two ways
take and give no energy in themselves. The first row of each case is what the others are held against.

{cases}

* In an impact the disk's velocity changes within some steps. One system follows the contact by substeps with the
  fluid's share in it, and [shortens steps](../numerics.md#contacts) that would lose much. The other ways tell the flow
  a velocity at the end of each step. Of what gravity works, the heavy disk's run creates {coarse} with steps of 1 ms,
  and {finer} with .5 ms.
* For the light disk at the lid iterated coupling takes {lid_cost} times the CPU time of one system with the same step.
* Of six disks each feels the others. One relaxation for all fits none: {six} flow solves in a step, and {six_cost}
  times the CPU time of one system. (A quasi-Newton method may need fewer; it is not tried here.)

Part of that CPU time is that of this library: a step that is taken again sets up the matrix of the mesh motion anew,
so flow solves are the fairer measure."""
