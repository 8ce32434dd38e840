"""An ellipse released at 45° in a channel, against the published path, angle and velocity."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import ELLIPSE_ANGLE, ELLIPSE_PATH, ELLIPSE_TERMINAL_SPEED, ELLIPSE_VELOCITY

from pages._flow import vorticity_pictures
from pages._one_knob import OneKnob

SCENE, LONG_AXIS, ALLOWED, ALLOWED_SPEED = "ellipse_xia.toml", 0.1, 0.02, 0.005
FINE = ["mesh.size_body=0.002", "mesh.size=0.02", "time.step=0.001"]
RUNS = {
    "coarse": ("size_body 0.008, step 0.004", ["mesh.size_body=0.008", "mesh.size=0.08", "time.step=0.004"]),
    "shipped": ("size_body 0.004, step 0.002", []),
    "fine": ("size_body 0.002, step 0.001", FINE),
}
"""By folder: the heading, and what differs from the scene as shipped."""
STEADY = (0.6, 1.4)
"""Heights between which the terminal speed is measured [cm]."""
MOMENTS = (0.05, 0.15, 0.25, 0.4, 0.6)


@dataclass(frozen=True)
class Fall:
    """What a run says of the ellipse; lengths over its long axis, angles over π."""

    run: Run

    @cached_property
    def bodies(self) -> dict[str, np.ndarray]:
        """The table of bodies."""
        return self.run.history.bodies

    @property
    def height(self) -> np.ndarray:
        """y/a."""
        return self.bodies["y"] / LONG_AXIS

    @property
    def aside(self) -> np.ndarray:
        """x/a."""
        return self.bodies["x"] / LONG_AXIS

    @property
    def angle(self) -> np.ndarray:
        """Of the long axis, over π."""
        return self.bodies["angle"] / np.pi

    def off(self, values: np.ndarray, curve: np.ndarray) -> np.ndarray:
        """Differences of ``values`` over time from points of a curve over height, where the run has been."""
        points = curve[curve[:, 0] >= self.height.min()]
        return np.interp(-points[:, 0], -self.height, values) - points[:, 1]

    @property
    def terminal_speed(self) -> float:
        """Mean over STEADY [cm/s]."""
        y = self.bodies["y"]
        return float(-self.bodies["vy"][(y > STEADY[0]) & (y < STEADY[1])].mean())

    @property
    def off_speed(self) -> float:
        """Of the terminal speed, relative."""
        return self.terminal_speed / ELLIPSE_TERMINAL_SPEED - 1.0


STUDY = OneKnob(
    SCENE,
    name="terminal speed [cm/s]",
    common=["time.end=1.5", "output.every=0.5"],
    finest=FINE,
    values={
        "mesh.size_body": (0.016, 0.008),
        "mesh.size": (0.08,),
        "time.step": (0.008, 0.004),
        "mesh.order": (1,),
        "mesh.remesh_every": (0.1,),
        "mesh.quality": (0.1, 0.4),
    },
    figure=lambda run: Fall(run).terminal_speed,
)


def page(work: Work) -> Page:
    """Three resolutions beside the published points, the flow, and the study."""
    falls = {name: Fall(work.run(name, SCENE, overrides)) for name, (_, overrides) in RUNS.items()}
    study = STUDY.measure(work)
    found = zip(*(figures(fall) for fall in falls.values()), strict=True)
    rows = [(*row[0][:2], *(value for _, _, value in row)) for row in found]
    text = "\n\n".join(
        (
            ABOUT,
            table(("figure", "published", *(heading for heading, _ in RUNS.values())), rows),
            judged(falls["fine"], falls["shipped"]),
            "![Vorticity](ellipse_xia_moments.png)",
            study.section("ellipse_xia"),
        )
    )
    pictures = {
        "": curves(falls),
        "_moments": vorticity_pictures(falls["shipped"].run, MOMENTS, height=0.8, scale=60.0),
        "_study": study.plot(),
    }
    return Page("An ellipse settles in a channel", text, pictures)


ABOUT = """`scenes/ellipse_xia.toml`: full axes .1 and .05 cm, density ratio 1.1, a channel of four long axes, released
at 45°. The points are those of Xia et al., J. Fluid Mech. 625 (2009) 249, as digitised by others, with a reading error
of 1-2 % of their axes. Lengths are in long axes a."""


def figures(fall: Fall) -> list[tuple[str, str, str]]:
    """Name, what is published, and what the run has."""
    aside, angle = fall.off(fall.aside, ELLIPSE_PATH), fall.off(fall.angle, ELLIPSE_ANGLE)
    summary = fall.run.summary
    energy = summary["energy"]
    return [
        ("largest distance of the path [a]", "0", f"{np.abs(aside).max():.4f}"),
        ("root mean square of it [a]", "0", f"{np.sqrt(np.mean(aside**2)):.4f}"),
        ("root mean square of the angle's difference [π]", "0", f"{np.sqrt(np.mean(angle**2)):.4f}"),
        ("farthest aside, x/a", f"{ELLIPSE_PATH[:, 1].min():.3f}", f"{fall.aside.min():.4f}"),
        ("terminal speed [cm/s]", f"{ELLIPSE_TERMINAL_SPEED}", f"{fall.terminal_speed:.4f} ({fall.off_speed:+.2%})"),
        ("created, lost [%]", "", f"{100 * energy['created']:.3f}, {100 * energy['lost']:.3f}"),
        ("unknowns at the end", "", f"{summary['unknowns']:,}"),
        ("steps, new meshes", "", f"{summary['steps']}, {summary['remeshes']}"),
        ("CPU time [s]", "", f"{fall.run.cpu_seconds:.0f}"),
    ]


def judged(fine: Fall, shipped: Fall) -> str:
    """What the finest run says, and how far it can be trusted."""

    def within(value: float, allowed: float) -> str:
        return "within" if abs(value) <= allowed else "not within"

    aside, angle = fine.off(fine.aside, ELLIPSE_PATH), fine.off(fine.angle, ELLIPSE_ANGLE)
    mean, rms = np.sqrt(np.mean(aside**2)), np.sqrt(np.mean(angle**2))
    change = abs(fine.terminal_speed / shipped.terminal_speed - 1.0)
    return (
        f"On the finest mesh the path is {within(mean, ALLOWED)} {ALLOWED} a of the published one in the mean, "
        f"{within(np.abs(aside).max(), ALLOWED)} it everywhere; the angle is {within(rms, ALLOWED)} {ALLOWED} π; the "
        f"terminal speed is {within(fine.off_speed, ALLOWED_SPEED)} {ALLOWED_SPEED:.1%} of {ELLIPSE_TERMINAL_SPEED} "
        f"cm/s. From the mesh and step as shipped to half of both that changes by {change:.3%}."
    )


def curves(falls: dict[str, Fall]) -> Figure:
    """Path and angle over height, velocity over time."""
    figure = Figure(figsize=(9.0, 4.6), dpi=120, layout="constrained")
    path, angle, velocity = figure.subplots(1, 3)
    for (name, fall), style in zip(falls.items(), (":", "--", "-"), strict=True):
        path.plot(fall.aside, fall.height, style, label=RUNS[name][0])
        angle.plot(fall.angle, fall.height, style)
        velocity.plot(fall.bodies["time"], fall.bodies["vy"], style)
    for axes, points in ((path, ELLIPSE_PATH[:, ::-1]), (angle, ELLIPSE_ANGLE[:, ::-1]), (velocity, ELLIPSE_VELOCITY)):
        axes.plot(*points.T, "o", color="k", markersize=4, mfc="none", label="Xia et al. 2009")
        axes.grid(alpha=0.3)
    path.legend(fontsize=7, loc="lower left")
    path.set(xlabel="x/a", ylabel="height y/a")
    angle.set(xlabel="angle of the long axis over π", ylabel="height y/a")
    velocity.set(xlabel="time [s]", ylabel="vertical velocity [cm/s]")
    return figure
