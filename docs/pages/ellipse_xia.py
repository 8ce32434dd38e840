"""An ellipse released at 45° in a channel, against the published path, angle and velocity."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import ELLIPSE_ANGLE, ELLIPSE_PATH, ELLIPSE_TERMINAL_SPEED, ELLIPSE_VELOCITY

import rigidfluid
from pages._flow import vorticity_pictures
from pages._one_knob import Measured, OneKnob

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
STEEP_START = 0.09
"""Until when the published velocity is too steep to be read within a few per cent [s]."""
HELD_SPEEDS = (1.27, 1.3)
"""Of the flow past the ellipse when it is held; the terminal speed lies between them [cm/s]."""


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
            about_speed(falls["fine"], {speed: held(work, speed) for speed in HELD_SPEEDS}),
            study.section("ellipse_xia"),
            about_angles(study),
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
        ("the same in the published figure, of its axes", "reading error .01-.02", f"{in_figure(fall):.4f}"),
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


def in_figure(fall: Fall) -> float:
    """Largest distance of a published point of the path from the run's, each axis over the range of the points."""
    reached = ELLIPSE_PATH[ELLIPSE_PATH[:, 0] >= fall.height.min()]
    axes = np.ptp(reached, axis=0)
    way = np.column_stack((fall.height, fall.aside))
    return float(max(np.linalg.norm((way - point) / axes, axis=1).min() for point in reached))


def held(work: Work, speed: float) -> float:
    """The fluid's force on the ellipse held broadside in the middle, in a steady flow as fast as the walls [dyn/cm]."""
    scene = work.scene(SCENE, [*FINE, "time.end=0.002", "output.every=0.002", "fluid.initial=steady"]).to_dict()
    moving = {"velocity": [0.0, speed]}
    scene["boundary"] = [
        {"on": "bottom", "type": "velocity", **moving},
        *({"on": side, "type": "wall", **moving} for side in ("left", "right")),
        {"on": "top", "type": "pressure", "pressure": 0.0},
    ]
    scene["body"][0] |= {"position": [0.2, 1.0], "angle": 0.0, "fixed": True}
    return float(work.run(f"held/{speed:g}", rigidfluid.scene_from_dict(scene)).history.bodies["fy"][-1])


def about_speed(fine: Fall, forces: dict[float, float]) -> str:
    """Where the difference in the terminal speed comes from, as far as can be told."""
    (slow, low), (fast, high) = forces.items()
    scene = fine.run.scene.to_dict()
    fluid, body = scene["fluid"], scene["body"][0]
    weight = (body["density"] - fluid["density"]) * np.pi * np.prod(body["semi_axes"]) * abs(fluid["gravity"][1])
    power = np.log(high / low) / np.log(fast / slow)
    expected = slow * (weight / low) ** (1.0 / power)
    time, published = ELLIPSE_VELOCITY[ELLIPSE_VELOCITY[:, 0] > STEEP_START].T
    ratios = published / np.interp(time, fine.bodies["time"], fine.bodies["vy"])
    heavier = (ELLIPSE_TERMINAL_SPEED / fine.terminal_speed) ** power - 1.0
    agree = "agree" if abs(expected / fine.terminal_speed - 1.0) < ALLOWED_SPEED else "do not agree"
    whole = "one factor for the whole curve" if ratios.std() < abs(ratios.mean() - 1.0) else "no one factor"
    return f"""\
## The terminal speed

The ellipse is held broadside in the middle, with the fluid ahead of it and the walls moving up: a steady flow, without
any motion of the mesh. Its force is {low:.5f} dyn/cm at {slow:g} cm/s and {high:.5f} at {fast:g}, so it grows as
speed to the power {power:.3f}, and bears the submerged weight of {weight:.5f} dyn/cm at {expected:.4f} cm/s. The
settling ellipse has {fine.terminal_speed:.4f} cm/s: both {agree} within {ALLOWED_SPEED:.1%}.

After {STEEP_START:g} s the published velocity is {ratios.mean():.4f} times the computed one at the same times, with a
standard deviation of {ratios.std():.4f} over {len(ratios)} points: {whole}. For the published speed the submerged
weight would have to be {heavier:+.1%} different. The reading error of the points is 1-2 % of the axis."""


def about_angles(study: Measured) -> str:
    """How far the angle is from that of the finest run, by setting."""
    finest = Fall(study.finest)
    rows = []
    for (key, value), run in study.runs.items():
        fall = Fall(run)
        off = fall.angle - np.interp(-fall.height, -finest.height, finest.angle)
        setting = f"`{key} = {value}`" if value else key
        rows.append((setting, f"{np.sqrt(np.mean(off**2)):.1e}", f"{run.cpu_seconds:.0f}"))
    head = ("setting", "angle: root mean square of its distance from the finest run at the same height [π]", "CPU [s]")
    return table(head, rows)


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
