"""Steel spheres fall in three silicone oils and bounce, in the set-ups of measurements at other Stokes numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from page_tools.kept_rows import Row
from page_tools.settings import settings_of

import rigidfluid
from pages._falls import Fall, read_fall
from rigidfluid.core.scene.scene import Scene

STEEL, GRAVITY = 7.8, 981.0
ROUGHNESS, DRY, DECAY = 2e-4, 0.97, 35.0
FALL, ABOVE, WIDE = 10.0, 14.0, 10.0
"""Gap under the sphere at the start, what the box is higher, and half its width [R]."""
OVER = 1.05
"""Share of the speed at the start that the liquid, at rest then, takes by more than a steady drag."""


@dataclass(frozen=True)
class Case:
    """A measured fall: ``diameter`` [cm], ``density`` and ``viscosity`` of the oil [g, cm, s], Reynolds number of the
    measured speed before the impact, the time after which the run ends [s], what the speed at the start is ``over``
    that for a steady drag [1], and the gap from which it ``fall``s [R]."""

    diameter: float
    density: float
    viscosity: float
    reynolds: float
    end: float
    over: float = OVER
    fall: float = FALL

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
        """Speed at the start: ``over`` times that by which a steady drag brings the sphere to the floor at the
        measured one [cm/s]."""
        squared, steps = self.measured_speed**2, 1000
        for _ in range(steps):
            squared -= 2.0 * self._acceleration(float(np.sqrt(squared))) * self.fall * self.radius / steps
        return round(self.over * float(np.sqrt(squared)), 1)

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
    100: Case(0.4, 0.953, 0.2, 110.0, 0.09, over=1.0),
    152: Case(0.3, 0.935, 0.1, 164.0, 0.078),
    192: Case(0.6, 0.953, 0.2, 212.0, 0.105),
    742: Case(0.5, 0.92, 0.05, 788.0, 0.045),
}
"""By the Stokes number that is given for the measurement."""
LONG = Case(0.3, 0.935, 0.1, 164.0, 0.095, fall=20.0)
"""That at St 152 from twice as high."""
CELLS, STEP = 0.4, 12.0
"""Cells at the sphere [R], and steps in which a sphere at the measured speed moves R."""
EARLY = 2.5
"""Time after the impact until which a parabola is put through heights [R/v]."""
MEASURED = np.array(
    [
        *(
            [-15.6, 9.1126],
            [-11.6, 6.7863],
            [-7.6, 4.4419],
            [-3.6, 2.1123],
            [0.4, 0.2059],
            [2.4, 1.1534],
            [4.4, 1.9999],
        ),
        *(
            [6.4, 2.7307],
            [10.4, 3.9585],
            [14.4, 5.0002],
            [18.4, 5.8116],
            [22.4, 6.4674],
            [26.4, 6.9282],
            [30.4, 7.2561],
        ),
        *([34.4, 7.4354], [38.4, 7.466], [42.4, 7.3662], [46.4, 7.154], [50.4, 6.7999]),
    ]
)
"""Measured at St 152: time after the impact [ms] and gap [mm]."""
SHOWN = 8
"""Its row for 10.4 ms."""
TOP, HEIGHT, BOUNCE = 0.0377, 2.489, 0.876
"""Measured at St 152: time of the top after the impact [s], height over D, and speed at the floor of the parabola
through the first four heights over the speed before."""


def scene(case: Case) -> Scene:
    """The sphere above the floor, at the speed of `Case.thrown`."""
    radius = case.radius
    high, wide = round((case.fall + ABOVE) * radius, 6), round(WIDE * radius, 6)
    return rigidfluid.scene_from_dict(
        {
            "scene": {
                "name": f"steel_st{case.measured_stokes:.0f}",
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
                    "position": [0.0, round((case.fall + 1.0) * radius, 6), 0.0],
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
            "mesh": {"size": round(5.0 * radius, 6), "size_body": round(CELLS * radius, 6)},
            "time": {"end": case.end, "step": float(f"{radius / (STEP * case.measured_speed):.3g}")},
            "output": {"every": case.end},
        }
    )


def measure(work: Work, label: str, case: Case) -> Row:
    """Fall and rebound of a run [cm, s], the greatest displacement sideways [R], and what the run says of energy."""
    run = work.run(label, scene(case))
    fall, bodies, energy = read_fall(run, case.radius), run.history.bodies, run.summary["energy"]
    return {
        **{name: [float(f"{number:.7g}") for number in getattr(fall, name)] for name in ("time", "gap", "velocity")},
        "aside": float(np.hypot(bodies["x"], bodies["z"]).max()) / case.radius,
        "energy": {part: energy[part] for part in ENERGIES},
        "cpu_seconds": round(run.cpu_seconds, 1),
    }


@dataclass(frozen=True)
class Rebound:
    """Figures of a ``row`` of `measure` [cm, s]."""

    case: Case
    row: Row

    @cached_property
    def fall(self) -> Fall:
        """Fall and rebound."""
        return Fall(*(np.array(self.row[name]) for name in ("time", "gap", "velocity")))

    @property
    def falls_again(self) -> bool:
        """Whether the run has the top."""
        return bool(self.fall.velocity[-1] < 0.0)

    @property
    def height(self) -> float:
        """Height of the rebound, over the diameter."""
        return self.fall.height / self.case.diameter

    @property
    def rise(self) -> float:
        """Time from the impact to the top."""
        return float(self.fall.time[self.fall.top] - self.fall.turned)

    @cached_property
    def speed(self) -> float:
        """Speed downwards at a gap of R/2."""
        return self.fall.speed_at(0.5 * self.case.radius)

    @property
    def stokes(self) -> float:
        """St = ρ_s D v/(9μ), without the added mass."""
        return STEEL * self.case.diameter * self.speed / (9.0 * self.case.viscosity)

    @property
    def whole_stokes(self) -> float:
        """St = (ρ_s + ρ_f/2) D v/(9μ)."""
        return whole_stokes(self.case, self.stokes)

    @property
    def restitution(self) -> float:
        """Highest speed upwards beyond range, over that before."""
        after = slice(self.fall.impact, None)
        away = self.fall.velocity[after][self.fall.gap[after] > 0.1 * self.case.radius]
        return float(away.max()) / self.speed

    def gap_after(self, time: float) -> float:
        """Gap at a time after the impact."""
        return float(np.interp(self.fall.turned + time, self.fall.time, self.fall.gap))

    @property
    def fitted(self) -> float:
        """Speed at the floor of a parabola through the heights until EARLY after the impact, over that before."""
        rising = slice(self.fall.impact, self.fall.top)
        time, gap = self.fall.time[rising] - self.fall.turned, self.fall.gap[rising]
        early = (gap > 0.1 * self.case.radius) & (time < EARLY * self.case.radius / self.speed)
        return float(np.polyfit(time[early], gap[early], 2)[1]) / self.speed


def legendre(stokes: float) -> float:
    """Fit of Legendre, Daniel and Guiraud to measurements, over the dry restitution."""
    return float(np.exp(-DECAY / stokes))


def joseph(stokes: float) -> float:
    """Fit to the measurements of Joseph, Zenit, Hunt and Rosenwinkel."""
    return float(max(1.0 - 8.65 * stokes**-0.75, 0.0))


CASES_HEAD = ("St given", "Re", "D [cm]", "density of the oil [g/cm³]", "viscosity [g/(cm s)]", "v of these Re [cm/s]")
CASES_HEAD += ("settled by the fit [cm/s]", "thrown at [cm/s]")
HEAD = ("St given", "v at a gap of R/2 [cm/s] (off the measured)", "St", "e", "e by a parabola", ".97 exp(-35/St)")
HEAD += (
    ".97 (1 - 8.65 St^-.75)",
    "height over D",
    "top after the impact [s]",
    "created, lost, stabilisation [%]",
    "CPU time [s]",
)


ENERGIES = {"created": ".2f", "lost": ".2f", "grad_div": ".1f"}
"""Columns of energy, of all that was put in [%]."""


def page(work: Work) -> Page:
    """Speeds, restitutions and heights of the rebounds."""
    cases = {f"st{name}": case for name, case in CASES.items()} | {"st152_far": LONG}
    measured = work.cases({label: partial(_rows, work, label, case) for label, case in cases.items()})
    rows = {str(row["case"]): row for row in measured}
    for label, case in cases.items():
        work.watch(label, settings_of(scene(case)))
    found = {name: Rebound(case, rows[f"st{name}"]) for name, case in CASES.items()}
    first, far = found[152], Rebound(LONG, rows["st152_far"])
    text = ABOUT.format(
        cases=table(CASES_HEAD, [_case(name, case) for name, case in CASES.items()]),
        figures=table(HEAD, [_row(name, one) for name, one in found.items()]),
        compared=compared(first),
        measured_above=f"{BOUNCE - DRY * legendre(whole_stokes(first.case, first.case.measured_stokes)):.2f}",
        above=_between([one.fitted - DRY * legendre(one.whole_stokes) for one in found.values()], "{:.2f}"),
        run_at=f"{10.0 * first.gap_after(MEASURED[SHOWN, 0] / 1e3):.2f}",
        measured_at=f"{MEASURED[SHOWN, 1]:.2f}",
        higher=f"{first.height / HEIGHT - 1.0:.0%}",
        later=f"{first.rise / TOP - 1.0:.0%}",
        far=f"{LONG.fall:g}",
        far_speed=f"{far.speed:.1f}",
        far_bounce=f"{far.fitted:.3f}",
        far_height=f"{far.height:.3f}",
        far_off=f"{far.height / HEIGHT - 1.0:+.0%}",
        far_rise=f"{far.rise:.4f}",
        sensitivity=f"{(1.0 + DRY) * np.log(2.0) / first.whole_stokes:.3f}",
        aside=f"{max(one.row['aside'] for one in found.values()):.1g}",
        created=f"{max(100.0 * one.row['energy']['created'] for one in found.values()):.2f}",
    )
    return Page("Rebounds after falls at Stokes numbers from 100 to 742", text, {"": picture(found)})


def _rows(work: Work, label: str, case: Case) -> list[Row]:
    """The one row of a case."""
    return [measure(work, label, case)]


def whole_stokes(case: Case, stokes: float) -> float:
    """St with the added mass, from that without it."""
    return stokes * (1.0 + 0.5 * case.density / STEEL)


def _row(name: int, one: Rebound) -> tuple[str, ...]:
    return (
        str(name),
        f"{one.speed:.1f} ({one.speed / one.case.measured_speed - 1.0:+.1%})",
        f"{one.stokes:.0f}",
        f"{one.restitution:.3f}",
        f"{one.fitted:.3f}",
        f"{DRY * legendre(one.whole_stokes):.3f}",
        f"{DRY * joseph(one.whole_stokes):.3f}",
        *((f"{one.height:.3f}", f"{one.rise:.4f}") if one.falls_again else ("after the end", "after the end")),
        ", ".join(f"{100.0 * one.row['energy'][part]:{form}}" for part, form in ENERGIES.items()),
        f"{one.row['cpu_seconds']:.0f}",
    )


def compared(one: Rebound) -> str:
    """A table of the run and the measurement at St 152."""
    before = one.case.measured_speed
    figures = {
        "speed before [cm/s]": (f"{one.speed:.1f}", f"{before:.1f}", one.speed / before),
        "e by a parabola": (f"{one.fitted:.3f}", f"{BOUNCE:.3f}", one.fitted / BOUNCE),
        "height over D": (f"{one.height:.3f}", f"{HEIGHT:.3f}", one.height / HEIGHT),
        "top after the impact [s]": (f"{one.rise:.4f}", f"{TOP:.4f}", one.rise / TOP),
    }
    rows = [(name, found, known, f"{ratio - 1.0:+.1%}") for name, (found, known, ratio) in figures.items()]
    return table(("", "run", "measured", "off"), rows)


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


def _between(values: list[float], form: str) -> str:
    """Smallest and largest."""
    return " to ".join(form.format(end(values)) for end in (min, max))


def picture(found: dict[int, Rebound]) -> Figure:
    """Gap over the time since the impact, and restitution over the Stokes number."""
    figure = Figure(figsize=(9.5, 4.2), dpi=120, layout="constrained")
    left, right = figure.subplots(1, 2)
    for name, one in found.items():
        time = 1e3 * (one.fall.time - one.fall.turned)
        left.plot(time, one.fall.gap / one.case.diameter, lw=1.2, label=f"St {name}")
    left.plot(MEASURED[:, 0], MEASURED[:, 1] / 10.0 / CASES[152].diameter, "ko", ms=3.0, label="measured, St 152")
    left.set(xlim=(-30.0, 60.0), ylim=(0.0, None), xlabel="time after the impact [ms]", ylabel="gap over D")
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
    right.plot([whole_stokes(CASES[152], 152.0)], [BOUNCE], "k*", ms=11.0, label="measured, by a parabola")
    right.legend(fontsize=8)
    return figure


ABOUT = """Steel spheres (density 7.8) fall in silicone oils and bounce, in the set-ups of Gondret, Lance and Petit,
Phys. Fluids 14 (2002) 643, doi:10.1063/1.1427920, with which Rettinger and Rüde compared (arXiv:2003.01490; as in the
inputs of waLBerla, `inputSphereWallCollision.dat`). [The steel sphere in oil](steel_rebound.md) is another of these,
at St 27. The Stokes number is ρ_s D v/(9μ), without the added mass, as it is given for the measurements.

