"""Steel spheres fall in four silicone oils and bounce, in the set-ups of measurements at other Stokes numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid.core.scene.scene import Scene

STEEL, GRAVITY = 7.8, 981.0
ROUGHNESS, DRY, DECAY = 2e-4, 0.97, 35.0
FALL, TALL, WIDE = 10.0, 24.0, 10.0
"""Gap under the sphere at the start, height of the box and half its width [R]."""
OVER = 1.05
"""Share of the speed at the start that the liquid, at rest then, takes by more than a steady drag."""


@dataclass(frozen=True)
class Case:
    """A measured fall: ``diameter`` [cm], ``density`` and ``viscosity`` of the oil [g, cm, s], Reynolds number of the
    measured speed before the impact, and the time after which the run ends [s]."""

    diameter: float
    density: float
    viscosity: float
    reynolds: float
    end: float

    @property
    def radius(self) -> float:
        """R [cm]."""
        return self.diameter / 2.0

    @property
    def measured_speed(self) -> float:
        """Speed before the impact [cm/s]."""
        return self.reynolds * self.viscosity / (self.density * self.diameter)

    @property
    def measured_stokes(self) -> float:
        """St = ρ_s D v/(9μ), without the added mass, as it is given for the measurement."""
        return STEEL * self.diameter * self.measured_speed / (9.0 * self.viscosity)

    @property
    def thrown(self) -> float:
        """Speed at the start: OVER times that by which a steady drag brings the sphere to the floor at the measured one
        [cm/s]."""
        squared, steps = self.measured_speed**2, 1000
        for _ in range(steps):
            squared -= 2.0 * self._acceleration(float(np.sqrt(squared))) * FALL * self.radius / steps
        return round(OVER * float(np.sqrt(squared)), 1)

    @property
    def settled(self) -> float:
        """Speed at which that drag balances the weight [cm/s]."""
        low, high = 0.0, 10.0 * self.measured_speed
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._acceleration(middle) > 0.0 else (low, middle)
        return low

    def _acceleration(self, speed: float) -> float:
        """Weight less drag by the usual fit, over the mass with the added mass [cm/s²]."""
        reynolds = self.density * speed * self.diameter / self.viscosity
        drag = 24.0 / reynolds * (1.0 + 0.15 * reynolds**0.687)
        force = (STEEL - self.density) * GRAVITY - 0.75 * drag * self.density * speed**2 / self.diameter
        return force / (STEEL + 0.5 * self.density)


CASES = {
    100: Case(0.4, 0.953, 0.2, 110.0, 0.09),
    152: Case(0.3, 0.935, 0.1, 164.0, 0.078),
    192: Case(0.6, 0.953, 0.2, 212.0, 0.115),
    742: Case(0.5, 0.92, 0.05, 788.0, 0.125),
}
"""By the Stokes number that is given for the measurement."""
RUNS = {
    "st100": (100, 0.4, 1.0),
    "st152": (152, 0.4, 1.0),
    "st192": (192, 0.4, 1.0),
    "st742": (742, 0.4, 1.0),
}
"""By folder: the case, cells at the sphere [R], and the step [R/(12 v)]."""
OTHER = {"st100_half": (100, 0.4, 0.5), "st100_fine": (100, 0.25, 1.0)}
"""The same of runs that end when the sphere has left the floor, at LEFT [s]."""
LEFT = 0.045


def scene(label: str) -> Scene:
    """The sphere above the floor, at the speed of `Case.thrown`."""
    name, cells, step = (RUNS | OTHER)[label]
    case = CASES[name]
    end, radius = case.end if label in RUNS else LEFT, case.radius
    high, wide = round(TALL * radius, 6), round(WIDE * radius, 6)
    return rigidfluid.scene_from_dict(
        {
            "scene": {
                "name": f"steel_st{name}",
                "dimension": 3,
                "units": {"length": "cm", "time": "s", "mass": "g"},
            },
            "fluid": {"density": case.density, "viscosity": case.viscosity, "gravity": [0.0, -GRAVITY, 0.0]},
            "domain": {"lower": [-wide, 0.0, -wide], "upper": [wide, high, wide]},
            "boundary": [{"on": side, "type": "slip"} for side in ("left", "right", "front", "back")],
            "body": [
                {
                    "name": "sphere",
                    "type": "sphere",
                    "radius": radius,
                    "density": STEEL,
                    "position": [0.0, round((FALL + 1.0) * radius, 6), 0.0],
                    "velocity": [0.0, -case.thrown, 0.0],
                }
            ],
            "contact": {
                "law": "normal",
                "range": round(radius / 10.0, 6),
                "epsilon": "auto",
                "restitution": DRY,
                "roughness": ROUGHNESS,
            },
            "mesh": {"size": round(5.0 * radius, 6), "size_body": round(cells * radius, 6)},
            "time": {"end": end, "step": float(f"{step * radius / (12.0 * case.measured_speed):.3g}")},
            "output": {"every": end},
        }
    )


@dataclass(frozen=True)
class Rebound:
    """Figures of a run [cm, s]."""

    label: str
    run: Run

    @property
    def case(self) -> Case:
        """Measured fall."""
        return CASES[(RUNS | OTHER)[self.label][0]]

    @cached_property
    def bodies(self) -> dict[str, np.ndarray]:
        """The table of bodies."""
        return self.run.history.bodies

    @cached_property
    def gap(self) -> np.ndarray:
        """Gaps between sphere and floor (s,)."""
        return self.bodies["y"] - self.case.radius

    @cached_property
    def impact(self) -> int:
        """The row of the first turn."""
        return int(np.argmax(self.bodies["vy"] > 0.0))

    @cached_property
    def top(self) -> int:
        """The row of the greatest height after it."""
        return self.impact + int(np.argmax(self.gap[self.impact :]))

    @property
    def height(self) -> float:
        """Height of the rebound, over the diameter."""
        return float(self.gap[self.top] / self.case.diameter)

    @property
    def rise(self) -> float:
        """Time from the impact to the top."""
        return float(self.bodies["time"][self.top] - self.bodies["time"][self.impact])

    @cached_property
    def speed(self) -> float:
        """Speed downwards at a gap of R/2."""
        way = slice(self.impact - 1, None, -1)
        return -float(np.interp(0.5 * self.case.radius, self.gap[way], self.bodies["vy"][way]))

    @property
    def stokes(self) -> float:
        """St = ρ_s D v/(9μ), without the added mass."""
        return STEEL * self.case.diameter * self.speed / (9.0 * self.case.viscosity)

    @property
    def whole_stokes(self) -> float:
        """St = (ρ_s + ρ_f/2) D v/(9μ)."""
        return self.stokes * (1.0 + 0.5 * self.case.density / STEEL)

    @property
    def restitution(self) -> float:
        """Highest speed upwards beyond range, over that before."""
        away = self.bodies["vy"][self.impact :][self.gap[self.impact :] > 0.1 * self.case.radius]
        return float(away.max()) / self.speed

    @property
    def later(self) -> float:
        """Speed upwards at a gap of R/2, over that before."""
        way = slice(self.impact, self.top + 1)
        return float(np.interp(0.5 * self.case.radius, self.gap[way], self.bodies["vy"][way])) / self.speed

    @property
    def aside(self) -> float:
        """Greatest displacement sideways [R]."""
        return float(np.hypot(self.bodies["x"], self.bodies["z"]).max()) / self.case.radius

    @property
    def fitted(self) -> float:
        """Speed at the floor of a parabola through the first third of the rise, over that before."""
        start = float(
            np.interp(0.0, self.bodies["vy"][: self.impact + 1][-2:], self.bodies["time"][: self.impact + 1][-2:])
        )
        time = self.bodies["time"][self.impact : self.top] - start
        early = (self.gap[self.impact : self.top] > 0.1 * self.case.radius) & (time < time[-1] / 3.0)
        return float(np.polyfit(time[early], self.gap[self.impact : self.top][early], 2)[1]) / self.speed

    @property
    def row(self) -> tuple[str, ...]:
        """Figures of the run."""
        energy = self.run.summary["energy"]
        return (
            str(RUNS[self.label][0]),
            f"{self.speed:.1f} ({self.speed / self.case.measured_speed - 1.0:+.1%})",
            f"{self.stokes:.0f}",
            f"{self.restitution:.3f}",
            f"{self.fitted:.3f}",
            f"{DRY * legendre(self.whole_stokes):.3f}",
            f"{DRY * joseph(self.whole_stokes):.3f}",
            f"{self.height:.2f}",
            f"{self.rise:.4f}",
            f"{100.0 * energy['created']:.2f}, {100.0 * energy['lost']:.2f}",
            f"{self.run.cpu_seconds:.0f}",
        )


def legendre(stokes: float) -> float:
    """Fit of Legendre, Daniel and Guiraud to measurements, over the dry restitution."""
    return float(np.exp(-DECAY / stokes))


def joseph(stokes: float) -> float:
    """Fit to the measurements of Joseph, Zenit, Hunt and Rosenwinkel."""
    return float(max(1.0 - 8.65 * stokes**-0.75, 0.0))


CASES_HEAD = ("St given", "Re", "D [cm]", "density of the oil [g/cm³]", "viscosity [g/(cm s)]", "v of these Re [cm/s]")
CASES_HEAD += ("settled by the fit [cm/s]", "thrown at [cm/s]")
HEAD = ("St given", "v at a gap of R/2 [cm/s] (off the measured)", "St", "e", "e by a parabola", ".97 exp(-35/St)")
HEAD += (".97 (1 - 8.65 St^-.75)", "height over D", "top after the impact [s]", "created, lost [%]", "CPU time [s]")
OTHER_HEAD = (
    "cells at the sphere [R]",
    "step [R/v]",
    "v at a gap of R/2 [cm/s]",
    "e",
    "speed at a gap of R/2 after, over v",
)
OTHER_HEAD += ("CPU time [s]",)


def page(work: Work) -> Page:
    """Speeds, restitutions and heights of the rebounds."""
    found = {label: Rebound(label, work.run(label, scene(label))) for label in RUNS | OTHER}
    main = {label: found[label] for label in RUNS}
    text = ABOUT.format(
        cases=table(CASES_HEAD, [_case(name, CASES[name]) for name, _, _ in RUNS.values()]),
        figures=table(HEAD, [one.row for one in main.values()]),
        other=table(OTHER_HEAD, [_other(found[label]) for label in ("st100", *OTHER)]),
        slower=_between([one.speed / one.case.measured_speed - 1.0 for one in main.values()], "{:+.0%}"),
        above=_between([one.fitted - DRY * legendre(one.whole_stokes) for one in main.values()], "{:+.2f}"),
        aside=f"{max(one.aside for one in main.values()):.2g}",
    )
    return Page("Rebounds after falls at Stokes numbers from 100 to 742", text, {"": picture(main)})


def _case(name: int, case: Case) -> tuple[str, ...]:
    return (
        str(name),
        f"{case.reynolds:g}",
        f"{case.diameter:g}",
        f"{case.density:g}",
        f"{case.viscosity:g}",
        f"{case.measured_speed:.1f}",
        f"{case.settled:.1f}",
        f"{case.thrown:.1f}",
    )


def _other(one: Rebound) -> tuple[str, ...]:
    _, cells, step = (RUNS | OTHER)[one.label]
    return (
        f"{cells:g}",
        f"1/{12.0 / step:g}",
        f"{one.speed:.2f}",
        f"{one.restitution:.3f}",
        f"{one.later:.3f}",
        f"{one.run.cpu_seconds:.0f}",
    )


def _between(values: list[float], form: str) -> str:
    """Smallest and largest."""
    return " to ".join(form.format(end(values)) for end in (min, max))


def picture(found: dict[str, Rebound]) -> Figure:
    """Gap over the time since the impact, and restitution over the Stokes number."""
    figure = Figure(figsize=(9.5, 4.2), dpi=120, layout="constrained")
    left, right = figure.subplots(1, 2)
    for label, one in found.items():
        time = one.bodies["time"] - one.bodies["time"][one.impact]
        left.plot(time, one.gap / one.case.diameter, lw=1.2, label=f"St {RUNS[label][0]}")
        left.plot([one.rise], [one.height], "k+")
    left.set(xlim=(-0.03, 0.1), ylim=(0.0, None), xlabel="time after the impact [s]", ylabel="gap over D")
    left.legend(fontsize=8)
    stokes = np.geomspace(40.0, 1500.0, 200)
    right.plot(stokes, [DRY * legendre(st) for st in stokes], "k-", lw=1.0, label=".97 exp(-35/St)")
    right.plot(stokes, [DRY * joseph(st) for st in stokes], "k--", lw=1.0, label=".97 (1 - 8.65 St^-.75)")
    for mark, name, label in (("o", "restitution", "highest speed away"), ("s", "fitted", "by a parabola")):
        points = [(one.whole_stokes, getattr(one, name)) for one in found.values()]
        right.plot(*zip(*points, strict=True), mark, label=label)
    right.set(
        xscale="log", xlim=(40.0, 1500.0), ylim=(0.3, 1.0), xlabel="Stokes number", ylabel="effective restitution"
    )
    right.legend(fontsize=8)
    return figure


ABOUT = """Steel spheres (density 7.8) fall in silicone oils and bounce, in the set-ups of Gondret, Lance and Petit,
Phys. Fluids 14 (2002) 643, doi:10.1063/1.1427920, with which Rettinger and Rüde compared (arXiv:2003.01490; as in the
inputs of waLBerla, `inputSphereWallCollision.dat`). [The steel sphere in oil](steel_rebound.md) is another of these,
at St 27. The Stokes number is ρ_s D v/(9μ), without the added mass, as it is given for the measurements.

