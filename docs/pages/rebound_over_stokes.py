"""Spheres and disks thrown at a wall in a liquid: the effective restitution over the Stokes number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid.core.scene.scene import Scene

RADIUS, DRY, RANGE, ROUGHNESS, DECAY = 0.3, 0.97, 0.03, 2e-4, 35.0
STEEL, OIL, SPEED = 7.8, 0.965, 50.0
ADDED = {3: 0.5, 2: 1.0}
"""Added mass of a body far from walls, over the displaced mass, by dimension."""
STOKES = (6, 12, 20, 40, 80, 160, 400, 1200)
"""Stokes numbers of the throws; those of the impacts are smaller."""
LAWS = {"roughness": ROUGHNESS, "restitution_stokes": DECAY}
CELLS, STEP = 0.12, 5e-4
OTHER = {"finer cells": (0.08, STEP), "half the step": (CELLS, STEP / 2.0)}
"""Cells at the sphere [cm] and step [s] of the runs that are repeated for the throws of REPEATED."""
REPEATED = (20,)
FORMULA_3D = (20, 80)
"""Throws with `restitution_stokes` in 3D."""
DISKS = (20, 80, 400)
"""Throws in 2D."""


def scene(dimension: int, law: str, thrown: float, cells: float = CELLS, step: float = STEP) -> Scene:
    """A steel body a radius above the floor, in a liquid at rest of the viscosity that the Stokes number asks for."""
    density = STEEL + ADDED[dimension] * OIL
    viscosity = density * 2.0 * RADIUS * SPEED / (9.0 * thrown)
    lower, upper, position = _room(dimension)
    sides = ("left", "right") if dimension == 2 else ("left", "right", "front", "back")
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "thrown", "dimension": dimension, "units": {"length": "cm", "time": "s", "mass": "g"}},
            "fluid": {"density": OIL, "viscosity": viscosity},
            "domain": {"lower": lower, "upper": upper},
            "boundary": [{"on": side, "type": "slip"} for side in sides],
            "body": [
                {
                    "name": "sphere",
                    "type": "sphere",
                    "radius": RADIUS,
                    "density": STEEL,
                    "position": position,
                    "velocity": [0.0, -SPEED, 0.0][:dimension],
                }
            ],
            "contact": {"law": "normal", "range": RANGE, "epsilon": "auto", "restitution": DRY, law: LAWS[law]},
            "mesh": {"size": 2.0 * RADIUS, "size_body": cells},
            "time": {"end": 0.024, "step": step},
            "output": {"every": 0.008},
        }
    )


def _room(dimension: int) -> tuple[list[float], list[float], list[float]]:
    """Lower and upper corner of the box, and the body's first centre [cm]."""
    wide, high = 5.0 * RADIUS, 12.0 * RADIUS
    lower, upper, position = [-wide, 0.0, -wide], [wide, high, wide], [0.0, 2.0 * RADIUS, 0.0]
    return lower[:dimension], upper[:dimension], position[:dimension]


@dataclass(frozen=True)
class Impact:
    """A throw: Stokes number and speed at a gap of half a radius, and the highest speed away from the wall."""

    dimension: int
    run: Run

    @property
    def speed(self) -> float:
        """Speed towards the wall at a gap of half a radius [cm/s]."""
        bodies = self.run.history.bodies
        turn = int(np.argmin(bodies["y"]))
        return float(np.interp(-1.5 * RADIUS, -bodies["y"][: turn + 1], -bodies["vy"][: turn + 1]))

    @property
    def stokes(self) -> float:
        """St = (ρ_s + C_m ρ_f) D v/(9μ)."""
        moved = STEEL + ADDED[self.dimension] * OIL
        return moved * 2.0 * RADIUS * self.speed / (9.0 * float(self.run.scene.fluid.viscosity or np.inf))

    @property
    def restitution(self) -> float:
        """Highest speed away over that before, zero where the body stays within the law's range."""
        bodies = self.run.history.bodies
        away = bodies["vy"][bodies["y"] - RADIUS > RANGE]
        return max(float(away.max()), 0.0) / self.speed

    @property
    def created(self) -> float:
        """Energy created by contacts and scheme, of all that was put in [%]."""
        return 100.0 * float(self.run.summary["energy"]["created"])


