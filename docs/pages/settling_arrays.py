"""Speed of spheres that settle as a simple cubic array, beside published drags and speeds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import SETTLING_ARRAY, SPHERE_ARRAY

from pages.periodic_arrays import ARRAYS

ALLOWED = 0.005
DENSITY, FLUID = 1.1, 0.1
PAIRS = ("left", "bottom", "back")
HELD = ", ".join(f'{{on = "{side}", type = "periodic", flux = 0.0}}' for side in PAIRS)
FALLS = [
    "body.0.fixed=false",
    f"body.0.density={DENSITY}",
    f"fluid.density={FLUID}",
    f'boundary=[{{on = "all", type = "periodic"}}, {HELD}]',
    "time.end=0.1",
    "time.step=0.02",
    "output.every=0.1",
]
"""Settings by which the sphere of scenes/periodic_array.toml is free, and the flux zero through all sides."""


def page(work: Work) -> Page:
    """Speeds in all arrays."""
    runs = {share: work.run(f"{share:g}", "periodic_array.toml", _overrides(share)) for share in SPHERE_ARRAY}
    speeds = {share: float(-run.history.bodies["vx"][-1]) for share, run in runs.items()}
    off = {share: speed * SPHERE_ARRAY[share] - 1.0 for share, speed in speeds.items()}
    head = ("share", "by published drag", "found", "off", "unknowns", "CPU time")
    worst = max(map(abs, off.values()))
    text = ABOUT.format(
        rows=table(head, [_told(share, speeds[share], off[share], run) for share, run in runs.items()]),
        points=table(
            ("share", "Sierou and Brady", "1 - 1.7601 φ^(1/3) + φ"),
            [(f"{at:g}", f"{speed:g}", f"{_without_higher_moments(at):.3f}") for at, speed in SETTLING_ARRAY.items()],
        ),
        apart=f"{max(abs(_without_higher_moments(at) - speed) for at, speed in SETTLING_ARRAY.items()):.3f}",
        worst=f"{worst:.2%}",
        judged="within" if worst <= ALLOWED else "not within",
        allowed=f"{ALLOWED:.1%}",
        flux=f"{max(np.abs(run.history.driving['flux']).max() for run in runs.values()):.0e}",
        change=f"{max(map(_last_change, runs.values())):.1%}",
    )
    return Page("Settling arrays", text, {"": _figure(speeds)})


def _overrides(share: float) -> list[str]:
    """Settings of an array in which a sphere alone would settle with a speed of 1."""
    array = ARRAYS["spheres"]
    gravity = 6.0 * np.pi * array.radius(share) / ((DENSITY - FLUID) * share)
    return [*array.overrides(share), *FALLS, f"fluid.gravity=[{-gravity}, 0.0, 0.0]"]


def _without_higher_moments(share: float) -> float:
    """Speed of spheres of which only the forces and their extent make a flow."""
    return 1.0 - 1.7601 * float(np.cbrt(share)) + share


def _last_change(run: Run) -> float:
    """Relative change of the speed in the last step."""
    before, last = run.history.bodies["vx"][-2:]
    return abs(float(before / last) - 1.0)


def _told(share: float, speed: float, off: float, run: Run) -> tuple[str, ...]:
    found = (f"{share:g}", f"{1.0 / SPHERE_ARRAY[share]:.4f}", f"{speed:.4f}", f"{off:+.2%}")
    return (*found, str(run.summary["unknowns"]), f"{run.cpu_seconds:.0f} s")


def _figure(speeds: Mapping[float, float]) -> Figure:
    figure = Figure(figsize=(7.0, 3.6), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="share of the volume", ylabel="speed over that of a sphere alone")
    published = {share: 1.0 / drag for share, drag in SPHERE_ARRAY.items()}
    axes.plot(list(published), list(published.values()), "k-", linewidth=0.8, label="drag of Zick and Homsy 1982")
    axes.plot(list(speeds), list(speeds.values()), "o", label="found")
    axes.plot(list(SETTLING_ARRAY), list(SETTLING_ARRAY.values()), "x", label="Sierou and Brady 2001, digitised")
    shares = np.linspace(0.0, max(SETTLING_ARRAY), 100)
    axes.plot(shares, [_without_higher_moments(at) for at in shares], "k:", linewidth=0.8, label="up to stresslets")
    axes.set_ylim(0.0, None)
    axes.legend(frameon=False)
    return figure


ABOUT = """`scenes/periodic_array.toml` as a simple cubic array of spheres with the settings of the runs: the sphere is
free and falls in Stokes flow. All sides are periodic, and the flux of fluid and spheres through each of them is held at
zero. Speeds are over that of a sphere alone. As the flow of the array that is held, seen from its spheres, is the same,
the speed is 1/K by the drag factors K of Zick and Homsy (J. Fluid Mech. 115 (1982) 13, table 2, of three or four
digits).

{rows}

The worst is {worst} off, {judged} {allowed}; fluxes are at most {flux}, and speeds change by at most {change} in the
last step. The spheres have a mass, and reach their speed within some of the steps of .02.

Sierou and Brady (J. Fluid Mech. 448 (2001) 115, figure 9, digitised with an error of .01) have

{points}

In dilute arrays these are the same within the error of reading; in dense ones they are above the speed by Zick and
Homsy's drag, with which the speeds found here agree. The last column is the expansion of Hasimoto (J. Fluid Mech. 5
(1959) 317, doi:10.1017/S0022112059000222) before its term of -1.5593 φ², the first one by moments higher than
stresslets, which these spheres have none of by symmetry. Stokesian dynamics stops at stresslets, and the points lie
within {apart} of that column. So the difference is what that method leaves out."""
