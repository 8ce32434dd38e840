"""Twenty spheres and ellipsoids that settle in a box in three dimensions: whether meshes last, and what they cost."""

from __future__ import annotations

import csv

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

SCENE = "many_bodies_3d.toml"
EVERY = 5
"""Steps over which the cost of one is averaged."""
LEAST_QUALITY = 0.1
"""A cell is not to be worse."""
MESHING = ("mesh", "move mesh", "transfer")
SOLVING = ("advance", "response")


def page(work: Work) -> Page:
    """The bodies' heights, gaps, cells, their quality, and seconds."""
    run = work.run("shipped", SCENE)
    summary, steps = run.summary, run.history.steps
    seconds = summary["wall_time_per_stage"]
    meshing, solving = (sum(seconds.get(stage, 0.0) for stage in stages) for stages in (MESHING, SOLVING))
    overlaps = not summary["smallest_gap"] > 0.0
    text = TEXT.format(
        bodies=len(run.scene.body),
        end=summary["time"],
        figures=table(("figure", "value", "wanted"), figures(run)),
        gap=summary["smallest_gap"],
        overlap="Bodies overlap" if overlaps else "No bodies overlap",
        failed=summary["failed_remeshes"] or "none",
        grew=steps["cells"].max() / steps["cells"][0],
        meshing=meshing,
        solving=solving,
        cheaper="less" if meshing < solving else "more",
        stages=table(
            ("stage", "seconds", "of all"),
            [
                (stage, f"{took:.0f}", f"{100 * took / sum(seconds.values()):.0f} %")
                for stage, took in sorted(seconds.items(), key=lambda item: -item[1])
            ],
        ),
    )
    return Page("Twenty bodies settle in three dimensions", text, {"": curves(run)})


TEXT = """`scenes/many_bodies_3d.toml`: {bodies} spheres and ellipsoids of all sizes and tilts settle in a box and meet.
The scene is for the meshes: cells are about as long as the smaller bodies' radii, too coarse for the flow between
bodies, and no published paths exist to compare with.

{figures}

{overlap}: the least gap is {gap:.3g} cm. Of the meshes that were asked for {failed} could not be made. Gaps are left
to the cells that bodies have anyway (`mesh.refinements = 0`), so that cells are at most {grew:.2f} times as many as at
the start. To resolve a gap costs more in 3D than in 2D: the cells in it are about twice as many when it has halved, and
thirty gaps cannot be resolved so.

## Seconds

Meshes took {meshing:.0f} s and linear systems {solving:.0f} s: meshes take {cheaper} than solving. These are wall
times on a machine that other programs shared; CPU time is in the table above.

{stages}"""


def figures(run: Run) -> list[tuple[str, str, str]]:
    """Name, value and what is wanted of each figure."""
    summary, energy, quality = run.summary, run.summary["energy"], run.history.steps["quality"]
    near = run.history.contacts["time"]
    most = np.unique(near, return_counts=True)[1].max(initial=0)
    return [
        ("end [s]", f"{summary['time']:.3g}", ""),
        ("steps, rejected", f"{summary['steps']}, {summary['rejected_steps']}", ""),
        ("smallest gap [cm]", f"{summary['smallest_gap']:.4f}", "> 0"),
        ("contacts in range, mean of the steps, most", f"{len(near) / summary['steps']:.1f}, {most}", ""),
        ("new meshes, failed", f"{summary['remeshes']}, {summary['failed_remeshes']}", "0 failed"),
        ("quality of the worst cell at any step", f"{summary['worst_quality']:.3f}", f"≥ {LEAST_QUALITY}"),
        ("steps with a cell below that", f"{np.sum(quality < LEAST_QUALITY)}", "0"),
        ("cells, least and most", "{:,}, {:,}".format(*np.sort(run.history.steps["cells"])[[0, -1]]), ""),
        ("unknowns at the end", f"{summary['unknowns']:,}", ""),
        ("CPU time of one thread [s]", f"{run.cpu_seconds:.0f}", ""),
        ("energy created, lost [%]", f"{100.0 * energy['created']:.2f}, {100.0 * energy['lost']:.2f}", ""),
    ]


def curves(run: Run) -> Figure:
    """Heights, least gap, worst quality, cells, and CPU seconds of a step, over time."""
    with (run.folder / "progress.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    time, seconds = (np.array([float(row[name]) for row in rows]) for name in ("time", "cpu_seconds"))
    steps, count = run.history.steps, len(run.scene.body)
    when, height, gap = (run.history.bodies[name].reshape(-1, count) for name in ("time", "z", "gap"))
    figure = Figure(figsize=(8.0, 9.0), dpi=80, layout="constrained")
    panels = figure.subplots(5, 1, sharex=True)
    for body, one in zip(run.scene.body, height.T, strict=True):
        panels[0].plot(when[:, 0], one, color="C0" if body.type == "sphere" else "C1", linewidth=0.8)
    panels[1].semilogy(when[:, 0], gap.min(axis=1))
    panels[2].plot(steps["time"], steps["quality"])
    panels[2].axhline(LEAST_QUALITY, color="gray", linestyle=":")
    panels[3].plot(steps["time"], steps["cells"])
    panels[4].plot(time[EVERY::EVERY], np.diff(seconds[::EVERY]) / EVERY)
    labels = ("height [cm],\nspheres blue", "least gap [cm]", "worst quality", "cells", "CPU seconds\nof a step")
    for axes, label in zip(panels, labels, strict=True):
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    for axes in panels[2:]:
        axes.set_ylim(0.0, None)
    panels[-1].set_xlabel("time [s]")
    return figure