def page(work: Work) -> Page:
    """Restitution over the Stokes number, in 3D and 2D, beside what was measured."""

    def thrown(dimension: int, law: str, stokes: float, label: str = "", *numbers: float) -> Impact:
        folder = f"{dimension}d_{law}_{stokes}{label}"
        return Impact(dimension, work.run(folder, scene(dimension, law, stokes, *numbers)))

    rough = {stokes: thrown(3, "roughness", stokes) for stokes in STOKES}
    other = {
        (stokes, words): thrown(3, "roughness", stokes, f"_{words.replace(' ', '_')}", *numbers)
        for stokes in REPEATED
        for words, numbers in OTHER.items()
    }
    formula = {stokes: thrown(3, "restitution_stokes", stokes) for stokes in FORMULA_3D}
    disks = {law: {stokes: thrown(2, law, stokes) for stokes in DISKS} for law in LAWS}
    every = [
        *rough.values(),
        *other.values(),
        *formula.values(),
        *(one for row in disks.values() for one in row.values()),
    ]
    rows = [_row("sphere, `roughness`", one) for one in rough.values()]
    rows += [_row("sphere, `restitution_stokes`", one) for one in formula.values()]
    rows += [_row(f"disk, `{law}`", one) for law, found in disks.items() for one in found.values()]
    text = ABOUT.format(
        figures=table(HEAD, rows),
        other=table(OTHER_HEAD, [_other_row(words, rough[stokes], one) for (stokes, words), one in other.items()]),
        off=f"{max(abs(one.restitution - DRY * legendre(one.stokes)) for one in formula.values()):.3f}",
        above=_above(list(rough.values())),
        created=f"{max(one.created for one in every):.2f}",
        measured=f"{GONDRET[1]:.2f}",
        there=f"{_interpolated(list(rough.values()), GONDRET[0]):.2f}",
    )
    return Page("Rebound over the Stokes number", text, {"": picture(rough, formula, disks)})


def legendre(stokes: float) -> float:
    """Fit of Legendre, Daniel and Guiraud to measurements, over the dry restitution."""
    return float(np.exp(-DECAY / stokes))


def joseph(stokes: float) -> float:
    """Fit to the measurements of Joseph, Zenit, Hunt and Rosenwinkel."""
    return float(max(1.0 - 8.65 * stokes**-0.75, 0.0))


GONDRET = (28.7, 0.48)
"""Stokes number of a measured rebound, with the added mass, and its speed over that before."""
HEAD = ("body and loss", "St", "v at a gap of R/2 [cm/s]", "e", ".97 exp(-35/St)", ".97 (1 - 8.65 St^-.75)")
HEAD += ("created [%]", "CPU time [s]")
OTHER_HEAD = ("with", "St", "e", "e before")


def _row(name: str, one: Impact) -> tuple[str, ...]:
    return (
        name,
        f"{one.stokes:.3g}",
        f"{one.speed:.1f}",
        f"{one.restitution:.3f}",
        f"{DRY * legendre(one.stokes):.3f}",
        f"{DRY * joseph(one.stokes):.3f}",
        f"{one.created:.2f}",
        f"{one.run.cpu_seconds:.0f}",
    )


def _other_row(words: str, before: Impact, one: Impact) -> tuple[str, ...]:
    return words, f"{one.stokes:.3g}", f"{one.restitution:.3f}", f"{before.restitution:.3f}"


def _above(found: list[Impact]) -> str:
    """Largest and smallest excess over the fit of Legendre's."""
    excess = [one.restitution - DRY * legendre(one.stokes) for one in found]
    return f"{min(excess):+.2f} to {max(excess):+.2f}"


