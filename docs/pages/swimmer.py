"""The three-sphere swimmer in 2D: steps, meshes, boxes, angles, orders of strokes and the fluid's inertia."""

from __future__ import annotations

import re

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from swimmer_2d import ADVANCE, SWIMS, scene, swim_figures


def page(work: Work) -> Page:
    """Displacements in the second cycle, and the path."""
    runs = {label: work.run(folder(label), scene(overrides)) for label, overrides in SWIMS.items()}
    rows = [(label, *swim_figures(run.history).values()) for label, run in runs.items()]
    text = ABOUT.format(figures=table(("case", *swim_figures(runs["as shipped"].history)), rows), **judged(runs))
    return Page("A three-sphere swimmer", text, {"": ways(runs["as shipped"])})


def folder(label: str) -> str:
    """A name for a folder."""
    return re.sub(r"[^\w.]+", "_", label).strip("_")


def ways(run: Run) -> Figure:
    """Of the three disks and the whole, along the channel."""
    figure = Figure(figsize=(8.0, 4.2), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="time", ylabel="way along x [r]")
    bodies = run.history.bodies
    for name, style in (("left", "C0"), ("middle", "C1"), ("right", "C2")):
        mine = bodies["body"] == f"swimmer.{name}"
        axes.plot(bodies["time"][mine], bodies["x"][mine] - bodies["x"][mine][0], style, linewidth=1.0, label=name)
    mine = bodies["body"] == "swimmer"
    axes.plot(bodies["time"][mine], bodies["x"][mine], "k", label="whole")
    axes.legend()
    return figure


def judged(runs: dict[str, Run]) -> dict[str, float]:
    """What `ABOUT` says of the runs."""
    advance = {label: along(run) for label, run in runs.items()}
    channel = [label for label in runs if "box" not in label and "Navier" not in label]
    newton = [label for label in runs if "Navier" in label]
    unaccounted = [abs(runs[label].summary["energy"]["relative_residual"]) for label in newton]
    halvings = np.abs(np.diff([advance[label][1] for label in newton]))
    return {
        "off": max(abs(abs(advance[label][1]) / ADVANCE - 1.0) for label in channel),
        "start": abs(advance["as shipped"][0] / advance["as shipped"][1] - 1.0),
        "light_start": abs(advance["bodies of density 0.001"][0] / advance["bodies of density 0.001"][1] - 1.0),
        "quarter": abs(advance["box 100 x 100, turned by 90°"][1] / advance["box 100 x 100"][1] - 1.0),
        "tilted": abs(advance["box 200 x 200, turned by 30°"][1] / advance["box 200 x 200"][1] - 1.0),
        "advance_order": float(np.log2(halvings[-2] / halvings[-1])),
        "energy_order": float(np.log2(unaccounted[-2] / unaccounted[-1])),
    }


def along(run: Run) -> np.ndarray:
    """Displacements of the cycles along the swimmer's axis [r]."""
    angle = float(run.summary["scene"]["mechanism"][0].get("angle", 0.0))
    return np.array(run.summary["cycles"]["swimmer"]["displacement"]) @ [np.cos(angle), np.sin(angle)]


ABOUT = """`scenes/swimmer.toml`: three disks of radius r = 1 on arms of length 10, which shorten by 4 at speed 4
and lengthen again, one after the other: left in, right in, left out, right out. A cycle takes 4. The channel is closed
and 100 long, 40 wide; Stokes flow, viscosity 1, density of the bodies 0.1. `advance` is the displacement along the
swimmer's axis, `across` that across it, both of the centre of mass, `turned` the rotation, all of the second cycle; the
first one begins at rest. `off` is over 0.2910 r, what a quasi-static computation gives for this channel (resistances of
the three disks, Taylor–Hood elements, facets .15: .29104). Feel++ publishes .29 for it.

{figures}

In the channel, in Stokes flow, the displacement is at most {off:.2%} off the reference, whatever step, mesh and order
of the strokes. As shipped the first cycle differs from the second by {start:.2%}, as it begins at rest: for a time of
mass over drag the bodies keep that momentum, and that time is shorter than the longer steps, which do not resolve it.
With a hundredth of the bodies' density it differs by {light_start:.2%}. At each corner of a stroke the velocities
change at once, and there the run begins anew with short steps: a whole step would be booked at the rate of the stroke
before.

Turned by 90° in a square box the displacement changes by {quarter:.2%}; turned by 30° by {tilted:.2%}, as it feels that
the box is square.

With the fluid's inertia a corner sets the fluid in motion at once, in a layer that is thinner than any cell at first.
By the last halvings of the step the displacement converges with order {advance_order:.1f}, the balance of energy with
order {energy_order:.1f}. Feel++ has a figure with inertia, .26, but in other units and for another fluid, so it is no
reference here."""
