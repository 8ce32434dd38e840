"""The plots over time: positions, speeds, gaps, forces, and the energy balance."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.energy_account import energy_account, per_cent
from rigidfluid.core.output.records import joint_coordinates
from rigidfluid.post.reports.curves import add_legend, draw_bodies, widen
from rigidfluid.post.reports.error_bars import draw_bars
from rigidfluid.post.reports.paths import draw_paths
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import (
    BLACK,
    BLUE,
    BODY,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    fluid_and_contacts,
    new_figure,
    time_panels,
)
from rigidfluid.post.reports.view_plane import ViewPlane

_PARTS = {
    "residual_steps": "in smooth motion",
    "residual_contacts": "at impacts",
    "residual_remeshing": "by re-meshing",
    "residual_mesh": "through slip faces",
    "residual_start": "in first steps",
}
_VISIBLE = 0.05
"""Parts of the residual that are nowhere larger than this part of its greatest value are not drawn."""


def position_plot(results: Results, plane: ViewPlane) -> Figure:
    """The paths through the domain as the ``plane`` shows them, and each coordinate over time."""
    position, axes_names = results.quantity("position"), results.axes
    figure = new_figure(8.0, 2.0 * len(axes_names) + 0.8)
    left, right = figure.subfigures(1, 2, width_ratios=(2, 3), squeeze=False)[0]
    draw_paths(left.subplots(), results, plane)
    panels = right.subplots(len(axes_names), 1, sharex=True)
    for k, axes in enumerate(panels):
        draw_bodies(axes, results.time, position[..., k], results.names)
        axes.set_ylabel(f"{axes_names[k]} [length]")
        widen(axes, 0.1 * float(results.system.domain.size[k]))
    add_legend(right)
    panels[-1].set_xlabel("time [time]")
    return figure


def speed_plot(results: Results) -> Figure:
    """Speed and, in a fluid, the Reynolds number with either density."""
    speed = np.linalg.norm(results.quantity("velocity"), axis=2)
    reynolds = _reynolds_numbers(results, speed)
    figure, panels = time_panels(1 + len(reynolds))
    draw_bodies(panels[0], results.time, speed, results.names)
    draw_bars(panels[0], results, "velocity")
    panels[0].set_ylabel("speed\n[length/time]")
    add_legend(figure)
    for axes, (whose, values) in zip(panels[1:], reynolds.items(), strict=True):
        draw_bodies(axes, results.time, values, results.names)
        axes.set_ylabel(f"Reynolds number\ndensity of the {whose}")
        highest = np.nanmax(values)
        axes.axhline(highest, color=BLACK, linewidth=0.8, linestyle=":")
        axes.annotate(f"highest {highest:.4g}", (results.time[-1], highest), (0, -4),
                      textcoords="offset points", ha="right", va="top", fontsize=9)  # fmt: skip
    return figure


def gap_plot(results: Results) -> Figure:
    """Each body's nearest gap, logarithmic, with the range of the contact law."""
    figure, (axes,) = time_panels(1, height=3.0)
    gap = np.where(results.bodies["gap"] > 0.0, results.bodies["gap"], np.nan)
    draw_bodies(axes, results.time, gap, results.names)
    axes.set_yscale("log")
    axes.set_ylabel("nearest gap [length]")
    for reach in results.system.law.ranges if results.system.law is not None else ():
        label = f"range of the contact law {reach:g}"
        axes.axhline(reach, color=VERMILLION, linewidth=1.0, linestyle="--", label=label)
    add_legend(figure)
    return figure


def force_plot(results: Results) -> Figure:
    """The fluid's force and the contact force side by side, all components to the same scale."""
    figure, panels = fluid_and_contacts(len(results.axes))
    fluid, contact = results.quantity("force"), results.quantity("contact_force")
    for k, (left, right) in enumerate(panels):
        draw_bodies(left, results.time, fluid[..., k], results.names)
        draw_bars(left, results, "force", k)
        draw_bodies(right, results.time, contact[..., k], results.names)
        left.set_ylabel(f"{results.axes[k]}-force [force]")
        _draw_weight(left, right, results, k)
    add_legend(figure)
    return figure


