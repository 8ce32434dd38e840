"""Flows along curved walls and through oblique ends against their exact solutions."""

from __future__ import annotations

import numpy as np
from curved_channels import (
    error_in_bend,
    flow_between_cylinders,
    flow_in_bend,
    flux_of,
    flux_through_bend,
    torque_between_cylinders,
)
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from periodic_arrays import array_of_balls, exact_array

LAYERS = (2, 4, 8, 16)


def page(work: Work) -> Page:
    """Errors over the layers of cells, and forces on arrays of balls."""
    columns = errors()
    rows = [
        (
            str(count),
            *(f"{values[i]:.1e} ({order(values, i)})" if i else f"{values[i]:.1e}" for values in columns.values()),
        )
        for i, count in enumerate(LAYERS)
    ]
    arrays = [
        (str(layers), name, f"{(force := array_of_balls(d, layers)):.3f}", f"{force / exact_array(d) - 1.0:+.2%}")
        for d, name in ((2, "cylinders"), (3, "spheres"))
        for layers in (LAYERS if d == 2 else (2, 4, 6))
    ]
    text = ABOUT + table(("layers", *columns), rows) + PERIODIC + table(("layers", "of", "force", "off"), arrays)
    return Page("Curved walls and oblique ends", text, {"": plot(columns)})


def errors() -> dict[str, list[float]]:
    """Of flux, velocity and torques, relative, for each of LAYERS."""
    bends, exact = [flow_in_bend(count) for count in LAYERS], flux_through_bend()
    fluxes = [abs(flux_of(flow) / exact - 1.0) for flow in bends]
    speeds = [error_in_bend(flow) for flow in bends]
    torques = {}
    for name, spins in {"inner": (1.0, 0.0), "outer": (0.0, 1.0)}.items():
        flows = [flow_between_cylinders(count, *spins) for count in LAYERS]
        expected = torque_between_cylinders(*spins)
        found = [flow.advance.hydrodynamic_wrench.torque[0, 0] for flow in flows]
        torques[name] = [abs(torque / expected - 1.0) for torque in found]
    return {
        "bend: flux": fluxes,
        "bend: velocity": speeds,
        **{f"cylinders, {name} turning: torque": values for name, values in torques.items()},
    }


def plot(columns: dict[str, list[float]]) -> Figure:
    """Errors over the layers."""
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="layers of cells", ylabel="relative error", xscale="log", yscale="log")
    for (name, values), style in zip(columns.items(), ("o-", "s-", "x-", "+--"), strict=True):
        axes.plot(LAYERS, values, style, label=name)
    axes.plot(LAYERS, [2.0 * count**-3.0 for count in LAYERS], "k:", label="order 3")
    axes.legend(fontsize=8)
    return figure


def order(errors: list[float], i: int) -> str:
    """Of convergence by the last halving before the error of number ``i``."""
    return f"{np.log2(errors[i - 1] / errors[i]):.1f}"


ABOUT = """Stokes flow in 2D between circles of radius 0.5 and 1, cells curved along them, from coarse to fine. The
bend turns through 2 rad, with a pressure on its two ends, which lie across no axis; errors of its flux and its
velocity (root mean square over its own) against u(r) = (G/2μ)(A r + B/r - r ln r). Between cylinders the disk inside
turns, or the wall outside (`angular_velocity` of a `wall`); error of the torque on the disk against 4πμ(Ω₂ -
Ω₁)R₁²R₂²/(R₂² - R₁²). In brackets the order of convergence.

"""

PERIODIC = """

## Periodic surfaces

Cubic arrays of balls of radius 0.2 and distance 1 in Stokes flow that a pressure drop drives, periodic in all
directions: force on each over viscosity and mean velocity, against the series of Sangani and Acrivos 1982,
doi:10.1016/0301-9322(82)90029-5 and 10.1016/0301-9322(82)90047-7. The first of them has coefficients of three digits
and ends with the cube of the volume fraction, which is 0.126 here.

"""
