"""A disk of the fluid's density migrates across a periodic channel, beside Pan and Glowinski's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import MIGRATION_GRADIENT, MIGRATION_PATH, MIGRATION_VISCOSITY

START, OTHER = 0.4, 0.15
CELLS, FINER = (0.1, 0.04), (0.05, 0.02)
STEP, SHORTER = 1.0, 0.5
END, LAST = 1600.0, 50.0


@dataclass(frozen=True)
class Case:
    """A height at the start, lengths of cells far from the disk and on it, and a step."""

    height: float = START
    cells: tuple[float, float] = CELLS
    step: float = STEP

    @property
    def label(self) -> str:
        """Name of its folder."""
        return f"from_{self.height:g}_{self.cells[1]:g}_{self.step:g}"

    @property
    def overrides(self) -> list[str]:
        """Settings of scenes/periodic_channel.toml."""
        return [
            "domain.upper=[1.0, 1.0]",
            "fluid.initial=rest",
            f"fluid.viscosity={MIGRATION_VISCOSITY}",
            f"boundary.0.pressure_drop={MIGRATION_GRADIENT}",
            "body.0.radius=0.125",
            f"body.0.position=[0.5, {self.height}]",
            f"mesh.size={self.cells[0]}",
            f"mesh.size_body={self.cells[1]}",
            f"time.end={END}",
            f"time.step={self.step}",
            f"output.every={END}",
        ]


CASES = (Case(), Case(cells=FINER), Case(step=SHORTER), Case(height=OTHER), Case(height=OTHER, cells=FINER))


@dataclass(frozen=True)
class Path:
    """Heights of a disk over its ``way`` along the channel, and the mean ``speed`` through the channel at the end."""

    way: np.ndarray
    height: np.ndarray
    speed: float

    @classmethod
    def of(cls, run: Run) -> Path:
        """From the tables of a run."""
        bodies, driving = run.history.bodies, run.history.driving
        return cls(bodies["x"] - bodies["x"][0], bodies["y"], float(driving["flux"][driving["surface"] == "left"][-1]))

    @property
    def off(self) -> float:
        """Greatest distance from the published heights."""
        way, height = MIGRATION_PATH.T
        return float(np.abs(np.interp(way, self.way, self.height) - height).max())

    @property
    def reynolds(self) -> float:
        """Reynolds number of the channel, by the mean velocity and the width 1."""
        return self.speed / MIGRATION_VISCOSITY


def page(work: Work) -> Page:
    """Paths from two heights, on two meshes and with two steps."""
    runs = {case: work.run(case.label, "periodic_channel.toml", case.overrides) for case in CASES}
    paths = {case: Path.of(run) for case, run in runs.items()}
    rows = [(case, paths[case], runs[case]) for case in CASES]
    head = (
        "from",
        "cells at the disk",
        "step",
        f"height at {LAST:g}",
        "at the end",
        "off the published path",
        "Reynolds number",
        "periods",
        "new meshes",
        "residual",
        "CPU time",
    )
    text = ABOUT.format(rows=table(head, (_told(*row) for row in rows)), last=f"{MIGRATION_PATH[-1, 1]:g}")
    return Page("A disk migrates in a channel", text, {"": _figure(paths)})


def _told(case: Case, path: Path, run: Run) -> tuple[str, ...]:
    energy, summary = run.summary["energy"], run.summary
    return (
        f"{case.height:g}",
        f"{case.cells[1]:g}",
        f"{case.step:g}",
        f"{np.interp(LAST, path.way, path.height):.4f}",
        f"{path.height[-1]:.4f}",
        f"{path.off:.4f}" if case.height == START else "",
        f"{path.reynolds:.2f}",
        f"{path.way[-1]:.0f}",
        f"{summary['remeshes']}",
        f"{energy['residual'] / energy['put_in']:+.1e}",
        f"{run.cpu_seconds:.0f} s",
    )


def _figure(paths: dict[Case, Path]) -> Figure:
    figure = Figure(figsize=(8.0, 3.8), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="way along the channel over its width", ylabel="height over the width")
    for case, path in paths.items():
        label = f"from {case.height:g}, cells of {case.cells[1]:g}, step of {case.step:g}"
        axes.plot(path.way, path.height, label=label, linewidth=1.0)
    axes.plot(*MIGRATION_PATH.T, "o", color="black", markersize=4, label="Pan and Glowinski 2002", fillstyle="none")
    axes.set(xlim=(0.0, LAST), ylim=(0.1, 0.45))
    axes.legend(frameon=False, fontsize=8)
    return figure


ABOUT = """A disk of the fluid's density starts at rest in a channel that is as long as wide, and periodic; its
diameter is a quarter of the width. A pressure drop of 2.337e-4, at a viscosity of 1/2334, drives fluid and disk from
rest. The disk migrates to a height between the wall and the middle, from both sides (Segré and Silberberg). Pan and
Glowinski (J. Comput. Phys. 181 (2002) 260) computed it from .4 with fictitious domains; at
the end their disk is at {last}. Their path, and these numbers of their scene, are those that the repository
EllipsesInFlows (N. Hori, its example `case2`) took from their paper.

{rows}

Lengths are over the width of the channel. *Off the published path* is the greatest distance from its points in height,
from the start to 50 widths. The Reynolds number is that of the mean velocity at the end and the width, by the flux
through the ends; the residual is over the energy that the drop put in. Reading the published figure may be wrong by
.001."""
