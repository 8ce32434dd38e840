"""Spheres that settle far from walls, in a mesh that goes with them, against measured speeds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid.core.scene.scene import Scene

TIMES = (2.0, 5.0, 8.0, 12.0, 16.0)


@dataclass(frozen=True)
class Sphere:
    """One of the measured spheres: its ``reynolds`` number [1], the ``density`` of a sphere [ρ], and the ``settled``
    speed measured [√(g D)]; speeds ``then`` were measured at TIMES; the box is ``high`` [D]."""

    reynolds: int
    density: float
    settled: float
    then: tuple[float, ...]
    high: float

    @property
    def viscosity(self) -> float:
        """Viscosity with which the measured speed has the Reynolds number [ρ √(g D³)]."""
        return self.settled / self.reynolds


SPHERES = {
    "re41": Sphere(41, 2.56, 1.057, (0.504, 0.890, 1.009, 1.049, 1.061), 60.0),
    "re280": Sphere(280, 7.71, 3.559, (1.298, 2.539, 3.113, 3.397, 3.489), 110.0),
    "re360": Sphere(360, 2.56, 1.790, (0.744, 1.427, 1.632, 1.712, 1.755), 80.0),
}
RUNS = {
    "re41_coarse": ("re41", 0.16, 2.5, 0.2),
    "re41_half": ("re41", 0.16, 2.5, 0.1),
    "re41_fine": ("re41", 0.08, 1.5, 0.2),
    "re280_coarse": ("re280", 0.16, 2.5, 0.1),
    "re280_fine": ("re280", 0.1, 2.0, 0.1),
    "re360_coarse": ("re360", 0.16, 2.5, 0.1),
}
"""By folder: the sphere, cells at it and far from it [D], and the step [√(D/g)]."""
END = 20.0
SIDES = ("xmin", "xmax", "ymin", "ymax")


def scene(label: str) -> Scene:
    """The sphere at rest in a box of ten by ten diameters, meshed from five ahead of it to ten behind it."""
    name, size_body, size, step = RUNS[label]
    sphere = SPHERES[name]
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": f"settling_sphere_{name}", "dimension": 3},
            "fluid": {"density": 1.0, "viscosity": sphere.viscosity, "gravity": [0.0, 0.0, -1.0]},
            "domain": {
                "lower": [-5.0, -5.0, 0.0],
                "upper": [5.0, 5.0, sphere.high],
                "window": {"follow": "sphere", "direction": "-z", "ahead": 5.0, "behind": 10.0},
            },
            "boundary": [{"on": side, "type": "slip"} for side in SIDES],
            "body": [
                {
                    "name": "sphere",
                    "type": "sphere",
                    "radius": 0.5,
                    "density": sphere.density,
                    "position": [0.0, 0.0, sphere.high - 12.0],
                }
            ],
            "mesh": {"size": size, "size_body": size_body, "growth": 0.3},
            "time": {"end": END, "step": step},
            "output": {"every": 2.0},
        }
    )


def page(work: Work) -> Page:
    """Speeds beside the measured ones."""
    found = {label: Settling(label, work.run(label, scene(label))) for label in RUNS}
    text = ABOUT.format(
        cases=table(CASES, [_case(sphere) for sphere in SPHERES.values()]),
        figures=table(HEAD, [one.row for one in found.values()]),
        changes=" ".join(filter(None, (_changes(found, name) for name in SPHERES))),
        measured=table(("Re", *(f"at {time:g}" for time in TIMES)), [_then(sphere) for sphere in SPHERES.values()]),
    )
    return Page("Spheres settle far from walls", text, {"": picture(found)})


@dataclass(frozen=True)
class Settling:
    """A run and its sphere."""

    label: str
    run: Run

    @property
    def sphere(self) -> Sphere:
        """Measured sphere."""
        return SPHERES[RUNS[self.label][0]]

    @property
    def time(self) -> np.ndarray:
        """Times (s,) [√(D/g)]."""
        return np.asarray(self.run.history.bodies["time"])

    @property
    def speed(self) -> np.ndarray:
        """Downward speeds (s,) [√(g D)]."""
        return np.asarray(-self.run.history.bodies["vz"])

    @property
    def settled(self) -> float:
        """Mean speed in the last fifth of the time [√(g D)]."""
        late = self.time > 0.8 * END
        return float(np.trapezoid(self.speed[late], self.time[late]) / np.ptp(self.time[late]))

    @property
    def row(self) -> tuple[str, ...]:
        """Figures of the run."""
        _, size_body, size, step = RUNS[self.label]
        bodies = self.run.history.bodies
        return (
            str(self.sphere.reynolds),
            f"{size_body:g}, {size:g}",
            f"{step:g}",
            *(f"{np.interp(time, self.time, self.speed):.3f}" for time in TIMES),
            f"{self.settled:.4f} ({self.settled / self.sphere.settled - 1.0:+.1%})",
            f"{self.settled / self.sphere.viscosity:.0f}",
            f"{float(np.hypot(bodies['x'], bodies['y']).max()):.4f}",
            f"{self.run.cpu_seconds:.0f}",
        )


CASES = ("Re", "density of the sphere [ρ]", "viscosity [ρ √(g D³)]", "settled speed measured [√(gD)]", "by the fit")
HEAD = ("Re", "cells at the sphere, far [D]", "step [√(D/g)]", *(f"at {time:g}" for time in TIMES))
HEAD += ("settled (off the measured)", "Re", "moved aside [D]", "CPU time [s]")


def _case(sphere: Sphere) -> tuple[str, ...]:
    return (
        str(sphere.reynolds),
        f"{sphere.density:g}",
        f"{sphere.viscosity:.5f}",
        f"{sphere.settled:g}",
        f"{fitted_speed(sphere):.3f}",
    )


def _then(sphere: Sphere) -> tuple[str, ...]:
    return (str(sphere.reynolds), *(f"{speed:.3f}" for speed in sphere.then))


def fitted_speed(sphere: Sphere) -> float:
    """Settled speed by the usual fit to measured drag, C_D = 24/Re (1 + .15 Re^.687) [√(g D)]."""
    speed = sphere.settled
    for _ in range(50):
        reynolds = speed / sphere.viscosity
        drag = 24.0 / reynolds * (1.0 + 0.15 * reynolds**0.687)
        speed = float(np.sqrt(4.0 / 3.0 * (sphere.density - 1.0) / drag))
    return speed


def _changes(found: dict[str, Settling], name: str) -> str:
    """A sentence on what mesh and step change."""
    coarse = found[f"{name}_coarse"].settled
    said = [
        f"by {abs(found[other].settled / coarse - 1.0):.2%} with {words}"
        for other, words in ((f"{name}_fine", "the finer cells"), (f"{name}_half", "steps of half the length"))
        if other in found
    ]
    return f"At Re {SPHERES[name].reynolds} the settled speed changes {' and '.join(said)}." if said else ""


def picture(found: dict[str, Settling]) -> Figure:
    """Speed over time."""
    figure = Figure(figsize=(7.0, 4.5), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="time [√(D/g)]", ylabel="speed [√(gD)]")
    for colour, (name, sphere) in enumerate(SPHERES.items()):
        for kind, style in (("coarse", "-"), ("fine", "--")):
            if one := found.get(f"{name}_{kind}"):
                label = f"Re {sphere.reynolds}, cells {RUNS[one.label][1]:g} D"
                axes.plot(one.time, one.speed, style, color=f"C{colour}", lw=1.0, label=label)
        axes.plot(TIMES, sphere.then, "o", color=f"C{colour}", ms=4.0)
        axes.axhline(sphere.settled, color=f"C{colour}", ls=":", lw=1.0)
    axes.plot([], [], "ko", ms=4.0, label="measured")
    axes.plot([], [], "k:", lw=1.0, label="measured, settled")
    axes.set(xlim=(0.0, END), ylim=(0.0, 4.2))
    axes.legend(fontsize=8)
    return figure


ABOUT = """Spheres start from rest and settle at Reynolds numbers of 41, 280 and 360. Mordant and Pinton measured their
speed, Eur. Phys. J. B 18 (2000) 343, doi:10.1007/PL00011074. Lengths are in diameters D, times in √(D/g). The viscosity
is the one with which the measured settled speed has its Reynolds number. The box is 10 D wide, with slip at its sides.
The mesh is a window, from 5 D ahead of the sphere to 10 D behind it, which goes with it.

{cases}

The fit is the usual one to measured drag, C_D = 24/Re (1 + .15 Re^.687).

{figures}

The settled speed is the mean from a time of 16 to 20. Measured, as read from the curves that Uhlmann shows (J. Comput.
Phys. 209 (2005) 448, doi:10.1016/j.jcp.2005.03.017); reading has errors of 1 to 2 %:

{measured}

{changes} At Re 360 neither was varied, at Re 280 not the step, and nowhere the box. Both leave the vertical: the
wake of a sphere that settles loses its symmetry at Reynolds numbers above some 200 (Jenny, Dušek and Bouchet, J.
Fluid Mech. 508 (2004) 201, doi:10.1017/S0022112004009164). At Re 280 the sphere of the coarser cells ends near a
side of the box. With cells of .16 D the boundary layer has about half a cell across, and `rigidfluid` warns of it.

Nothing here was fitted."""
