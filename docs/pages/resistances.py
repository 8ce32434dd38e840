"""Resistances of near spheres in Stokes flow, at a wall and in pairs, beside the exact ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from approach import force_of_approach
from bispherical import resistance
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from page_tools.cpu_time import cpu_seconds
from page_tools.kept_rows import Row
from page_tools.places import SCENES
from page_tools.settings import Settings
from published import brenner, drag_of_approach, torque_of_twist

import rigidfluid
from rigidfluid.core.run.simulation import Simulation

SPEED, ALLOWED = 1e-6, 0.01
GAPS, FAR = (0.5, 0.1, 0.02, 5e-3, 1e-3, 1e-4), 60.0
TERMS = 60000
Prescribed = dict[str, tuple[list[float], list[float]]]


@dataclass(frozen=True)
class Motion:
    """A motion: directions of velocity and angular velocity of each body; by gap the exact force or torque on ``body``
    along each column, over viscosity, speed and the right power of the radius."""

    heading: str
    prescribed: Prescribed
    body: int
    exact: Callable[[float], dict[str, float]]


@dataclass(frozen=True)
class Arrangement:
    """Bodies near each other: their scene and overrides at a gap, and the motions."""

    scene: str
    placed: Callable[[float], list[str]]
    motions: tuple[Motion, ...]


def _at_wall(gap: float) -> list[str]:
    return [
        f"body.0.position=[0.0, 0.0, {1.0 + gap}]",
        f"domain.lower=[{-FAR}, {-FAR}, 0.0]",
        f"domain.upper=[{FAR}, {FAR}, {2.0 * FAR}]",
    ]


def _pair(radius: float, size_body: float = 0.25) -> Callable[[float], list[str]]:
    def placed(gap: float) -> list[str]:
        return [
            f"mesh.size_body={size_body}",
            f"body.0.radius={radius}",
            f"body.0.position=[0.0, 0.0, {-(radius + 0.5 * gap)}]",
            f"body.1.position=[0.0, 0.0, {1.0 + 0.5 * gap}]",
            f"domain.lower=[{-FAR}, {-FAR}, {-FAR}]",
            f"domain.upper=[{FAR}, {FAR}, {FAR}]",
        ]

    return placed


def _beside_wall(column: int) -> Callable[[float], dict[str, float]]:
    """Force and torque of a sphere that slides (0) or turns (1)."""
    return lambda gap: dict(zip(("fx", "ty"), -resistance(gap, np.inf)[:, column], strict=True))


def _past(radius: float) -> Callable[[float], dict[str, float]]:
    """Force and torque on the upper of two spheres that pass each other."""

    def exact(gap: float) -> dict[str, float]:
        force, torque, *_ = -resistance(gap, radius) @ np.array([1.0, 0.0, -1.0, 0.0])
        return {"fx": force, "ty": torque}

    return exact


def _both(*velocity: float) -> Prescribed:
    """Opposite velocities of two bodies that do not turn."""
    rest = [0.0, 0.0, 0.0]
    return {"upper": (list(velocity), rest), "lower": ([-each for each in velocity], rest)}


NONE = [0.0, 0.0, 0.0]
WALL = (
    Motion(
        "Onto a wall",
        {"sphere": ([0.0, 0.0, -1.0], NONE)},
        0,
        lambda gap: {"fz": 6.0 * np.pi * brenner(gap, TERMS)},
    ),
    Motion("Sliding along a wall", {"sphere": ([1.0, 0.0, 0.0], NONE)}, 0, _beside_wall(0)),
    Motion("Turning beside a wall", {"sphere": (NONE, [0.0, 1.0, 0.0])}, 0, _beside_wall(1)),
    Motion(
        "Twisting, about the normal of a wall",
        {"sphere": (NONE, [0.0, 0.0, 1.0])},
        0,
        lambda gap: {"tz": -8.0 * np.pi * torque_of_twist(gap)},
    ),
)
EQUAL = (
    Motion(
        "Two, onto each other",
        _both(0.0, 0.0, -1.0),
        1,
        lambda gap: {"fz": 6.0 * np.pi * drag_of_approach(gap, TERMS)},
    ),
    Motion("Two, past each other", _both(1.0, 0.0, 0.0), 1, _past(1.0)),
)
UNEQUAL = (
    Motion(
        "Radii 1 and 4, onto each other",
        _both(0.0, 0.0, -1.0),
        1,
        lambda gap: {"fz": 6.0 * np.pi * force_of_approach(gap, 4.0)},
    ),
    Motion("Radii 1 and 4, past each other", _both(1.0, 0.0, 0.0), 1, _past(4.0)),
)
ARRANGEMENTS = (
    Arrangement("squeezed_film.toml", _at_wall, WALL),
    Arrangement("two_spheres.toml", _pair(1.0), EQUAL),
    Arrangement("two_spheres.toml", _pair(4.0, 0.5), UNEQUAL),
)
WORDS = {"f": "force", "t": "torque"}


def page(work: Work) -> Page:
    """Forces and torques of all motions at all gaps."""
    rows = work.rows(_measured)
    for arrangement in ARRANGEMENTS[:2]:
        work.watch(arrangement.scene.removesuffix(".toml"), Settings(f"scenes/{arrangement.scene}"))
    beyond = [row for row in rows if abs(_off(row)) > ALLOWED]
    text = ABOUT.format(
        tables="\n\n".join(_table(motion, rows) for each in ARRANGEMENTS for motion in each.motions),
        far=f"{FAR:g}",
        allowed=f"{ALLOWED:.0%}",
        count=len(rows),
        within=len(rows) - len(beyond),
        beyond="; ".join(f"{row['motion'].lower()}, {WORDS[row['column'][0]]} at {row['gap']:g}" for row in beyond)
        or "none",
    )
    return Page("Resistances of narrow gaps", text, {"": errors(rows)})


def errors(rows: Sequence[Row]) -> Figure:
    """Relative differences over the gap."""
    figure = Figure(figsize=(8.0, 4.5), dpi=120, layout="constrained")
    axes = figure.subplots()
    series = list(dict.fromkeys((row["motion"], row["column"]) for row in rows))
    for number, (motion, column) in enumerate(series):
        chosen = [row for row in rows if (row["motion"], row["column"]) == (motion, column)]
        label = f"{motion}: {WORDS[column[0]]}"
        style = {"color": f"C{number % 10}", "marker": "os"[column[0] == "t"], "linestyle": "--" if number > 9 else "-"}
        axes.plot([row["gap"] for row in chosen], [100.0 * _off(row) for row in chosen], label=label, **style)
    axes.axhspan(-100.0 * ALLOWED, 100.0 * ALLOWED, color="grey", alpha=0.15, linewidth=0.0)
    axes.set(xscale="log", xlabel="gap over radius", ylabel="off the exact one [%]")
    figure.legend(loc="outside right upper", fontsize=7)
    return figure


def _measured() -> Iterator[Row]:
    for gap in GAPS:
        for arrangement in ARRANGEMENTS:
            yield from _rows(arrangement, gap)


def _rows(arrangement: Arrangement, gap: float) -> Iterable[Row]:
    """Force and torque of each motion on one mesh; in Stokes flow they depend on the present motion alone."""
    start = cpu_seconds()
    overrides = [*arrangement.placed(gap), f"mesh.size={0.2 * FAR}", "time.end=1.0"]
    simulation = Simulation(rigidfluid.load_scene(SCENES / arrangement.scene, overrides))
    for motion in arrangement.motions:
        for name, (velocity, spin) in motion.prescribed.items():
            simulation.prescribe(name, SPEED * np.array(velocity), SPEED * np.array(spin))
        simulation.step()
        bodies, unknowns = simulation.history.bodies, int(simulation.history.steps["unknowns"][-1])
        now = bodies["time"] == simulation.time
        spent, start = cpu_seconds() - start, cpu_seconds()
        for column, exact in motion.exact(gap).items():
            found = float(np.asarray(bodies[column])[now][motion.body]) / SPEED
            yield {
                "motion": motion.heading,
                "column": column,
                "gap": gap,
                "exact": float(exact),
                "found": found,
                "unknowns": unknowns,
                "seconds": round(spent, 1),
            }


def _off(row: Row) -> float:
    """Relative difference from the exact value."""
    return float(row["found"] / row["exact"] - 1.0)


def _table(motion: Motion, rows: Sequence[Row]) -> str:
    """Each gap with the exact values and those that were found."""
    mine = [row for row in rows if row["motion"] == motion.heading]
    columns, gaps = list(dict.fromkeys(row["column"] for row in mine)), dict.fromkeys(row["gap"] for row in mine)
    lines = []
    for gap in gaps:
        here = [row for row in mine if row["gap"] == gap]
        cells = [f"{abs(row['exact']):.5g}" for row in here]
        cells += [f"{abs(row['found']):.5g} ({_off(row):+.2%})" for row in here]
        lines.append([f"{gap:g}", *cells, str(here[0]["unknowns"]), f"{here[0]['seconds']:.0f} s"])
    words = [WORDS[column[0]] for column in columns]
    heading = ("gap over radius", *(f"exact {word}" for word in words), *words, "unknowns", "CPU time")
    return f"**{motion.heading}**\n\n" + table(heading, lines)


ABOUT = """`scenes/squeezed_film.toml` and `scenes/two_spheres.toml`: spheres of radius 1, or 1 and 4, that move slowly
in Stokes flow, by one step of each motion in a box {far} radii to each side. Keys of the mesh are those of the scenes,
with the size far away that the box asks for, and `size_body` .5 for unequal radii; gaps have what they have by default.
Forces are over μrV or μr²ω, torques over μr²V or μr³ω.

The exact values are of an unbounded fluid: Brenner's series at a wall and at the plane half-way between equal spheres
that approach (Chem. Eng. Sci. 16 (1961) 242), that of Stimson and Jeffery for unequal ones (Proc. R. Soc. Lond. A 111
(1926) 110), bispherical coordinates for all that slides or turns (Goldman, Cox and Brenner, Chem. Eng. Sci. 22 (1967)
637; O'Neill and Majumdar, Z. angew. Math. Phys. 21 (1970) 164), and Jeffery's series for a twist (Proc. Lond. Math.
Soc. 14 (1915) 327).

{within} of {count} are within {allowed} of the exact ones. Beyond it: {beyond}.

{tables}

The CPU time of the first motion at a gap contains the mesh, which the others share."""
