"""Case 4 of arXiv:2402.19093: an ellipsoid falls in a flat box and turns, at two resolutions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from pages._slices import colours, slices
from rigidfluid.checks import check
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.post.reports.pictures import flow_picture, mesh_picture
from rigidfluid.post.reports.units import Units

SCENE, LONG = "falling_ellipsoid.toml", 1
"""The file, and which of the semi-axes is the long one."""
COARSE = ["mesh.size_body=0.05", "time.step=0.005"]
RUNS = {
    "coarse": ("size_body .05, step .005", COARSE),
    "shipped": ("size_body .025, step .0025", []),
}
"""By folder: the heading, and what differs from the scene as shipped."""
EPSILON = 3e-6
"""Of the paper's law [cm³/dyn]."""
PAPER = [*COARSE, f"contact.epsilon={EPSILON}", "body.0.position=[0.5,2.0,0.2]", "time.end=0.35", "mesh.refinements=3"]
"""With that, let go so low that it comes to the floor while it turns."""
UPRIGHT = {
    "upright_coarse": ("size_body .05", ["mesh.size_body=0.05"]),
    "upright_fine": ("size_body .035", ["mesh.size_body=0.035"]),
}
BALANCED = ["body.0.orientation=[1.0,0.0,0.0,0.0]", "time.step=0.005", "time.end=0.4"]
SHOWN, VISIBLE = (0.1, 0.18, 0.24, 0.32), 0.1
"""Moments of pictures [s], and the tilt from which on one that starts upright is said to turn."""
SIDES = (("left", 0, -1), ("right", 0, 1), ("bottom", 1, -1), ("top", 1, 1), ("back", 2, -1), ("front", 2, 1))
"""The walls: names, axes across them, and where they are."""