{cases}

Not all had settled in the measurement: by the usual fit to drag the last two would fall faster in the end. So a
sphere is thrown from a gap of 10 R, at the speed from which a steady drag by this fit and the added mass lead to the
measured one at the floor. The liquid is at rest then. Its drag on a sphere that was just thrown is larger, and
spheres arrive slower than measured, by {slower}.

All runs have the setting of [the throws](rebound_over_stokes.md): law `normal`, restitution .97, `roughness` 2 µm,
range R/10, `epsilon = "auto"`, cells of .4 R at the sphere and steps in which it moves R/12. The box is 20 R wide,
with slip at its sides, and 24 R high. Nothing is changed from case to case.

{figures}

e is the highest speed upwards beyond range over v. After the impact the sphere slows down at first much faster than
by weight and steady drag, in liquid that still follows it down, so that e depends on where it is read. A parabola
through the first third of the rise, where a camera would see it, gives the next column. The two fits to measurements
(Legendre, Daniel and Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527; and the one often given for
Joseph, Zenit, Hunt and Rosenwinkel, J. Fluid Mech. 433 (2001) 329, doi:10.1017/S0022112001003470) have the St with
the added mass here. The parabola's e is {above} off the first. That they are below is known from [the
throws](rebound_over_stokes.md), where the measurement at St 27 lies above them too.

**Heights are no comparison yet.** Of the measured heights and times of these cases no numbers were at hand; the table
says what `rigidfluid` gives, so that who has the curves can compare. The roughness of 2 µm fits the height at St 27,
and is no measured one.

## Cells and steps

Runs that end when the sphere has left the floor:

{other}

Other cases were not repeated. Cells of .4 R are far from resolving the boundary layer at the larger St, and
`rigidfluid` warns of it; [settling spheres](settling_spheres.md) with cells of .32 R have speeds within 1 % of the
measured at Re 280 and 360. Beyond Re 280 wakes are unsteady. These spheres move sideways by {aside} R at most, too
briefly for that to grow."""
