"""The plot of how bodies turn, and by what torque."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.output.records import quantity_columns
from rigidfluid.post.reports.curves import add_legend, draw_bodies
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import fluid_and_contacts, time_panels

_TURNED = 0.01
"""Balls that turn by less [rad] are not shown, and nothing is where no body turns by as much."""


def turned(results: Results) -> FloatArray:
    """How far each body has turned since its first state (s, n) [rad]: in 2D with sign and whole turns, in 3D the angle
    of the rotation that leads there, from 0 to π."""
    now = results.quantity("orientation")
    first = now[results.present.argmax(axis=0), np.arange(len(results.names))]
    if results.system.dimension == 2:
        return np.asarray((now - first)[..., 0])
    cosine = np.abs(np.sum(now * first, axis=-1))
    return np.asarray(2.0 * np.arccos(np.minimum(cosine, 1.0)))


def turning(results: Results) -> BoolArray:
    """Which bodies (n,) have their rotation shown: those that turn, and others that are no balls if any does."""
    far = np.nanmax(np.abs(turned(results)), axis=0) >= _TURNED
    no_balls = ~results.system.balls
    return np.asarray((far | no_balls) & far.any())


def rotation_plot(results: Results) -> Figure:
    """Angle and angular velocity of bodies that turn."""
    chosen = turning(results)
    two = results.system.dimension == 2
    names = _names(results, chosen)
    angle = results.bodies["angle"] if two else turned(results)
    spins = {"angular velocity": "w"} if two else {f"angular velocity\nabout {axis}": f"w{axis}" for axis in "xyz"}
    figure, panels = time_panels(1 + len(spins))
    draw_bodies(panels[0], results.time, angle[:, chosen], names)
    panels[0].set_ylabel("angle [rad]" if two else "turned since the start\n[rad]")
    for axes, (label, column) in zip(panels[1:], spins.items(), strict=True):
        draw_bodies(axes, results.time, results.bodies[column][:, chosen], names)
        axes.set_ylabel(f"{label}\n[rad/time]")
    add_legend(figure)
    return figure


def torque_plot(results: Results) -> Figure:
    """Torques about the centres of bodies that turn, by the fluid and by contacts side by side, to the same scale."""
    chosen = turning(results)
    names = _names(results, chosen)
    parts = quantity_columns(results.system.dimension)["torque"]
    figure, panels = fluid_and_contacts(len(parts))
    for part, (left, right) in zip(parts, panels, strict=True):
        draw_bodies(left, results.time, results.bodies[part][:, chosen], names)
        draw_bodies(right, results.time, results.bodies["c" + part][:, chosen], names)
        left.set_ylabel(f"torque{' about ' + part[1:] if part[1:] else ''}\n[force·length]")
    add_legend(figure)
    return figure


def _names(results: Results, chosen: BoolArray) -> list[str]:
    return [name for name, shown in zip(results.names, chosen, strict=True) if shown]
