"""Case 6 of arXiv:2402.19093, a hundred disks that settle, to its end; what it costs, and what it is worth."""

from __future__ import annotations

import csv
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from page_tools import Page, Run, Work, table

from pages._studies import study_plot, study_table
from rigidfluid.post.movies.make_movie import Look, movie

RUNS = {
    "shipped": ("as shipped", []),
    "coarse": ("twice the cells and steps", ["mesh.size_body=0.02", "mesh.size=0.1", "time.step=0.004"]),
}
"""By folder: the heading, and what differs from the scene as shipped."""
MOMENTS = (0.0, 1.0, 2.0, 3.0, 5.5)
EVERY = 25
"""Steps over which the cost of one is averaged."""


@dataclass(frozen=True)
class Disks:
    """All disks over time: (s,) [s], and (s, n) each [cm, cm/s]."""

    time: np.ndarray
    x: np.ndarray
    y: np.ndarray
    speed: np.ndarray

    @classmethod
    def of(cls, run: Run) -> Disks:
        """From the table of bodies."""
        bodies, count = run.history.bodies, len(run.scene.body)
        time, x, y, vx, vy = (bodies[name].reshape(-1, count) for name in ("time", "x", "y", "vx", "vy"))
        return cls(time[:, 0], x, y, np.hypot(vx, vy))


def page(work: Work) -> Page:
    """The disks at five times, what steps cost, both resolutions, and the study of the first .6 s."""
    runs = {heading: work.run(label, "hundred_disks.toml", sets) for label, (heading, sets) in RUNS.items()}
    disks = {heading: Disks.of(run) for heading, run in runs.items()}
    columns = [figures(runs[heading], disks[heading]) for heading in runs]
    shipped, first = runs["as shipped"], disks["as shipped"]
    study = work.study("hundred_disks")
    stages = shipped.summary["wall_time_per_stage"]
    text = TEXT.format(
        figures=table(("figure", *runs), [(name, *(column[name] for column in columns)) for name in columns[0]]),
        stages=", ".join(f"{stage} {100 * seconds / sum(stages.values()):.0f} %" for stage, seconds in stages.items()),
        study=study_table(study),
    )
    seen = movie(shipped.folder, work.folder / "movie.gif", Look(show="vorticity", longer=300, every=2))
    figures_shown = {"": moments(shipped, first), ".gif": seen, "_cost": cost(shipped), "_heights": heights(disks)}
    return Page("A hundred disks settle", text, figures_shown | {"_study": study_plot(study)})


TEXT = """Case 6 of arXiv:2402.19093 with the paper's law, box and step, `scenes/hundred_disks.toml`. [The run as a
movie](hundred_disks.gif), by `rigidfluid movie --show vorticity --size 300 --every 2`.

{figures}

Created and lost are the extremes of the energy balance's residual over what was put in; unaccounted is that at the end.

## What a step costs

![What a step costs](hundred_disks_cost.png)

Shares of the run as shipped: {stages}.

## Two resolutions

![Mean height and its spread](hundred_disks_heights.png)

A hundred disks that meet are chaotic: what two meshes share is the mean, not the place of a disk.

## Error against run time

![Error against run time](hundred_disks_study.png)

`studies/hundred_disks.toml`: gravity's work until .6 s, which is how far the disks have sunk, one knob at a time.

{study}"""


