"""Case 2 of arXiv:2402.19093: a sphere falls in a closed box, and what the law's range does at the floor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import SETTLING_SPEED

from pages._slices import colours, slices
from rigidfluid.checks import check
from rigidfluid.post.reports.pictures import flow_picture

SCENE = "falling_sphere.toml"
COARSE = ["mesh.size_body=0.3", "time.step=0.02"]
RUNS = {
    "coarse": ("size_body .3, step .02", COARSE),
    "shipped": ("size_body .15, step .01", []),
    "damped": ("size_body .3, step .02; restitution_stokes 35", [*COARSE, "contact.restitution_stokes=35.0"]),
}
"""By folder: the heading, and what differs from the scene as shipped."""
SHOWN = (0.5, 1.0, 1.6, 3.0)
"""Moments of pictures [s]."""


@dataclass(frozen=True)
class Fall:
    """What a run says of the sphere [cm, s]."""

    run: Run

    @cached_property
    def bodies(self) -> dict[str, np.ndarray]:
        """The table of bodies."""
        return self.run.history.bodies

    @property
    def time(self) -> np.ndarray:
        """Of the states (s,)."""
        return self.bodies["time"]

    @property
    def speed(self) -> np.ndarray:
        """Downwards."""
        return -self.bodies["vy"]

    @property
    def gap(self) -> np.ndarray:
        """Between sphere and floor."""
        return self.bodies["y"] - self.radius

    @property
    def nearest(self) -> int:
        """The state in which the sphere first stops above the floor; the last if it does not."""
        stopped = np.flatnonzero((self.speed <= 0.0) & (self.gap < self.radius))
        return int(stopped[0]) if len(stopped) else len(self.gap) - 1

    @property
    def radius(self) -> float:
        """Of the sphere."""
        return float(self.run.scene.body[0].radius)

    @property
    def arrival(self) -> float:
        """The speed with which it first comes within the law's range."""
        until = slice(0, self.nearest + 1)
        return float(np.interp(-self.run.scene.contact.range, -self.gap[until], self.speed[until]))

    @property
    def stokes(self) -> float:
        """The Stokes number of the highest speed, with the solid's density."""
        scene = self.run.scene
        return float(scene.body[0].density * 2.0 * self.radius * self.speed.max() / (9.0 * scene.fluid.viscosity))

    @property
    def rebound(self) -> float:
        """How far the sphere comes back up."""
        return float(self.gap[self.nearest :].max() - self.gap[self.nearest])

    @cached_property
    def rest_gap(self) -> float:
        """At which the law bears the submerged weight, as the check says."""
        found = next(one.found for one in check(self.run.scene).findings if one.question == "rest")
        return float(found["rest_gap"])


def page(work: Work) -> Page:
    """Speeds and heights, touch-down with the paper's law and with one of short range, and pictures."""
    falls = {name: Fall(work.run(name, SCENE, overrides)) for name, (_, overrides) in RUNS.items()}
    columns = [figures(fall) for fall in falls.values()]
    rows = [(name, *(column[name] for column in columns)) for name in columns[0]]
    text = ABOUT.format(
        figures=table(("figure", *(heading for heading, _ in RUNS.values())), rows),
        highest=about_highest(falls["coarse"], falls["shipped"]),
        floor=about_floor(*falls.values()),
    )
    shipped = falls["shipped"].run
    pictures = {"": curves(falls), "_speed": flow_picture(slices(shipped, SHOWN), colours(shipped, "speed"))}
    return Page("A sphere falls in a closed box", text, pictures)


def figures(fall: Fall) -> dict[str, str]:
    """What the page tells of one run."""
    summary, steps, highest, near = fall.run.summary, fall.run.history.steps, int(np.argmax(fall.speed)), fall.nearest
    energy = summary["energy"]
    return {
        "highest speed [cm/s], at [s]": f"{fall.speed[highest]:.3f}, {fall.time[highest]:.2f}",
        "Reynolds number, with the fluid's density": f"{summary['reynolds']:.2f}",
        "speed where the law begins [cm/s]": f"{fall.arrival:.3f}",
        "first stop: gap [cm], at [s]": f"{fall.gap[near]:.4f}, {fall.time[near]:.2f}",
        "comes back up by [cm] (of the radius)": f"{fall.rebound:.4f} ({fall.rebound / fall.radius:.1%})",
        "gap at the end, and where the law bears the weight [cm]": f"{fall.gap[-1]:.4f}, {fall.rest_gap:.4f}",
        "speed at the end [cm/s]": f"{fall.speed[-1]:.1e}",
        "way sideways, largest [cm]": f"{np.hypot(fall.bodies['x'], fall.bodies['z']).max():.1e}",
        "energy created, lost, unaccounted for": ", ".join(
            f"{energy[name]:.2%}" for name in ("created", "lost", "unaccounted")
        ),
        "unknowns, first and most": f"{steps['unknowns'][0]:,.0f}, {steps['unknowns'].max():,.0f}",
        "steps, new meshes": f"{summary['steps']}, {summary['remeshes']}",
        "worst quality of a cell": f"{np.nanmin(steps['quality']):.2f}",
        "CPU time [s], memory [GB]": f"{fall.run.cpu_seconds:.0f}, {summary['peak_memory'] / 1e9:.1f}",
    }


