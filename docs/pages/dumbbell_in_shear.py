"""A pair of balls that turns in shear against the exact theory of two spheres, in boxes and as without one."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from shear_boxes import angles, rates, time_of, without_box
from two_spheres import angle, axis_ratio, period, rotation_in_strain

DISTANCES = (2.0 + 1e-6, 2.2, 3.0, 4.0, 6.0)

BOXES = {3.0: (6.0, 9.0, 12.0), 2.2: (9.0, 12.0)}
"""Distances of the walls, by that of the centres [radii]."""

Rates = tuple[float, float]


def page(work: Work) -> Page:
    """Rates at rest, and half a turn."""
    exact = {distance: rotation_in_strain(distance)[0] for distance in DISTANCES}
    found, coarse = rates_in_boxes(), rates(9.0, 3.0, size_body=0.8)
    run = work.run("as_shipped", "dumbbell_in_shear.toml")
    turned, (across, along) = angles(run.history), found[3.0, 9.0]
    at_rates = angle(across - along, turned[:, 0] * (across + along))
    text = ABOUT + table(
        ("distance of centres", "A", "B", "axis ratio", "period"), map(exact_row, *zip(*exact.items(), strict=True))
    )
    text += RATES + table(
        ("distance of centres", "walls at", "A", "A off", "B", "B off", "period", "period off"),
        (row(exact[key[0]], *key, *found[key]) for key in sorted(found)),
    )
    text += COARSE.format(across=coarse[0] / across - 1.0, along=coarse[1] / along - 1.0)
    text += TURN + table(("half a turn", "time"), half_turns(turned, found, exact[3.0]))
    text += f"\n\nThe angle is at most {np.abs(turned[:, 1] - at_rates).max():.3f} rad off what the rates say."
    text += f" The run took {run.cpu_seconds:.0f} s of CPU time."
    return Page("A dumb-bell in shear", text, {"": turn(turned, found[3.0, 9.0], exact[3.0])})


def rates_in_boxes() -> dict[tuple[float, float], Rates]:
    """A and B by the distances of centres and walls, and without walls, from the two larger boxes."""
    found = {(distance, half): rates(half, distance) for distance, halves in BOXES.items() for half in halves}
    for distance, halves in BOXES.items():
        pairs = zip(*(found[distance, half] for half in halves[-2:]), strict=True)
        across, along = (without_box(halves[-2:], pair) for pair in pairs)
        found[distance, np.inf] = across, along
    return found


def half_turns(turned: np.ndarray, found: dict[tuple[float, float], Rates], exact: float) -> Iterable[tuple[str, str]]:
    """Its time in the run, by the rates and in theory."""
    measured, by_rates = time_of(-np.pi, turned), np.pi / np.sqrt(np.prod(found[3.0, 9.0]))
    yield "simulated, walls at 9", f"{measured:.3f}"
    yield "by the rates in that box", f"{by_rates:.3f} ({measured / by_rates - 1.0:+.2%})"
    yield "by the rates without a box", f"{np.pi / np.sqrt(np.prod(found[3.0, np.inf])):.3f}"
    yield "exact, without a box", f"{period(exact) / 2:.3f}"


def turn(turned: np.ndarray, in_box: Rates, exact: float) -> Figure:
    """The angle over time."""
    across, along = in_box
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="time · shear rate", ylabel="angle from the flow [rad]")
    axes.plot(*turned.T, "o", mfc="none", ms=4, label="simulated, walls at 9 radii")
    times = np.linspace(0.0, turned[-1, 0], 300)
    axes.plot(times, angle(across - along, times * (across + along)), "-", label="by the rates in that box")
    axes.plot(times, angle(exact, times), "k--", label="exact, without a box")
    axes.legend()
    return figure


def exact_row(distance: float, r: float) -> tuple[str, ...]:
    """Of theory."""
    return f"{distance:g}", f"{(1 + r) / 2:.5f}", f"{(1 - r) / 2:.5f}", f"{axis_ratio(r):.4f}", f"{period(r):.3f}"


ABOUT = """Two equal balls of radius 1 on a rod that the fluid does not feel turn in the Stokes flow u = (y, 0, 0) as

    dφ/dt = -(A sin²φ + B cos²φ),   A + B = 1,   period 2π/√(A B),

φ their angle from the flow, like an ellipsoid of revolution of axis ratio √(A/B). A and B are exact here: Lamb's
solution about both balls, by least squares on their surfaces to 9 digits and more (`tests/support/two_spheres.py`). The
literature has 1.982 (Nir & Acrivos 1973, doi:10.1017/S0022112073001527) and 15.62 (Wakiya 1971) where they touch.

"""

RATES = """

## Rates at rest

From a moment of the pair along the flow, and one across it, free of force and torque, in cubes whose upper and lower
walls slide; the flow is given at both ends, and the sides let it slip. A + B = 1 by the cube's symmetry. The last row
of each distance is the value without a box, from the two larger ones and an effect that goes with the inverse cube of
the walls' distance.

"""

COARSE = """

With cells twice as large on the balls, 3 radii apart and with walls at 9, A changes by {across:+.2%} and B by
{along:+.2%}."""

TURN = """

## Half a turn

`scenes/dumbbell_in_shear.toml`, balls 3 radii apart, a step of 0.15; the mesh is made anew as they turn.

"""


def row(exact: float, distance: float, half: float, across: float, along: float) -> tuple[str, ...]:
    """One of `RATES`' table."""
    time = 2.0 * np.pi / np.sqrt(across * along)
    values = ((across, (1 + exact) / 2), (along, (1 - exact) / 2), (time, period(exact)))
    cells = [f"{distance:g}", f"{half:g}" if np.isfinite(half) else "none"]
    for value, reference in values:
        cells += [f"{value:.4g}", f"{value / reference - 1.0:+.2%}"]
    return tuple(cells)