{cases}

Not all have settled when they hit: by the usual fit to drag, C_D = 24/Re (1 + .15 Re^.687), the last one would become
faster. So a sphere is thrown from a gap of 10 R, at 1.05 times the speed from which drag by this fit and the added
mass lead to the measured speed at the floor. The 5 % are for the liquid, which is at rest then and resists more than
later. They were added after the run at St 100, which is without them and arrived that much slower.

All runs have the setting of [the throws](rebound_over_stokes.md): law `normal`, restitution .97, `roughness` 2 µm,
range R/10, `epsilon = "auto"`, cells of .4 R at the sphere and steps in which it moves R/12. The box is 20 R wide,
with slip at its sides, and 24 R high. Nothing else is changed from case to case.

{figures}

e is the highest speed upwards beyond range over v. The sphere then slows down much faster than by weight and steady
drag, in liquid that still follows it down, so that e depends on where it is read. The next column is the speed at the
floor of a parabola through the heights until 2.5 R/v after the impact. The fits to measurements are by Legendre,
Daniel and Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527, and the one often given for Joseph, Zenit,
Hunt and Rosenwinkel, J. Fluid Mech. 433 (2001) 329, doi:10.1017/S0022112001003470, with the added mass in St.

## Against the measurement at St 152

{compared}

The measured heights, every 2 ms, are those kept with the test cases of the code PARTIES (`gondret152_expy.dat`;
Biegert, Vowinckel and Meiburg, J. Comput. Phys. 340 (2017) 105, doi:10.1016/j.jcp.2017.03.035). The parabola goes
through the first four. The measurement lies above both fits, by {measured_above} above the first, as that at St 27
does; runs at these St lie {above} above it.