def about_highest(coarse: Fall, shipped: Fall) -> str:
    """How the highest speed changes with the resolution, and what is measured in another box."""
    values = [float(fall.speed.max()) for fall in (coarse, shipped)]
    change = values[1] / values[0] - 1.0
    return (
        f"From the coarse to the finer setting the highest speed changes by {change:+.2%}. In ten Cate's box of "
        f"10 × 10 × 16 cm, with the same sphere and oil, it is {SETTLING_SPEED} cm/s; here it is "
        f"{values[1] / SETTLING_SPEED - 1.0:+.1%} off that, and the walls are nearer."
    )


def about_floor(coarse: Fall, shipped: Fall, damped: Fall) -> str:
    """What the law does at the floor, with and without a restitution by Stokes number."""
    law_range = shipped.run.scene.contact.range
    rests = "rests" if abs(shipped.speed[-1]) < 0.01 else "still moves"
    return (
        f"The paper's law reaches {law_range:g} cm, {law_range / shipped.radius:.2f} radii, from the floor, and loses "
        f"no energy. The sphere comes there with {shipped.arrival:.2f} cm/s, is stopped at a gap of "
        f"{shipped.gap[shipped.nearest]:.4f} cm and thrown back by {shipped.rebound:.4f} cm. At the end it {rests}, "
        f"{shipped.gap[-1]:.4f} cm above the floor; the law bears the weight at {shipped.rest_gap:.4f} cm.\n\n"
        f"Balls in liquids do not come back below Stokes numbers of ten; here it is {shipped.stokes:.1f}. With "
        f"`restitution_stokes = 35` the sphere comes back up by {damped.rebound:.4f} cm, and on the same mesh without "
        f"by {coarse.rebound:.4f} cm. At the end it is {damped.gap[-1]:.4f} cm above the floor, since where it rests "
        f"is up to range and ε alone. `scenes/ten_cate_e3.toml` has a law of so short a range that the film stops the "
        f"sphere, and a measured speed beside it."
    )


def curves(falls: dict[str, Fall]) -> Figure:
    """Speed and gap over time, the last of them near the floor."""
    figure = Figure(figsize=(9.0, 3.8), dpi=120, layout="constrained")
    speed, gap = figure.subplots(1, 2)
    for (name, fall), style in zip(falls.items(), ("--", "-", ":"), strict=True):
        speed.plot(fall.time, fall.speed, style, label=RUNS[name][0].replace("`", ""))
        gap.plot(fall.time, fall.gap, style)
    shipped = falls["shipped"]
    gap.axhline(shipped.run.scene.contact.range, color="grey", lw=0.8, label="range of the paper's law")
    gap.axhline(shipped.rest_gap, color="grey", lw=0.8, ls=":", label="where it bears the weight")
    speed.set(xlabel="time [s]", ylabel="speed downwards [cm/s]")
    gap.set(xlabel="time [s]", ylabel="gap to the floor [cm]", yscale="log")
    for axes in (speed, gap):
        axes.legend(fontsize=7)
        axes.grid(alpha=0.3)
    return figure


ABOUT = """`scenes/falling_sphere.toml`: a sphere of 1.5 cm in a box of 8 × 15 × 8 cm, let go at a height of 12.75 cm,
with the sphere, the oil and the contact law of the paper. The paper compares height and velocity with a published run
in a figure. No points of it are at hand here, so no agreement with it is claimed.

{figures}

{highest}

## At the floor

{floor}

## The flow

Speed in the plane of the motion, on the mesh as shipped.

![Speed](falling_sphere_speed.png)"""
