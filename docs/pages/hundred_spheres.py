"""A hundred spheres that settle in a box, with a fluid and without: overlaps, meshes, memory and seconds."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

SCENE = "hundred_spheres.toml"
WET, DRY = "in the fluid", "without it"
END = 0.1
"""Of the run in the fluid [s]."""
GIBIBYTE = 2.0**30


def page(work: Work) -> Page:
    """Both runs side by side."""
    runs = {
        WET: work.run("wet", SCENE, [f"time.end={END}"]),
        DRY: work.run("dry", SCENE, ["fluid.backend=dry"]),
    }
    summaries = [run.summary for run in runs.values()]
    overlap = any(not summary["smallest_gap"] > 0.0 for summary in summaries)
    spheres = len(runs[WET].scene.body)
    text = TEXT.format(
        spheres=spheres,
        end=END,
        figures=table(("figure", *runs), figures(list(runs.values()))),
        overlap="Spheres overlap" if overlap else "No spheres overlap",
    )
    return Page("A hundred spheres settle", text, {"": curves(runs)})


TEXT = """`scenes/hundred_spheres.toml`: {spheres} spheres settle in a box. In the fluid they are followed to {end} s,
and without it (`--set fluid.backend=dry`) to the end, with a law that loses no energy. The scene is for meshes, memory
and contacts: cells are as long as the spheres' radii, and no published paths exist to compare with.

{figures}

{overlap}."""


def figures(runs: list[Run]) -> list[tuple[str, ...]]:
    """Each figure of both runs."""

    def each(name: str, figure: str) -> tuple[str, ...]:
        return name, *(figure.format(run=run, **run.summary) for run in runs)

    def wet(name: str, value: str) -> tuple[str, ...]:
        return name, value, ""

    summary = runs[0].summary
    near = [run.history.contacts["time"] for run in runs]
    most = (f"{np.unique(times, return_counts=True)[1].max(initial=0)}" for times in near)
    energies = (run.summary["energy"] for run in runs)
    return [
        each("end [s]", "{time:.3g}"),
        each("steps, rejected", "{steps}, {rejected_steps}"),
        each("smallest gap [cm]", "{smallest_gap:.4f}"),
        ("contacts in range, most at a time", *most),
        ("energy created, lost [%]", *(f"{100 * each['created']:.4f}, {100 * each['lost']:.4f}" for each in energies)),
        wet("unknowns at the end", f"{summary['unknowns']:,}"),
        wet("new meshes, failed", f"{summary['remeshes']}, {summary['failed_remeshes']}"),
        wet("quality of the worst cell at any step", f"{summary['worst_quality']:.3f}"),
        wet("memory [GiB]", f"{summary['peak_memory'] / GIBIBYTE:.2f}"),
        ("CPU time of one thread [s]", *(f"{run.cpu_seconds:.0f}" for run in runs)),
    ]


def curves(runs: dict[str, Run]) -> Figure:
    """Mean height and least gap over time."""
    figure = Figure(figsize=(8.0, 5.0), dpi=80, layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    for label, run in runs.items():
        count = len(run.scene.body)
        when, height, gap = (run.history.bodies[name].reshape(-1, count) for name in ("time", "z", "gap"))
        panels[0].plot(when[:, 0], height.mean(axis=1), label=label)
        panels[1].semilogy(when[:, 0], gap.min(axis=1), label=label)
    for axes, label in zip(panels, ("mean height [cm]", "least gap [cm]"), strict=True):
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    panels[0].legend()
    panels[-1].set_xlabel("time [s]")
    return figure