def _interpolated(found: list[Impact], stokes: float) -> float:
    """Restitution between the throws next to a Stokes number."""
    return float(np.interp(np.log(stokes), np.log([one.stokes for one in found]), [one.restitution for one in found]))


def picture(rough: dict[int, Impact], formula: dict[int, Impact], disks: dict[str, dict[int, Impact]]) -> Figure:
    """Restitution over the Stokes number."""
    figure = Figure(figsize=(7.0, 4.5), dpi=120, layout="constrained")
    axes = figure.add_subplot(xscale="log", xlabel="Stokes number", ylabel="effective restitution")
    stokes = np.geomspace(4.0, 1500.0, 200)
    axes.plot(stokes, [DRY * legendre(st) for st in stokes], "k-", lw=1.0, label=".97 exp(-35/St)")
    axes.plot(stokes, [DRY * joseph(st) for st in stokes], "k--", lw=1.0, label=".97 (1 - 8.65 St^-.75)")
    series = {
        "sphere, roughness": (rough, "o"),
        "sphere, restitution_stokes": (formula, "s"),
        "disk, restitution_stokes": (disks["restitution_stokes"], "^"),
        "disk, roughness": (disks["roughness"], "v"),
    }
    for label, (found, mark) in series.items():
        axes.plot(
            [one.stokes for one in found.values()], [one.restitution for one in found.values()], mark, label=label
        )
    axes.plot(*GONDRET, "k*", ms=11.0, label="measured: Gondret et al. (2002)")
    axes.set(xlim=(4.0, 1500.0), ylim=(0.0, 1.0))
    axes.legend(fontsize=8)
    return figure


ABOUT = """A steel body of 6 mm (density 7.8) is thrown at a wall at 50 cm/s, in a liquid at rest (density .965), from
a gap of one radius R. There is no gravity. The viscosity sets the Stokes number St = (ρ_s + C_m ρ_f) D
v/(9μ), C_m = 1/2 for a sphere and 1 for a disk. v is the speed at a gap of R/2 on the way in. The effective
restitution e is the highest speed away from the wall, beyond the law's range, over v; it is 0 where the
body stays.

All runs have one setting: restitution .97, range R/10, `epsilon = "auto"`, cells of .4 R at the body and a step of .5
ms, in which the body moves R/12. Either loss of [impacts in a fluid](../forces.md#restitution) is used: `roughness` 2
µm, as for the [steel sphere in oil](steel_rebound.md), or `restitution_stokes` 35. Nothing is changed from one Stokes
number to another.

{figures}

The formulas are fits to measured rebounds of spheres, here times the dry .97: exp(-35/St) by Legendre, Daniel
and Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527, and 1 - 8.65 St^-.75, often given for the
measurements of Joseph, Zenit, Hunt and Rosenwinkel, J. Fluid Mech. 433 (2001) 329,
doi:10.1017/S0022112001003470. The measured point is the rebound of Gondret, Lance and Petit, Phys. Fluids 14
(2002) 643, doi:10.1063/1.1427920: {measured}, the speed by which the sphere leaves the wall over that of its
fall. It was found by a parabola through the first four points of the measured height. It lies above both fits,
which are means of measurements that scatter.

* Spheres with `roughness` are above .97 exp(-35/St) by {above}. The roughness is a property of two surfaces; 2 µm
  is that which gives the height of the measured rebound, and at its Stokes number these runs have {there}, by
  interpolation over log St. None of the others was compared with its own measurement.
* Spheres with `restitution_stokes` are at most {off} off the formula that they ask for.
* Disks with `roughness` hardly rebound below St 150: the film of an infinite cylinder takes more of St, about (4√2/3)
  √(R/h) = 73 down to this roughness h, and a sphere's 7. No measurement says that of disks in the plane;
  `restitution_stokes` lets them rebound as spheres do, if that is wanted.

The worst run creates {created} % of the energy that was put in.

## Cells and steps

{other}

Other throws were not repeated with them. The warning that boundary layers have less than two cells across holds for
most of these runs."""
