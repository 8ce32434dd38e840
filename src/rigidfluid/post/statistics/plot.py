"""The plot of statistics: structure above, motion and layers below."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.style import BLUE, PALETTE, new_figure
from rigidfluid.post.statistics.blocks import Mean
from rigidfluid.post.statistics.figures import Statistics


def statistics_plot(found: Statistics) -> Figure:
    """Pair distribution, structure factor, mean square displacement, and profiles of bodies and their velocities."""
    figure = new_figure(10.5, 6.0)
    pairs, waves, spread, layers, speeds, text = figure.subplots(2, 3).ravel()
    _draw_mean(pairs, found.pairs.distance / (2.0 * found.samples.radius.mean()), found.pairs.value)
    pairs.axhline(1.0, color="black", linewidth=0.6)
    pairs.set(xlabel="distance [mean diameters]", ylabel="pair distribution g [1]", ylim=(0.0, None))
    _draw_mean(waves, found.structure.wavenumber * 2.0 * found.samples.radius.mean(), found.structure.value)
    waves.set(xlabel="wavenumber × mean diameter [1]", ylabel="structure factor S [1]")
    for axes in (pairs, waves):
        axes.set_ylim(bottom=0.0)
    _draw_displacement(spread, found)
    _draw_layers(layers, speeds, found)
    _draw_figures(text, found)
    return figure


def _draw_mean(axes: Axes, places: FloatArray, values: Mean) -> None:
    """A line with its standard error on either side."""
    axes.plot(places, values.value, color=BLUE)
    error = np.nan_to_num(values.error)
    axes.fill_between(places, values.value - error, values.value + error, color=BLUE, alpha=0.25, linewidth=0.0)


def _draw_displacement(axes: Axes, found: Statistics) -> None:
    for name, curve, colour in zip("xyz", found.diffusion.displacement.T, PALETTE, strict=False):
        axes.loglog(found.diffusion.lag, np.maximum(curve, np.finfo(float).tiny), color=colour, label=name)
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set(xlabel="lag [time]", ylabel="mean square displacement [area]")
    axes.legend()


def _draw_layers(layers: Axes, speeds: Axes, found: Statistics) -> None:
    profile = found.profile
    across = f"{'xyz'[profile.axis]} [length]"
    layers.errorbar(profile.fraction.value, profile.place, xerr=np.nan_to_num(profile.fraction.error), color=BLUE)
    layers.set(xlabel="share of bodies in a layer [1]", ylabel=across)
    kinds = {"bodies": (profile.velocity, "-"), "fluid": (profile.fluid, "--"), "both": (profile.mixture, ":")}
    for kind, (velocity, line) in kinds.items():
        if velocity is not None:
            for name, curve, error, colour in zip("xyz", velocity.value.T, velocity.error.T, PALETTE, strict=False):
                label, off = f"{name}, {kind}", np.nan_to_num(error)
                speeds.errorbar(curve, profile.place, xerr=off, color=colour, linestyle=line, label=label)
    speeds.set(xlabel="velocity [length/time]", ylabel=across)
    above: dict[str, Any] = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0)}
    speeds.legend(ncols=3, fontsize=6.5, columnspacing=1.0, handlelength=4.0, **above)


def _draw_figures(axes: Axes, found: Statistics) -> None:
    """Single figures as text."""
    axes.axis("off")
    text = "\n".join(found.lines)
    axes.text(0.0, 0.98, text, va="top", transform=axes.transAxes, fontsize=8.0, linespacing=1.6, wrap=True)
