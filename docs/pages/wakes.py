"""Wakes: what steps and cells leave of a fast disk's energy, of two disks' torque, of a light disk's at new meshes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from rigidfluid.core.output.energy_account import per_cent

FAST = {f"fast_{step:g}": step for step in (0.002, 0.001, 0.0005, 0.00025)}
"""By folder: the step of the fast disk [s]."""

PAIR = {f"pair_{step:g}": step for step in (0.001, 0.0005)}
LONGER = ["mesh.size_body=0.015", "time.end=0.21", "output.every=0.21"]
"""Of two disks, until they kiss, on coarse cells."""

LIGHT = {f"light_{size:g}": size for size in (0.015, 0.0075)}
"""By folder: the cells at a light disk [cm]."""
RISING = ["body.0.density=0.5", "body.0.position=[0.95,1.0]", "mesh.remesh_every=0.03", "time.end=0.2"]

REFERENCES = {
    "greatest drag coefficient": (3.22, 3.24),
    "greatest lift coefficient": (0.98, 1.02),
    "Strouhal number": (0.295, 0.305),
    "pressure difference": (2.46, 2.50),
}
"""Bands of Schäfer and Turek (1996) for 2D-2."""


def page(work: Work) -> Page:
    """The three falls and the cylinder."""
    fast = {step: work.run(name, "fast_disk.toml", [f"time.step={step}"]) for name, step in FAST.items()}
    pair = {
        step: work.run(name, "drafting_kissing_tumbling.toml", [*LONGER, f"time.step={step}"])
        for name, step in PAIR.items()
    }
    light = {
        size: work.run(name, "fast_disk.toml", [*RISING, f"mesh.size_body={size}"]) for name, size in LIGHT.items()
    }
    vortices = work.run("vortices", "dfg_2d2.toml")
    text = ABOUT.format(
        fast=table(("step [s]", *ENERGY, "speed, .2 to .275 s [cm/s]"), fast_rows(fast)),
        pair=table(("step [s]", *ENERGY), [(f"{step:g}", *energy(run)) for step, run in pair.items()]),
        light=table(("size_body [cm]", "new meshes", "force", "torque"), light_rows(light)),
        cylinder=table(("figure", "measured", "band"), cylinder_rows(vortices)),
    )
    return Page("Wakes", text, {"": torques(pair, light)})


ENERGY = ("created", "lost", "by stabilisation")

ABOUT = """

## A fast disk

`scenes/fast_disk.toml`, Reynolds number 330: the published fall is 13.3 to 13.6 cm/s (Bergmann, Hovnanian and Iollo
2014, fig. 19).

{fast}

What [stabilisation](../numerics.md#grad-div) takes is a column of its own; it is part of the balance.

## Two disks until they kiss

`scenes/drafting_kissing_tumbling.toml` with `size_body` .015, to .21 s.

{pair}

## A light disk at new meshes

The fast disk's scene with a density of .5: the disk rises, and is re-meshed every .03 s. Jumps over the range in the
run, `remesh_jumps` in `summary.json`. Cells next to bodies are kept as they are
([why](../numerics.md#re-meshing)).

{light}

## Vortices behind a cylinder

`scenes/dfg_2d2.toml`, case 2D-2 of Schäfer and Turek (1996), over the last two periods.

{cylinder}
"""


def energy(run: Run) -> tuple[str, ...]:
    """Shares of what was put in."""
    account = run.summary["energy"]
    return tuple(per_cent(account[name]) for name in ("created", "lost", "grad_div"))


def fast_rows(runs: Mapping[float, Run]) -> Iterable[tuple[str, ...]]:
    """Step, energies and mean speed."""
    for step, run in runs.items():
        bodies = run.history.bodies
        late = bodies["time"] > 0.2
        yield f"{step:g}", *energy(run), f"{-bodies['vy'][late].mean():.3f}"


def light_rows(runs: Mapping[float, Run]) -> Iterable[tuple[str, ...]]:
    """Cells, meshes and jumps."""
    for size, run in runs.items():
        jumps = run.summary["remesh_jumps"]["disk"]
        yield f"{size:g}", str(run.summary["remeshes"]), per_cent(jumps["force"]), per_cent(jumps["torque"])


def cylinder_rows(run: Run) -> Iterable[tuple[str, ...]]:
    """Figures of 2D-2 beside their bands."""
    for (name, (low, high)), value in zip(REFERENCES.items(), vortex_figures(run), strict=True):
        told = "" if low <= value <= high else ", outside"
        yield name, f"{value:.4f}", f"{low:g} to {high:g}{told}"


def vortex_figures(run: Run) -> tuple[float, float, float, float]:
    """Greatest drag and lift coefficient, Strouhal number, pressure difference half a period after the greatest lift.

    Over the last two periods, with a mean speed of 1 m/s and a diameter of .1 m.
    """
    bodies, probes = run.history.bodies, run.history.probes
    time, drag, lift = bodies["time"], 20.0 * bodies["fx"], 20.0 * bodies["fy"]
    rising = np.flatnonzero((lift[:-1] < 0.0) & (lift[1:] >= 0.0) & (time[1:] > time[-1] - 2.0))
    zero = time[rising] - lift[rising] * np.diff(time)[rising] / np.diff(lift)[rising]
    period = float(np.diff(zero).mean())
    last = (time >= zero[-3]) & (time <= zero[-1])
    greatest = float(time[last][lift[last].argmax()])
    difference = probes["pressure"][::2] - probes["pressure"][1::2]
    later = greatest + 0.5 * period if greatest + 0.5 * period <= time[-1] else greatest - 0.5 * period
    found = float(np.interp(later, probes["time"][::2], difference))
    return float(drag[last].max()), float(lift[last].max()), 0.1 / period, found


def torques(pair: Mapping[float, Run], light: Mapping[float, Run]) -> Figure:
    """Of the trailing disk, and of the light one."""
    figure = Figure(figsize=(8.0, 3.6), dpi=120, layout="constrained")
    trailing, rising = figure.subplots(1, 2)
    trailing.set(xlabel="time [s]", ylabel="torque of the trailing disk [dyn cm]")
    rising.set(xlabel="time [s]", ylabel="torque of the light disk [dyn cm]")
    for step, run in pair.items():
        bodies = run.history.bodies
        mine = (bodies["body"] == "trailing") & (bodies["time"] > 0.02)
        trailing.plot(bodies["time"][mine], bodies["t"][mine], label=f"step {step:g} s", linewidth=1.0)
    for size, run in light.items():
        bodies, steps = run.history.bodies, run.history.steps
        late = bodies["time"] > 0.02
        rising.plot(bodies["time"][late], bodies["t"][late], label=f"size_body {size:g} cm", linewidth=1.0)
        for when in steps["time"][1:][np.diff(steps["remeshes"]) > 0]:
            rising.axvline(when, color="grey", linewidth=0.4, linestyle=":")
    trailing.legend(fontsize=8)
    rising.legend(fontsize=8)
    return figure