def joint_plot(results: Results) -> Figure:
    """The angles of hinges and other coordinates of joints, and the size of the force in each."""
    units = joint_coordinates(results.system)
    shown = [name for name in units if not np.isnan(results.joints[name]).all()] or ["angle"]
    figure, panels = time_panels(len(shown) + 1)
    force = np.sqrt(sum(results.joints[f"f{axis}"] ** 2 for axis in results.axes))
    drawn = [(results.joints[name], f"{name} of joints\n[{units[name]}]") for name in shown]
    for axes, (values, label) in zip(panels, [*drawn, (force, "force in joints\n[force]")], strict=True):
        draw_bodies(axes, results.time, values, results.joint_names)
        axes.set_ylabel(label)
    add_legend(figure)
    return figure


def energy_plot(results: Results) -> Figure:
    """Plot the energy supplied against its shares, dissipated, stored or lost, and the residual of the balance."""
    figure, (axes, below) = time_panels(2, height=2.8)
    energy = results.energy
    contact = energy["contact"] - min(energy["contact"].min(), 0.0)  # attraction counts from its lowest
    initial = energy["kinetic"][0] + contact[0]
    supplied = initial + sum(energy[name] for name in ("gravity", "boundary", "control", "body_force", "exchange"))
    shares = {
        "dissipated": (energy["dissipation"], ORANGE),
        "taken by stabilisation": (energy["grad_div_loss"], SKY),
        "kinetic": (energy["kinetic"], BLUE),
        "in contacts": (contact, GREEN),
        "taken by dampers": (energy["contact_loss"], BODY),
        "lost in transfer": (energy["transfer_loss"], PURPLE),
    }
    axes.stackplot(energy["time"], *(values for values, _ in shares.values()), labels=list(shares),
                   colors=[colour for _, colour in shares.values()], alpha=0.75, linewidth=0)  # fmt: skip
    axes.plot(energy["time"], supplied, color=BLACK, linestyle="--", label="supplied + initial")
    axes.set_ylabel("energy [energy]")
    account = energy_account(energy)
    scale = 100.0 * account.share(1.0)
    _draw_residual(below, {name: scale * values for name, values in energy.items() if name != "time"}, energy["time"])
    below.set_ylabel("not accounted for\n[% of what was at hand]")
    created, lost = (per_cent(account.share(flow.largest)) for flow in (account.creation, account.loss))
    told = f"created {created}, lost {lost} at most in a stretch"
    residual, until = per_cent(account.share(energy["residual"][-1])), "so far" if results.goes_on else "at the end"
    below.set_title(f"{told}, {residual} unaccounted for {until}", fontsize=9)
    add_legend(figure)
    return figure


def step_plot(results: Results) -> Figure:
    """Length of each step."""
    figure, (axes,) = time_panels(1)
    axes.step(results.time[1:], np.diff(results.time), where="pre", color=BLUE)
    axes.set_yscale("log")
    axes.set_ylabel("step [time]")
    return figure


def _reynolds_numbers(results: Results, speed: FloatArray) -> dict[str, FloatArray]:
    """2 R ρ |v| / μ of each body (s, n), by whose density ρ is; empty without a fluid. R and μ as in the summary."""
    fluid = results.system.fluid
    if fluid is None:
        return {}
    diameter = 2.0 * results.system.bounding_radii
    rate = np.nan_to_num(speed / diameter)
    viscosity = fluid.material.viscosity(rate.ravel()).reshape(rate.shape)
    solid = np.array([body.density for body in results.model.all_bodies])
    per_density = diameter * speed / viscosity
    return {"fluid": per_density * fluid.density, "solid": per_density * solid}


def _draw_residual(axes: Axes, shares: dict[str, FloatArray], time: FloatArray) -> None:
    """The residual, the parts of it that are large enough to be seen, and what friction of impacts explains."""
    axes.plot(time, shares["residual"], color=VERMILLION, label="residual")
    for (name, words), colour in zip(_PARTS.items(), (BLUE, PURPLE, GREEN, ORANGE, SKY), strict=True):
        if np.abs(shares[name]).max() > _VISIBLE * np.abs(shares["residual"]).max():
            axes.plot(time, shares[name], color=colour, linewidth=1.0, label=words)
    if shares["path_friction"].any():
        axes.plot(time, shares["path_friction"], color=BLACK, linestyle=":", label="path friction")


def _draw_weight(left: Axes, right: Axes, results: Results, k: int) -> None:
    """The force that holds a body at rest, where it is the same for all and not zero."""
    weight = results.system.weight[:, k]
    if np.ptp(weight) > 0.0 or weight[0] == 0.0:
        return
    for axes in (left, right):
        axes.axhline(-weight[0], color=BLACK, linewidth=0.8, linestyle=":", label="opposite of the submerged weight")
