"""A disk falls through a long channel, all of it meshed and in windows of several lengths."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid.core.scene.scene import Scene

RUNS: dict[str, tuple[float, float] | None] = {
    "whole": None,
    "as_shipped": (2.0, 3.0),
    "less_ahead": (1.0, 3.0),
    "more_ahead": (4.0, 3.0),
    "less_behind": (2.0, 1.5),
    "more_behind": (2.0, 6.0),
    "more": (4.0, 6.0),
}
"""By folder: how much of the channel is meshed ahead of the disk and behind it [cm]; all of it."""


COARSE = ["mesh.size=0.4", "mesh.size_body=0.04", "time.step=0.008"]


def page(work: Work) -> Page:
    """Speeds in the windows against that in the whole channel."""
    runs = {name: work.run(name, windowed(work, ends)) for name, ends in RUNS.items()}
    whole = runs["whole"]
    found = {name: figures(run, whole) for name, run in runs.items()}
    ways = [("whole channel", "") if ends is None else tuple(f"{end:g}" for end in ends) for ends in RUNS.values()]
    rows = [(*way, *values.values()) for way, values in zip(ways, found.values(), strict=True)]
    late = {name: abs(final_speed(run) / final_speed(whole) - 1.0) for name, run in runs.items()}
    coarse, coarse_whole = (
        work.run(f"{name}_coarse", windowed(work, RUNS[name], COARSE)) for name in ("as_shipped", "whole")
    )
    text = ABOUT.format(
        figures=table(("ahead [cm]", "behind [cm]", *found["whole"]), rows),
        **late,
        farther=max(late["more_ahead"], late["more"]),
        coarse=abs(final_speed(coarse) / final_speed(coarse_whole) - 1.0),
        changes=final_speed(coarse_whole) / final_speed(whole) - 1.0,
    )
    return Page("A window in a long channel", text, {"": speeds(runs)})


def windowed(work: Work, ends: tuple[float, float] | None, overrides: Iterable[str] = ()) -> Scene:
    """The fall with so much ahead and behind in the window, or in the whole channel."""
    tables = work.scene("falling_disk_window.toml", overrides).to_dict()
    if ends is None:
        del tables["domain"]["window"]
    else:
        tables["domain"]["window"] |= {"ahead": ends[0], "behind": ends[1]}
    return rigidfluid.scene_from_dict(tables)


def speeds(runs: dict[str, Run]) -> Figure:
    """Over time, and how far they are off that in the whole channel."""
    figure = Figure(figsize=(8.0, 4.2), dpi=120, layout="constrained")
    speed, off = figure.subplots(1, 2)
    speed.set(xlabel="time [s]", ylabel="speed of the disk [cm/s]")
    off.set(xlabel="time [s]", ylabel="off the whole channel's speed [1]", yscale="log", ylim=(1e-7, 1e-1))
    for name, run in runs.items():
        bodies, ends = run.history.bodies, RUNS[name]
        label, style = ("whole channel", "k") if ends is None else ("{:g} ahead, {:g} behind".format(*ends), "--")
        speed.plot(bodies["time"], -bodies["vy"], style, label=label)
        off.plot(bodies["time"], np.abs(off_the_whole(run, runs["whole"])), style)
    speed.legend()
    return figure


def off_the_whole(run: Run, whole: Run) -> np.ndarray:
    """Speed less that in the whole channel, over its final speed, at each step [1]."""
    return (whole.history.bodies["vy"] - run.history.bodies["vy"]) / final_speed(whole)


def final_speed(run: Run) -> float:
    """Mean of the last tenth of a second."""
    bodies = run.history.bodies
    return float(-np.mean(bodies["vy"][bodies["time"] > bodies["time"][-1] - 0.1]))


def figures(run: Run, whole: Run) -> dict[str, str]:
    """What the page tells of one run."""
    summary, speed, energy = run.summary, final_speed(run), run.history.energy
    put = summary["energy"]["put_in"]
    return {
        "final speed [cm/s]": f"{speed:.4f}",
        "off the whole channel's": f"{speed / final_speed(whole) - 1:+.3%}",
        "off it at any time": f"{np.abs(off_the_whole(run, whole)).max():.3%}",
        "unknowns": f"{summary['unknowns']} ({summary['unknowns'] / whole.summary['unknowns']:.0%})",
        "CPU": f"{run.cpu_seconds / whole.cpu_seconds:.0%}",
        "meshes": f"{1 + summary['remeshes']}",
        "energy out through the ends, of all put in": f"{-energy['boundary'][-1] / put:.2%}",
        "residual, lowest … highest": f"{energy['residual'].min() / put:.1e} … {energy['residual'].max() / put:.1e}",
        "created, lost": "{created:.1e}, {lost:.1e}".format(**summary["energy"]),
    }


ABOUT = """`scenes/falling_disk_window.toml`: the disk of the [falling disk](falling_disk.md) falls through a channel
20 times as long as wide. Its mesh is a window of the channel that goes with it. For comparison the whole channel is
meshed, with the same wanted sizes of cells. The final speed is that of the last tenth of a second; the largest
difference of the speeds is over the final one. CPU times, of one thread, are over that of the whole channel.

{figures}

Ahead of the disk the window's fluid is held at rest, and this slows the disk: its final speed is off by
{less_ahead:.3%} with half a channel's width of fluid ahead, by {as_shipped:.3%} with one width, and by at most
{farther:.3%} with two. Behind the disk the wake leaves through the open end. The balance includes the energy that it
takes along.

With cells and steps twice as large the final speed in the whole channel is {changes:+.2%} off, and that in the window
as shipped {coarse:.3%} off the whole channel's."""