The sphere leaves the floor as fast as measured, but then slows down less: 10.4 ms after the impact it is {run_at} mm
high, and not {measured_at}, and it turns {higher} higher and {later} later than measured. No law acts there. What the
liquid does after an impact is what its flow was before: a sphere that was thrown 5 D above the floor has a shorter
wake to meet than one that fell from far above. Thrown from twice as high, {far} R, it arrives at {far_speed} cm/s,
leaves with e = {far_bounce} by a parabola, and turns at {far_height} D ({far_off} off the measured) {far_rise} s
after the impact.

The roughness of 2 µm was chosen at St 27, where it gives the measured height, and is no measured one. Here the film
takes a smaller part, and so the choice matters less: by `e₀ (St - T) - T` 1 or 4 µm in place of 2 change e at St 152
by {sensitivity}. So this e is closer to a prediction than that at St 27.

Of St 100, 192 and 742 no measured heights were at hand, and the run at St 742 ends before the top.

The worst run creates {created} % of the energy that was put in. Neither cells nor steps were varied here; of the
throws only that at St 17 was repeated with others. Cells of .4 R are far from resolving the boundary layer at the
larger St, and `rigidfluid` warns of it. At St 742 it also warns that stabilisation takes more than 5 % of the energy,
since cells in the wake are too coarse; that row is a restitution in a poorly resolved flow. [Settling
spheres](settling_spheres.md) with cells of .32 R have speeds within 1 % of the measured at Re 280 and 360. Beyond Re
280 wakes are unsteady. These spheres move sideways by {aside} R at most."""
