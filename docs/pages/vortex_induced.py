"""A cylinder on springs of three stiffnesses, and fixed, in a stream at Re = 100."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from vortex_induced import FIXED, PUBLISHED, Swing, growth, measured

import rigidfluid
from rigidfluid.core.scene.scene import Scene

RUNS: dict[float, tuple[str, list[str]]] = {
    19.8: ("k_19.8", ["body.0.spring.stiffness=[0.0,9.9]"]),
    9.88: ("k_9.88", []),
    4.74: ("k_4.74", ["body.0.spring.stiffness=[0.0,2.37]", "time.end=125.0"]),
}
"""By k*: the folder, and what differs from the scene as shipped. Each goes on until its amplitude is steady."""


def page(work: Work) -> Page:
    """The figures beside published ones."""
    fixed = work.run("fixed", held(work))
    swinging = {k: work.run(name, "vortex_induced.toml", overrides) for k, (name, overrides) in RUNS.items()}
    rows = list(lines("fixed", "", FIXED, fixed))
    for stiffness, run in swinging.items():
        reduced = f"{2.0 * np.pi * np.sqrt(5.0 / stiffness):.2f}"
        rows += lines(str(stiffness), reduced, PUBLISHED.get(stiffness), run)
    head = ("k*", "U/(f_n D)", "of", "amplitude/D", "frequency · D/U", "lift, amplitude", "drag, mean")
    head += ("amplitude grows in 5 periods", "energy created, lost", "unknowns", "remeshes", "CPU s")
    text = ABOUT.format(figures=table(head, rows), swings=", ".join(told(swinging, measured(fixed.history).frequency)))
    return Page("Vortex-induced vibration", text, {"": swings(swinging)})


def held(work: Work) -> Scene:
    """The scene with a cylinder that does not move."""
    tables = work.scene("vortex_induced.toml", ["time.end=80.0"]).to_dict()
    cylinder = {key: value for key, value in tables["body"][0].items() if key not in ("free", "spring")}
    return rigidfluid.scene_from_dict(tables | {"body": [cylinder | {"fixed": True}]})


def swings(runs: dict[float, Run]) -> Figure:
    """The cylinder's way over time, by k*."""
    figure = Figure(figsize=(8.0, 5.6), dpi=120, layout="constrained")
    panels = figure.subplots(len(runs), 1, sharex=True)
    for axes, (stiffness, run) in zip(panels, runs.items(), strict=True):
        axes.plot(run.history.bodies["time"], run.history.bodies["y"], linewidth=0.8)
        published = PUBLISHED.get(stiffness)
        for sign in (-1.0, 1.0) if published else ():
            axes.axhline(sign * published.amplitude, color="black", linewidth=0.8, linestyle="--")
        axes.set(ylabel="y/D", title=f"k* = {stiffness}")
    panels[-1].set_xlabel("time · U/D")
    return figure


def lines(name: str, reduced: str, published: Swing | None, run: Run) -> Iterable[tuple[str, ...]]:
    """What was published, if anything, and what was measured."""
    if published is not None:
        yield name, reduced, "Shiels et al.", *(f"{value:g}" for value in published), "", "", "", "", ""
    summary, found = run.summary, measured(run.history)
    grows = f"{growth(run.history):.1%}" if found.amplitude else ""
    created, lost = (f"{summary['energy'][key]:.2%}" for key in ("created", "lost"))
    cost = (f"{created}, {lost}", str(summary["unknowns"]), str(summary["remeshes"]))
    yield name, reduced, "rigidfluid", *(f"{value:.4f}" for value in found), grows, *cost, f"{run.cpu_seconds:.0f}"


def told(runs: dict[float, Run], shedding: float) -> Iterable[str]:
    """Amplitude, and frequency over that at which a cylinder sheds that is held."""
    for stiffness, run in runs.items():
        found = measured(run.history)
        frequency = found.frequency / shedding
        yield f"at k* = {stiffness} by {found.amplitude:.2f} D, with {frequency:.2f} times that frequency"


ABOUT = """{figures}

A cylinder of diameter D is free across a stream U alone and hangs on a spring, without damper
(`scenes/vortex_induced.toml`): Re = UD/ν = 100, mass m* = m/(½ρD²) = 5 and stiffness k* = k/(½ρU²) per length; f_n is
√(k/m)/2π, without added mass. Figures are of the last five periods; dashed lines are the published amplitudes. The box
reaches 20 D to the inlet and to either side (blockage 2.5 %) and 30 D to the outlet, and the sides let the fluid slip.

Published: D. Shiels, A. Leonard, A. Roshko, J. Fluids Struct. 15 (2001) 3, doi:10.1006/jfls.2000.0330, table 2, by a
vortex method in an unbounded fluid; the figures are taken from works that quote them. Nothing published was at hand for
k* = 19.8. Where vortices and cylinder swing together (lock-in) it is not with the frequency at which a fixed cylinder
sheds. The cylinder swings {swings}."""
