"""The swimmer that is tilted towards a wall, by both readings of the law's range."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from fluid_contacts import created_and_lost
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid.core.scene.scene import Scene

APART_UNTIL = 144.0
"""The paths are the same until a gap is below .24, so that the second one starts where the first is before that."""

FINER = ["mesh.size=4.0", "mesh.size_body=0.3", "time.end=400.0"]
MOMENTS = (40.0, 120.0, 200.0, 300.0, 400.0)
"""Times at which the paths on two meshes are compared, whole cycles."""

SNAPSHOTS = 5
CYCLE = 4.0


@dataclass(frozen=True)
class Reading:
    """A run by one reading of the law's range, with the time at which it starts."""

    run: Run
    since: float

    def of_body(self, name: str) -> dict[str, np.ndarray]:
        """The columns of one body."""
        bodies = self.run.history.bodies
        mine = bodies["body"] == name
        return {key: column[mine] for key, column in bodies.items()} | {"time": bodies["time"][mine] + self.since}


def page(work: Work) -> Page:
    """The path by both readings, and its figures."""
    first = Reading(work.run("range_0.03", "swimmer_near_wall.toml", ["time.end=1400.0"]), 0.0)
    second = Reading(work.run("range_0.24", for_its_size(work, first)), APART_UNTIL)
    finer = Reading(work.run("finer", "swimmer_near_wall.toml", FINER), 0.0)
    readings = {"range .03, as printed": first, "range .24, for its size": second}
    rows = [line(*named) for named in readings.items()]
    return Page(
        "A swimmer near a wall",
        ABOUT.format(rows=table(HEAD, rows), meshes=two_meshes(first, finer), **judged(first, second)),
        {"": paths(readings)},
    )


def for_its_size(work: Work, first: Reading) -> Scene:
    """From where the first reading's swimmer is before the range matters."""
    tables = work.scene("swimmer_near_wall.toml", ["time.end=676.0"]).to_dict()
    whole = first.of_body("swimmer")
    there = int(np.flatnonzero(whole["time"] == APART_UNTIL)[0])
    tables["mechanism"][0] |= {"position": [whole["x"][there], whole["y"][there]], "angle": whole["angle"][there]}
    tables["contact"]["range"] = 0.24
    return rigidfluid.scene_from_dict(tables)


def paths(readings: dict[str, Reading]) -> Figure:
    """Places, angles and gaps, and the balls of the first reading at some moments."""
    figure = Figure(figsize=(8.0, 9.0), dpi=120, layout="constrained")
    places, angles, gaps = figure.subplots(3, 1)
    for (label, reading), colour in zip(readings.items(), ("C0", "C3"), strict=True):
        whole, right = reading.of_body("swimmer"), reading.of_body("swimmer.right")
        places.plot(whole["x"], whole["y"], colour, linewidth=0.8, label=label)
        angles.plot(whole["time"], np.degrees(whole["angle"]), colour, linewidth=0.8, label=label)
        gaps.plot(right["time"], right["gap"], colour, linewidth=0.8, label=label)
    shown = next(iter(readings.values()))
    for name in ("left", "middle", "right"):
        ball = shown.of_body(f"swimmer.{name}")
        for moment in 4.0 * np.round(np.linspace(0.0, ball["time"][-1], SNAPSHOTS) / 4.0):
            now = int(np.argmin(np.abs(ball["time"] - moment)))
            places.add_patch(Circle((ball["x"][now], ball["y"][now]), 1.0, facecolor="none", edgecolor="k"))
    places.axhline(0.0, color="k")
    places.set(xlabel="x", ylabel="y", aspect="equal")
    angles.set(xlabel="time", ylabel="angle [degrees]")
    gaps.set(xlabel="time", ylabel="gap of the right ball", ylim=(0.0, 1.0))
    for axes in (places, angles, gaps):
        axes.legend(fontsize=8)
    return figure


HEAD = (
    *("reading", "until", "least gap", "lowest centre", "steepest [degrees]", "at the end", "largest contact force"),
    *("created [%]", "lost [%]"),
)


def line(label: str, reading: Reading) -> tuple[str, ...]:
    """Of one reading."""
    whole, history = reading.of_body("swimmer"), reading.run.history
    angle, force = np.degrees(whole["angle"]), np.hypot(whole["cfx"], whole["cfy"])
    shares = (f"{100.0 * share:.3f}" for share in created_and_lost(history)[:2])
    return (
        label,
        f"{whole['time'][-1]:g}",
        f"{history.bodies['gap'].min():.4f}",
        f"{whole['y'].min():.2f}",
        f"{angle.min():.1f}",
        f"{angle[-1]:.1f}",
        f"{force.max():.2f}",
        *shares,
    )