@dataclass(frozen=True)
class Fall:
    """What a run says of the ellipsoid [cm, s]; states s."""

    run: Run

    @cached_property
    def bodies(self) -> dict[str, np.ndarray]:
        """The table of bodies."""
        return self.run.history.bodies

    @property
    def time(self) -> FloatArray:
        """Of the states (s,)."""
        return np.asarray(self.bodies["time"])

    @cached_property
    def turns(self) -> FloatArray:
        """From the ellipsoid's frame to space (s, 3, 3)."""
        return rotation_matrices(np.stack([self.bodies[name] for name in ("qw", "qx", "qy", "qz")], axis=1))

    @property
    def tilt(self) -> FloatArray:
        """Of the long axis from the vertical, in the plane of the wide sides, whole turns kept (s,) [rad]."""
        axis = self.turns[:, :, LONG]
        return np.unwrap(np.arctan2(-axis[:, 0], axis[:, 1]), period=np.pi)

    @property
    def aslant(self) -> FloatArray:
        """Of the long axis out of that plane (s,) [rad]."""
        return np.arcsin(np.abs(self.turns[:, 2, LONG]))

    @cached_property
    def gaps(self) -> dict[str, FloatArray]:
        """Exact ones to the walls, by their names, (s,) each."""
        scene = self.run.scene.to_dict()
        corners = np.array([scene["domain"]["lower"], scene["domain"]["upper"]])
        reach = np.linalg.norm(self.turns * np.array(scene["body"][0]["semi_axes"]), axis=2)
        found = {}
        for name, axis, side in SIDES:
            wall = corners[(side + 1) // 2, axis]
            found[name] = side * (wall - self.bodies["xyz"[axis]]) - reach[:, axis]
        return found

    @property
    def beside(self) -> FloatArray:
        """The smaller of the gaps to the walls beside the plane of the motion (s,)."""
        return np.minimum(self.gaps["left"], self.gaps["right"])

    def when(self, reached: FloatArray) -> float:
        """The first time at which a condition (s,) holds; not a number without any."""
        return float(self.time[np.argmax(reached)]) if reached.any() else float("nan")

    @property
    def broadside(self) -> float:
        """When the long axis is horizontal for the first time."""
        return self.when(np.abs(self.tilt) >= np.pi / 2.0)

    @property
    def at_wall(self) -> int:
        """The state nearest to a wall at the side, before the floor is near."""
        falling = self.gaps["bottom"] > self.run.scene.contact.range
        return int(np.argmin(np.where(falling, self.beside, np.inf)))


def page(work: Work) -> Page:
    """Path, angle and speed, gaps, energies, what the paper's number and an upright start do, and pictures."""
    falls = {name: Fall(work.run(name, SCENE, overrides)) for name, (_, overrides) in RUNS.items()}
    paper = Fall(work.run("paper", SCENE, PAPER, may_stop=True))
    upright = {name: Fall(work.run(name, SCENE, [*BALANCED, *overrides])) for name, (_, overrides) in UPRIGHT.items()}
    columns = [figures(fall) for fall in falls.values()]
    rows = [(name, *(column[name] for column in columns)) for name in columns[0]]
    coarse, shipped = falls.values()
    text = "\n\n".join(
        (
            ABOUT,
            table(("figure", *(heading for heading, _ in RUNS.values())), rows),
            told(shipped),
            apart(coarse, shipped),
            about_paper(paper),
            UPRIGHT_START,
            table(("cells", "unknowns", "in the plane [s]", "across it [s]"), turning(upright)),
            PICTURES,
        )
    )
    shown = slices(shipped.run, SHOWN)
    turns, speed = (colours(shipped.run, quantity) for quantity in ("vorticity", "speed"))
    units = Units.told_in(shipped.run.summary["scene"])
    flows = {"_vorticity": flow_picture(shown, turns), "_mesh": mesh_picture(shown, speed)}
    pictures = {"": curves(falls)} | {name: units.put_into_labels(figure) for name, figure in flows.items()}
    return Page("An ellipsoid falls in a flat box", text, pictures)


def figures(fall: Fall) -> dict[str, str]:
    """What the page tells of one run."""
    bodies, summary, steps = fall.bodies, fall.run.summary, fall.run.history.steps
    energy, tilt, near = summary["energy"], np.abs(fall.tilt), fall.at_wall
    swung = int(np.argmax(tilt))
    least = {name: float(gaps.min()) for name, gaps in fall.gaps.items()}
    nearest = min(least, key=lambda name: least[name])
    return {
        "highest speed downwards [cm/s], at [s]": _at(fall, -bodies["vy"]),
        "Reynolds number, highest, with the fluid's density and the long axis": f"{summary['reynolds']:.0f}",
        "broadside for the first time at [s]": f"{fall.broadside:.3f}",
        "largest tilt [°], at [s]": f"{np.degrees(tilt[swung]):.1f}, {fall.time[swung]:.3f}",
        "farthest aside, x [cm], at [s]": _at(fall, bodies["x"]),
        "nearest to a wall at the side: gap [cm], at [s]": f"{fall.beside[near]:.4f}, {fall.time[near]:.3f}",
        "within the law's range of the floor from [s]": (
            f"{fall.when(fall.gaps['bottom'] < fall.run.scene.contact.range):.3f}"
        ),
        "smallest gap of all [cm], to": f"{least[nearest]:.4f}, {nearest}",
        "largest tilt out of the plane [°]": f"{np.degrees(fall.aslant.max()):.2f}",
        "largest way out of the plane [cm]": f"{np.abs(bodies['z'] - bodies['z'][0]).max():.4f}",
        "energy created, lost, unaccounted for": ", ".join(
            f"{energy[name]:.2%}" for name in ("created", "lost", "unaccounted")
        ),
        "unknowns, first and most": f"{steps['unknowns'][0]:,.0f}, {steps['unknowns'].max():,.0f}",
        "steps, rejected ones": f"{summary['steps']}, {summary['rejected_steps']}",
        "new meshes, and such that could not be made": f"{summary['remeshes']}, {summary['failed_remeshes']}",
        "worst quality of a cell": f"{np.nanmin(steps['quality']):.2f}",
        "CPU time [s], memory [GB]": f"{fall.run.cpu_seconds:.0f}, {summary['peak_memory'] / 1e9:.1f}",
    }


def _at(fall: Fall, values: FloatArray) -> str:
    largest = int(np.argmax(values))
    return f"{values[largest]:.3f}, {fall.time[largest]:.3f}"


def told(fall: Fall) -> str:
    """What happens, from the run's numbers."""
    scene, near = fall.run.scene, fall.at_wall
    tilt = np.degrees(np.abs(fall.tilt))
    touched = "within" if fall.beside[near] < scene.contact.range else "outside"
    end = "to the end" if fall.run.summary["status"] == "complete" else "no further than"
    overlap = "No surface touches another" if min(gap.min() for gap in fall.gaps.values()) > 0.0 else "Surfaces overlap"
    return (
        f"On the mesh as shipped the ellipsoid turns broadside in {fall.broadside:.3f} s, swings on to a tilt of "
        f"{tilt.max():.0f}° and glides aside. At {fall.time[near]:.3f} s it is nearest to the wall, at a gap of "
        f"{fall.beside[near]:.4f} cm, {touched} the law's range of {scene.contact.range:g} cm. The run goes {end} at "
        f"{fall.time[-1]:g} s. {overlap}."
    )


def apart(coarse: Fall, fine: Fall) -> str:
    """How far the two resolutions are from each other, before the wall and after it."""
    wall = min(fall.time[fall.at_wall] for fall in (coarse, fine))

    def off(name: str, until: float, after: float = 0.0) -> float:
        chosen = (coarse.time > after) & (coarse.time <= until)
        values = [fall.bodies.get(name, fall.tilt) for fall in (coarse, fine)]
        return float(np.abs(values[0] - np.interp(coarse.time, fine.time, values[1]))[chosen].max())

    end = float(min(coarse.time[-1], fine.time[-1]))
    return (
        f"Until the wall, {wall:.3f} s, the two resolutions differ by at most {off('x', wall):.4f} cm in x, "
        f"{off('y', wall):.3f} cm in height and {np.degrees(off('tilt', wall)):.1f}° in tilt; from there to {end:g} s "
        f"by {off('x', end, wall):.4f} cm, {off('y', end, wall):.3f} cm and {np.degrees(off('tilt', end, wall)):.0f}°."
    )


def about_paper(fall: Fall) -> str:
    """What the paper's ε does at the floor."""
    findings = {one.question: one.found for one in check(fall.run.scene).findings}
    share, law_range = findings["impact"]["barrier_over_impact"], fall.run.scene.contact.range
    floor, failed = fall.gaps["bottom"], fall.run.summary["failed_remeshes"]
    closing = float((floor[-4] - floor[-1]) / (fall.time[-1] - fall.time[-4]))
    if fall.run.summary["status"] == "complete":
        turned = "thrown back" if floor[np.argmin(floor) :].max() > law_range else "held"
        ends = f"is {turned}: the smallest gap is {floor.min():.4f} cm, at {fall.time[np.argmin(floor)]:.3f} s"
    else:
        meshes = f": {failed} new meshes for it could not be made" if failed else ""
        ends = (
            f"the run ends at {fall.time[-1]:.3f} s, at a gap of {floor[-1]:.2g} cm that still closes by {closing:.1f} "
            f"cm/s{meshes}. From a gap of {law_range / 3.0:.4f} cm on the law grows weaker"
        )
    return f"""\
## The law with the paper's number

The law's force vanishes at contact, and with ε = {EPSILON:g} cm³/dyn, as the paper has it, its barrier is {share:.1%}
of the energy with which the ellipsoid may come to the floor, as `rigidfluid check` reckons; the fluid has to take the
rest. Let go at a height of 2 cm, on the coarse mesh, it comes to the floor while it turns, and {ends}.

The shipped scene has ε = "auto", by which the impact that is expected ends at a quarter of the range."""


UPRIGHT_START = f"""\
## An upright start

The paper's ellipsoid starts exactly upright. So does the flow around it: nothing but the mesh's unevenness and rounding
can turn it. These start upright, and tilt by {VISIBLE:g} for the first time in and across the plane of the wide sides
at:"""


def turning(falls: dict[str, Fall]) -> list[tuple[str, ...]]:
    """When ellipsoids that start upright turn."""
    return [
        (
            UPRIGHT[name][0],
            f"{fall.run.summary['unknowns']:,}",
            _time(fall.when(np.abs(fall.tilt) >= VISIBLE)),
            _time(fall.when(fall.aslant >= VISIBLE)),
        )
        for name, fall in falls.items()
    ]


def _time(value: float) -> str:
    return f"{value:.3f}" if np.isfinite(value) else "not before the run ends"


PICTURES = """\
So the scene has a tilt of .1 at the start, in the plane in which there is room: what turns the ellipsoid is then known,
and resolutions can be compared.

## The flow

In the plane of the motion, through the ellipsoid's centre, on the mesh as shipped: vorticity, and speed with the cells
about the ellipsoid.

![Vorticity](falling_ellipsoid_vorticity.png)

![Speed and cells](falling_ellipsoid_mesh.png)"""


def curves(falls: dict[str, Fall]) -> Figure:
    """Path, tilt and speed over time, and gaps."""
    figure = Figure(figsize=(9.0, 6.4), dpi=120, layout="constrained")
    aside, tilt, speed, gap = figure.subplots(2, 2).ravel()
    for (name, fall), style in zip(falls.items(), ("--", "-"), strict=True):
        aside.plot(fall.time, fall.bodies["x"], style, color="C0", label=RUNS[name][0])
        tilt.plot(fall.time, np.degrees(np.abs(fall.tilt)), style, color="C0")
        speed.plot(fall.time, -fall.bodies["vy"], style, color="C0", label=f"down, {name}")
        speed.plot(fall.time, fall.bodies["vx"], style, color="C1", label=f"aside, {name}")
        gap.plot(fall.time, fall.beside, style, color="C0", label=f"side walls, {name}")
        gap.plot(fall.time, fall.gaps["bottom"], style, color="C1", label=f"floor, {name}")
    gap.axhline(next(iter(falls.values())).run.scene.contact.range, color="grey", ls=":", label="range")
    tilt.axhline(90.0, color="grey", ls=":")
    aside.set(xlabel="time [s]", ylabel="x of the centre [cm]")
    tilt.set(xlabel="time [s]", ylabel="tilt of the long axis [°]")
    speed.set(xlabel="time [s]", ylabel="velocity [cm/s]")
    gap.set(xlabel="time [s]", ylabel="gap [cm]", yscale="log", ylim=(0.005, 1.0))
    for axes in (aside, speed, gap):
        axes.legend(fontsize=7)
    for axes in (aside, tilt, speed, gap):
        axes.grid(alpha=0.3)
    return figure


ABOUT = """`scenes/falling_ellipsoid.toml`: full axes .4, .2 and .2 cm in a box of 1 × 8 × .4 cm, density ratio 1.25,
viscosity .01 g/(cm s), a long axis that starts .1 off the vertical. The paper compares the horizontal path with a
published one in a figure. No points of it are at hand here, so no agreement with it is claimed; the paper says that the
first contact with a wall is at about .45 s, from an upright start (see below)."""
