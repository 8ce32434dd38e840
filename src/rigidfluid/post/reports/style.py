"""How pictures look: colours that colour-blind readers can tell apart, sizes, and saving without traces of the time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rigidfluid.core.output.disk import open_new

# Okabe and Ito's palette, without its yellow, which is too pale for a line.
BLACK, ORANGE, SKY, GREEN, BLUE, VERMILLION, PURPLE = (
    "#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7",
)  # fmt: skip
PALETTE = (BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY, BLACK)
BODY = "#8c8c8c"
OUTSIDE, HATCH = "#ededed", "#bcbcbc"
"""Ground and oblique lines of what is not in the domain."""
SOLID = "#d8d8d8"
"""Bodies under a light."""

STYLE: Any = {
    "font.size": 10.0,
    "axes.titlesize": 10.0,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-3, 4),
    "legend.frameon": False,
    "legend.fontsize": 9.0,
    "lines.linewidth": 1.4,
    "figure.constrained_layout.w_pad": 0.08,
    "figure.constrained_layout.h_pad": 0.08,
    "savefig.dpi": 110,
    "svg.hashsalt": "rigidfluid",
}
"""Matplotlib's settings for every picture here; the caller holds them with ``matplotlib.rc_context``."""


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that belongs to no window and to no global state."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def time_panels(rows: int, height: float = 2.3) -> tuple[Figure, list[Axes]]:
    """A figure of panels over time, one below the other."""
    figure = new_figure(8.0, height * rows + 0.5)
    panels = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
    panels[-1].set_xlabel("time [time]")
    return figure, panels


def fluid_and_contacts(rows: int) -> tuple[Figure, Any]:
    """A figure of panels over time (rows, 2), all to one scale: the fluid's part above that of contacts."""
    figure = new_figure(8.0, 2.3 * rows + 0.6)
    panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
    for column, title in enumerate(("from the fluid", "from contacts")):
        panels[0][column].set_title(title)
        panels[-1][column].set_xlabel("time [time]")
    return figure, panels


def save(figure: Figure, folder: Path, name: str, kinds: Sequence[str]) -> list[Path]:
    """Write a figure in each of ``kinds``; equal figures give equal files."""
    paths = [folder / f"{name}.{kind}" for kind in kinds]
    for path in paths:
        metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
        with open_new(path) as file:
            figure.savefig(file, format=path.suffix[1:], metadata=metadata)
    return paths
