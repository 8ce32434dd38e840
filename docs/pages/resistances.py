"""Resistances of near spheres in Stokes flow, at a wall and in pairs, beside the exact ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure
from near_spheres import MOTIONS, TURNING, NearSpheres
from page_tools import Page, Work, table
from page_tools.cpu_time import cpu_seconds
from page_tools.kept_rows import Row
from page_tools.settings import Settings

ALLOWED = 0.01
GAPS, FAR = (0.5, 0.1, 0.02, 2e-3, 1e-3, 1e-4), 60.0
TURNED_AT, BOXES = 0.1, (30.0, 60.0, 120.0)
EQUAL = "Equal spheres"
ARRANGEMENTS = {
    "A sphere at a wall": NearSpheres(np.inf),
    EQUAL: NearSpheres(1.0),
    "Radii 1 and 4": NearSpheres(
        4.0, 0.5, ("mesh.refine=[{lower=[-1.3, -1.3, -0.3], upper=[1.3, 1.3, 2.6], size=0.25}]",)
    ),
}
"""Edges are at most a quarter of the radius on each sphere; the box is around the smaller one."""
STYLES = {"force": ("o", "-"), "torque": ("s", "--"), "torque on the larger": ("^", ":")}
"""Markers and lines, by load."""


def page(work: Work) -> Page:
    """Loads in all motions at all gaps, and of equal spheres that turn in place in boxes of several widths."""
    rows = sorted(work.cases(_cases()), key=lambda row: (-float(row["gap"]), float(row["far"])))
    for scene in ("squeezed_film", "two_spheres"):
        work.watch(scene, Settings(f"scenes/{scene}.toml"))
    near = [row for row in rows if row["motion"] != TURNING]
    turned = [row for row in rows if row["motion"] == TURNING]
    beyond = [row for row in near if abs(_off(row)) > ALLOWED]
    text = ABOUT.format(
        tables="\n\n".join(f"**{name}**\n\n{_table(name, near)}" for name in ARRANGEMENTS),
        far=f"{FAR:g}",
        allowed=f"{ALLOWED:.0%}",
        count=len(near),
        within=len(near) - len(beyond),
        beyond="; ".join(f"{row['motion']} at {row['gap']:g}, {_off(row):+.2%} ({_name(row)})" for row in beyond)
        or "none",
        worst=_worst(near),
        turned_at=TURNED_AT,
        boxes=_boxes(turned),
        halved=_halved(turned),
    )
    return Page("Resistances of narrow gaps", text, {"": errors(near)})


def errors(rows: Sequence[Row]) -> Figure:
    """Relative differences over the gap, a panel for each arrangement."""
    figure = Figure(figsize=(9.5, 4.2), dpi=120, layout="constrained")
    for axes, heading in zip(figure.subplots(1, len(ARRANGEMENTS), sharey=True), ARRANGEMENTS, strict=True):
        axes.axhspan(-100.0 * ALLOWED, 100.0 * ALLOWED, color="grey", alpha=0.15, linewidth=0.0)
        for (motion, load), chosen in _series(heading, rows).items():
            marker, line = STYLES[load]
            axes.plot(
                [row["gap"] for row in chosen], [100.0 * _off(row) for row in chosen], label=f"{motion}: {load}",
                color=f"C{list(MOTIONS).index(motion)}", marker=marker, linestyle=line, markersize=4,
            )  # fmt: skip
        axes.set(xscale="log", xlabel="gap over radius", title=heading)
    figure.axes[0].set_ylabel("off the exact one [%]")
    figure.legend(*figure.axes[-1].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


def _cases() -> dict[str, Callable[[], Iterable[Row]]]:
    """What is measured, on a mesh each."""
    near = {
        f"{heading} {gap:g} {FAR:g}": partial(_rows, heading, spheres, gap, FAR, list(MOTIONS))
        for gap in GAPS
        for heading, spheres in ARRANGEMENTS.items()
    }
    turned = {
        f"{EQUAL} {TURNING} {far:g}": partial(_rows, EQUAL, ARRANGEMENTS[EQUAL], TURNED_AT, far, [TURNING])
        for far in BOXES
    }
    return near | turned


def _rows(heading: str, spheres: NearSpheres, gap: float, far: float, motions: Sequence[str]) -> Iterator[Row]:
    """Loads in motions on one mesh; in Stokes flow they depend on the present motion alone."""
    start, simulation = cpu_seconds(), spheres.simulation(gap, far)
    for motion in motions:
        loads = spheres.loads(simulation, motion, gap)
        spent, start = cpu_seconds() - start, cpu_seconds()
        for load, (exact, found) in loads.items():
            yield {
                "arrangement": heading,
                "motion": motion,
                "load": load,
                "gap": gap,
                "far": far,
                "exact": exact,
                "found": found,
                "unknowns": int(simulation.history.steps["unknowns"][-1]),
                "seconds": round(spent, 1),
            }


def _off(row: Row) -> float:
    """Relative difference from the exact value."""
    return float(row["found"] / row["exact"] - 1.0)


def _name(row: Row) -> str:
    return f"{row['arrangement'].lower()}, {row['load']}"


def _series(heading: str, rows: Sequence[Row]) -> dict[tuple[str, str], list[Row]]:
    """Rows of each motion and load of an arrangement."""
    found: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row["arrangement"] == heading:
            found.setdefault((row["motion"], row["load"]), []).append(row)
    return found


def _table(heading: str, rows: Sequence[Row]) -> str:
    """Exact loads with what was found, at each gap, and the cost of all motions there."""
    series = _series(heading, rows)
    lines = [
        [f"{motion}: {load}", *(f"{abs(row['exact']):.5g} ({_off(row):+.2%})" for row in chosen)]
        for (motion, load), chosen in series.items()
    ]
    first = next(iter(series.values()))
    lines += [["unknowns", *(str(row["unknowns"]) for row in first)]]
    spent = [{row["motion"]: row["seconds"] for row in each} for each in zip(*series.values(), strict=True)]
    lines += [["CPU time", *(f"{sum(each.values()):.0f} s" for each in spent)]]
    return table(("gap over radius", *(f"{row['gap']:g}" for row in first)), lines)


def _worst(rows: Sequence[Row]) -> str:
    """Largest difference of each motion, where it is, and that at the narrowest gap."""
    lines = []
    for motion in MOTIONS:
        mine = [row for row in rows if row["motion"] == motion]
        worst, thinnest = (
            max(chosen, key=lambda row: abs(_off(row)))
            for chosen in (mine, [row for row in mine if row["gap"] == min(GAPS)])
        )
        lines.append((motion, f"{worst['gap']:g}", *(f"{_off(row):+.2%} ({_name(row)})" for row in (worst, thinnest))))
    return table(("motion", "worst at a gap of", "there", f"worst at {min(GAPS):g}"), lines)


def _boxes(rows: Sequence[Row]) -> str:
    """Differences in boxes of several widths, and their limit where they are linear in 1/width."""
    lines = []
    for (_, load), chosen in _series(EQUAL, rows).items():
        off = [_off(row) for row in chosen]
        off.append(2.0 * off[-1] - off[-2])
        lines.append([load, f"{abs(chosen[0]['exact']):.5g}", *(f"{each:+.2%}" for each in off)])
    return table(("load", "exact", *(f"walls {far:g} away" for far in BOXES), "no walls"), lines)


def _halved(rows: Sequence[Row]) -> str:
    """Ratios of the forces' differences, each to that in a box half as wide."""
    off = [_off(row) for row in rows if row["load"] == "force"]
    return " and ".join(f"{wider / narrower:.2f}" for narrower, wider in pairwise(off))