def figures(run: Run, disks: Disks) -> dict[str, str]:
    """The rows of the table for one run."""
    summary, energy = run.summary, run.summary["energy"]
    scene, contacts = run.scene, run.history.contacts
    held = bool(np.all((disks.x > 0.0) & (disks.x < scene.domain.upper[0]) & (disks.y > 0.0)))
    return {
        "unknowns, cells at the end": f"{summary['unknowns']:,}, {summary['cells']:,}",
        "end [s]": f"{disks.time[-1]:.3g}",
        "steps, rejected": f"{summary['steps']:,}, {summary['rejected_steps']}",
        "new meshes, failed": f"{summary['remeshes']}, {summary['failed_remeshes']}",
        "CPU time of one thread [min]": f"{run.cpu_seconds / 60.0:.0f}",
        "contacts in range, mean over the steps": f"{len(contacts['time']) / summary['steps']:.0f}",
        "smallest gap [cm]": f"{summary['smallest_gap']:.4f}",
        "all disks in the box at all times": "yes" if held else "no",
        "mean height at the start, at the end [cm]": f"{disks.y[0].mean():.4f}, {disks.y[-1].mean():.4f}",
        "highest speed, of the run [cm/s]": f"{disks.speed.max():.2f}",
        "highest speed, at the end [cm/s]": f"{disks.speed[-1].max():.1e}",
        "all slower than .01 cm/s from [s]": settled(disks),
        "energy put in [erg/cm]": f"{energy['put_in']:.2f}",
        "created, lost, unaccounted [%]": ", ".join(
            f"{100.0 * energy[name]:.3f}" for name in ("created", "lost", "unaccounted")
        ),
        "lost by re-meshing [erg/cm]": f"{energy['transfer_loss']:.4f}",
    }


def settled(disks: Disks, slow: float = 0.01) -> str:
    """From when on all disks are slow."""
    moving = np.flatnonzero(disks.speed.max(axis=1) >= slow)
    last = moving[-1] + 1 if len(moving) else 0
    return f"{disks.time[last]:.2f}" if last < len(disks.time) else "never"


def moments(run: Run, disks: Disks) -> Figure:
    """The disks at some times, by their row at the start."""
    figure = Figure(figsize=(12.0, 4.8), dpi=80, layout="constrained")
    rows = np.argsort(np.argsort(-disks.y[0], kind="stable")) // 10
    for moment, axes in zip(MOMENTS, figure.subplots(1, len(MOMENTS)), strict=True):
        step = int(np.argmin(np.abs(disks.time - moment)))
        for x, y, row, body in zip(disks.x[step], disks.y[step], rows, run.scene.body, strict=True):
            axes.add_patch(Circle((x, y), body.radius, facecolor=f"C{row}", edgecolor="black", linewidth=0.3))
        axes.set(xlim=(0, 1), ylim=(0, 2), aspect="equal", title=f"t = {disks.time[step]:.1f} s", xticks=[], yticks=[])
    return figure


def cost(run: Run) -> Figure:
    """CPU seconds of a step, unknowns, new meshes and contacts, over time."""
    with (run.folder / "progress.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    time, seconds = (np.array([float(row[name]) for row in rows]) for name in ("time", "cpu_seconds"))
    steps, contacts = run.history.steps, run.history.contacts["time"]
    near = np.searchsorted(contacts, steps["time"], side="right") - np.searchsorted(contacts, steps["time"])
    figure = Figure(figsize=(8.0, 7.0), dpi=80, layout="constrained")
    panels = figure.subplots(4, 1, sharex=True)
    panels[0].plot(time[EVERY::EVERY], np.diff(seconds[::EVERY]) / EVERY)
    for axes, values in zip(panels[1:], (steps["unknowns"], steps["remeshes"], near), strict=True):
        axes.plot(steps["time"], values)
    labels = ("CPU seconds\nof a step", "unknowns", "new meshes\nsince the start", "contacts\nin range")
    for axes, label in zip(panels, labels, strict=True):
        axes.set(ylabel=label, ylim=(0.0, None))
        axes.grid(alpha=0.3)
    panels[-1].set_xlabel("time [s]")
    return figure


def heights(disks: dict[str, Disks]) -> Figure:
    """Mean height of the disks and its standard deviation over time, at each resolution."""
    figure = Figure(figsize=(8.0, 3.2), dpi=80, layout="constrained")
    axes = figure.add_subplot(xlabel="time [s]", ylabel="height [cm]")
    for heading, one in disks.items():
        mean, spread = one.y.mean(axis=1), one.y.std(axis=1)
        (line,) = axes.plot(one.time, mean, label=heading)
        axes.fill_between(one.time, mean - spread, mean + spread, color=line.get_color(), alpha=0.15, linewidth=0)
    axes.legend()
    return figure
