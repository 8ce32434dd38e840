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
        """Speed at the start by which a steady drag brings the sphere to the floor at the measured speed [cm/s]."""
        squared, steps = self.measured_speed**2, 1000
        for _ in range(steps):
            squared -= 2.0 * self._acceleration(float(np.sqrt(squared))) * FALL * self.radius / steps
        return round(float(np.sqrt(squared)), 1)

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
        return CASES[RUNS[self.label][0]]

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
    def row(self) -> tuple[str, ...]:
        """Figures of the run."""
        name, cells, step = RUNS[self.label]
        energy = self.run.summary["energy"]
        return (
            str(name),
            f"{cells:g}",
            f"1/{12.0 / step:g}",
            f"{self.speed:.1f} ({self.speed / self.case.measured_speed - 1.0:+.1%})",
            f"{self.stokes:.0f}",
            f"{self.restitution:.3f}",
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


def page(work: Work) -> Page:
    """Speeds, restitutions and heights of the rebounds."""
    found = {label: Rebound(label, work.run(label, scene(label))) for label in RUNS | OTHER}
    main, other = {label: found[label] for label in RUNS}, {label: found[label] for label in OTHER}
    first = found["st100"]
    text = ABOUT.format(
        cases=table(CASES_HEAD, [_case(name, case) for name, case in CASES.items()]),
        figures=table(HEAD, [one.row for one in main.values()]),
        other=table(OTHER_HEAD, [_other(one) for one in (first, *other.values())]),
    )
    return Page("Rebounds after falls at Stokes numbers from 100 to 742", text, {"": picture(main)})