def two_meshes(first: Reading, finer: Reading) -> str:
    """Place and angle at some moments with cells of .6 and of .3."""
    rows = []
    for moment in MOMENTS:
        found = []
        for reading in (first, finer):
            whole = reading.of_body("swimmer")
            there = int(np.flatnonzero(whole["time"] == moment)[0])
            found += [whole["x"][there], whole["y"][there], np.degrees(whole["angle"][there])]
        rows.append((f"{moment:g}", *(f"{value:.3f}" for value in found)))
    return table(("time", "x", "y", "angle", "x, cells of .3", "y", "angle"), rows)


def judged(first: Reading, second: Reading) -> dict[str, object]:
    """What `ABOUT` says of the paths."""
    forces = [np.hypot(whole["cfx"], whole["cfy"]).max() for whole in (r.of_body("swimmer") for r in (first, second))]
    gaps = [reading.run.history.bodies["gap"].min() for reading in (first, second)]
    turned = map(parallel, (first, second))
    moments = ["never" if moment is None else f"at {moment:.0f}" for moment in turned]
    return {
        "first": "the wall alone turns it: there is no contact" if forces[0] == 0.0 else "there is contact",
        "second": "the law's force acts" if forces[1] > 0.0 else "there is no contact either",
        "first_gap": gaps[0] / 0.03,
        "second_gap": gaps[1] / 0.24,
        "again": " ".join(
            f"With the range {size} it is {moment} parallel to the wall again."
            for size, moment in zip((".03", ".24"), moments, strict=True)
        ),
        "sharpest": sharpest_turn(second),
        "overlap": "No bodies overlap." if min(gaps) > 0.0 else "Bodies overlap.",
    }


def sharpest_turn(reading: Reading) -> str:
    """Say where the turn in a cycle changes most while the law acts, and whether the mesh is another there."""
    whole, steps = reading.of_body("swimmer"), reading.run.history.steps
    cycles = np.arange(whole["time"][0], whole["time"][-1], CYCLE)
    turns = np.diff(np.interp(cycles, whole["time"], np.degrees(whole["angle"])))
    force = np.hypot(whole["cfx"], whole["cfy"])
    acts = np.array([force[(whole["time"] > now) & (whole["time"] <= now + CYCLE)].max() for now in cycles[:-1]]) > 0.0
    changes = np.where(acts[:-1] & acts[1:], np.abs(np.diff(turns)), 0.0)
    most = int(np.argmax(changes))
    meshes = np.interp(cycles[most : most + 3] - reading.since, steps["time"], steps["remeshes"])
    same = "on the same mesh" if meshes[0] == meshes[-1] else "where it is re-meshed"
    return (
        f"With the range .24 the turn of a cycle changes most, while the law acts, from {turns[most]:.3f} to "
        f"{turns[most + 1]:.3f} degrees at {cycles[most + 1]:.0f}, {same}."
    )


def parallel(reading: Reading) -> float | None:
    """When the swimmer is parallel to the wall after it was steepest; None if it never is."""
    whole = reading.of_body("swimmer")
    after = np.arange(len(whole["angle"])) > np.argmin(whole["angle"])
    there = np.flatnonzero(after & (whole["angle"] >= 0.0))
    return float(whole["time"][there[0]]) if there.size else None


ABOUT = """`scenes/swimmer_near_wall.toml`: the swimmer of radius 1 and arms 10 of arXiv:2402.19093 in a
channel of 150 × 40, from (15, 10). The tilt of -π/24 is Feel++'s, the paper states none. Stokes flow, viscosity 1,
density .1; a cycle takes 4. The printed range .03 and ε 5e-8 are those of a swimmer of an eighth of the size; for this
one the range is .24. Circles are the balls of the first reading at whole cycles. The second one starts where the first
is at 144, before any gap is below .24.

The swimmer comes to the wall, and is turned on its way. With the range as printed
{first}, and the least gap is
{first_gap:.1f} times that range. With the range .24 {second}, and the least gap is {second_gap:.2f} times the range.
{again}
{overlap}

{rows}

## Two meshes

The scene's cells are .6 long on the balls and 6 in the middle of the channel. The same with cells of .3 and 4 and the
range .03:

{meshes}

{sharpest}
"""