ABOUT = """Spheres that move slowly in Stokes flow: one of radius 1 at a wall (`scenes/squeezed_film.toml`), and pairs
of radii 1 and 1, and 1 and 4 (`scenes/two_spheres.toml`). Each load is that of one step, in a box whose walls are {far}
radii away. Edges on spheres are at most a quarter of the radius: `size_body` is .25, with radii 1 and 4 .5, and there a
box by `[[mesh.refine]]` asks for .25 around the smaller. `size` is a fifth of the distance to the walls. Everything
else is the default: two cells across a gap, five `refinements`, finer cells
[in films](../decisions/92-films-thinner-than-cells.md). No law adds a film.

Motions are relative ones of the surfaces: at speed 1 half-way between them, along the normal (squeezing) or across it
(sliding), and at angular velocity 1 about an axis across the normal (rolling) or along it (twisting). Both bodies of a
pair are prescribed to move so that by the exact resistances no force and no torque acts on the pair as a whole, as when
nothing else holds it; equal spheres that roll turn oppositely. Forces are over μr and that speed, torques about the
centres over μr² and it; those on the sphere of radius 1 are shown, and the torque on the larger.

The exact values are of an unbounded fluid: Brenner's series for a sphere that moves onto a wall (Chem. Eng. Sci. 16
(1961) 242), that of Stimson and Jeffery for two spheres on a line (Proc. R. Soc. Lond. A 111 (1926) 110), bispherical
coordinates for all that slides or rolls (Goldman, Cox and Brenner, Chem. Eng. Sci. 22 (1967) 637; O'Neill and Majumdar,
Z. angew. Math. Phys. 21 (1970) 164), and Jeffery's series for twisting (Proc. Lond. Math. Soc. 14 (1915) 327).

{within} of {count} loads are within {allowed} of the exact ones. Beyond it: {beyond}. The largest
differences are

{worst}

{tables}

The CPU time is that of all motions at a gap, and of their mesh.

Each sphere needs edges of a quarter of its own radius. With a `size_body` of .5 for both radii, 1 and 4, half the
smaller radius, the torque on the smaller sphere, which slides and hardly turns, is 1.2 % off at a gap of .5: it is a
small part of force times radius. `size_body = "auto"` is a fifth of the least radius. In the thinnest films squeezing
is off most: its pressure varies over √(R gap), R the smaller radius, and edges there are .12 of that, but no shorter
than `size_body`/256.

## Opposite turning in place, and the box

Equal spheres that turn oppositely, in place, with angular velocities of 1 and -1 at a gap of {turned_at:g}, have a
force to one side, both the same. Such a force on the pair as a whole moves the fluid far away, and walls are felt in
proportion to 1/width. Off the exact ones of an unbounded fluid are

{boxes}

The last column is the limit of the last two boxes. What the force is off is {halved} of that in a box half as wide:
it is the box, and not the film. The torque is not off so, nor are the same spheres in the table above, which roll
without a load on the pair."""
