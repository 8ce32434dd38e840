"""Two disks in a line, against the published heights and velocities; with and without loss in the contact."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import (
    PAIR_KISSES,
    PAIR_LEADING_ASIDE,
    PAIR_LEADING_HEIGHT,
    PAIR_LEADING_VELOCITY,
    PAIR_OFFSET,
    PAIR_OVERTAKES,
    PAIR_TRAILING_HEIGHT,
    PAIR_TRAILING_VELOCITY,
)

from pages._flow import vorticity_pictures
from pages._one_knob import OneKnob
from pages._pair import Pair, energy_shares

SCENE, HEIGHT_OF_BOX, ALLOWED = "drafting_kissing_tumbling.toml", 6.0, 0.01
AGREEMENT = 0.001
"""Of two runs until kissing, over the box's height."""

COARSE = ["mesh.size_body=0.01", "mesh.wake.size=0.04", "time.step=0.0005"]
ELASTIC = ["contact.restitution=1.0"]
RUNS = {
    "coarse": ("size_body 0.01, step 0.0005", COARSE),
    "shipped": ("size_body 0.005, step 0.00025", []),
    "long_step": ("size_body 0.005, step 0.0005", ["time.step=0.0005"]),
    "elastic_coarse": ("elastic, size_body 0.01, step 0.0005", [*COARSE, *ELASTIC]),
    "elastic": ("elastic, size_body 0.005, step 0.00025", ELASTIC),
}
"""By folder: the heading, and what differs from the scene as shipped."""

SHIPPED_OFFSET, OFFSETS = 0.001, (0.0, 0.003, 0.01)
"""How far the trailing disk starts beside the line, as shipped and in coarse runs that vary it [cm]."""

OVERTAKING = {
    "c0005": (0.9995, 1.0, COARSE),
    "c001": (0.999, 1.0, COARSE),
    "c002": (0.999, 1.001, COARSE),
    "cm002": (1.001, 0.999, COARSE),
    "c004": (0.998, 1.002, COARSE),
    "c002short": (0.999, 1.001, [*COARSE, "contact.range=0.0075", "contact.stiffness=8e5"]),
    "f002": (0.999, 1.001, ["time.step=0.0005"]),
}
"""By folder: where the trailing and the leading disk start across the box [cm], and what else is not as shipped."""
OVERTAKEN, WANTED = "Koblitz et al. 2017", 0.03
UNTIL = 0.21
"""Ways aside are compared until then: later they are a matter of where the disks have come apart [s]."""
BESIDE = 0.1575
"""Time at which the ways aside of different offsets are compared [s]."""

HEIGHTS = (PAIR_TRAILING_HEIGHT, PAIR_LEADING_HEIGHT)
VELOCITIES = (PAIR_TRAILING_VELOCITY, PAIR_LEADING_VELOCITY)
PUBLISHED_END = min(float(curve[-1, 0]) for curve in HEIGHTS)
MOMENTS = (0.1, 0.15, 0.18, 0.21, 0.24)

BEFORE_KISSING = 0.14
"""When the height of the trailing disk is compared in the study [s]."""

STUDY = OneKnob(
    SCENE,
    name=f"height of the trailing disk at {BEFORE_KISSING:g} s [cm]",
    common=[f"time.end={BEFORE_KISSING}", "output.every=0.07"],
    finest=["mesh.size_body=0.0035", "mesh.wake.size=0.018"],
    values={
        "mesh.size_body": (0.02, 0.01),
        "time.step": (0.001, 0.0005),
        "mesh.order": (1,),
        "mesh.remesh_every": (0.02,),
        "mesh.quality": (0.4,),
    },
    figure=lambda run: pair(run).at(BEFORE_KISSING, "y")[0],
)


def pair(run: Run) -> Pair:
    """The two disks of a run."""
    return Pair(run, "trailing", "leading")


def beside(offset: float) -> list[str]:
    """Of a coarse run, with the trailing disk so far beside the line."""
    return [*COARSE, f"body.0.position=[{1.0 - offset}, 5.0]"]


def page(work: Work) -> Page:
    """Heights and velocities beside the published ones, both laws, what is reproducible, the study."""
    pairs = {name: pair(work.run(name, SCENE, overrides)) for name, (_, overrides) in RUNS.items()}
    offsets = {offset: pair(work.run(f"offset_{offset:g}", SCENE, beside(offset))) for offset in OFFSETS}
    offsets = dict(sorted({**offsets, SHIPPED_OFFSET: pairs["coarse"]}.items()))
    study = STUDY.measure(work)
    figures = {
        "": over_time(pairs),
        "_moments": vorticity_pictures(pairs["shipped"].run, MOMENTS, height=2.4, scale=400.0),
        "_study": study.plot(),
    }
    parts = (ABOUT, story(pairs["shipped"]), before_kissing(pairs), after_kissing(pairs), about_offsets(offsets))
    parts += (about_overtaking(overtaking_pairs(work)),)
    parts += (study.section("drafting_kissing_tumbling"),)
    return Page("Drafting, kissing and tumbling", "\n\n".join(parts), figures)


def over_time(pairs: dict[str, Pair]) -> Figure:
    """Heights, velocities, the gap, the tilt of the line of centres."""
    figure = Figure(figsize=(9.0, 6.8), dpi=120, layout="constrained")
    heights, velocities, gaps, tilts = figure.subplots(2, 2).ravel()
    for (name, one), style in zip(
        of(pairs, "coarse", "shipped", "long_step", "elastic"), (":", "-", "--", "-."), strict=True
    ):
        for way, colour in zip(one.ways, ("C0", "C1"), strict=True):
            heights.plot(one.time, way["y"], style, color=colour)
            velocities.plot(one.time, way["vy"], style, color=colour)
        gaps.semilogy(one.time, one.gap, style, color="k", label=RUNS[name][0])
        tilts.plot(one.time, one.tilt, style, color="k")
    for axes, curves in ((heights, HEIGHTS), (velocities, VELOCITIES)):
        show(axes, curves)
    gaps.legend(fontsize=7)
    heights.legend(fontsize=7)
    heights.set(xlabel="time [s]", ylabel="height [cm]", title="blue: trailing disk, orange: leading disk")
    velocities.set(xlabel="time [s]", ylabel="vertical velocity [cm/s]")
    gaps.set(xlabel="time [s]", ylabel="gap between the disks [cm]")
    tilts.set(xlabel="time [s]", ylabel="line of centres from the vertical [degree]")
    return figure


def show(axes: Axes, curves: Iterable[np.ndarray]) -> None:
    """The published points."""
    for curve, marker, name in zip(curves, "ox", ("trailing", "leading"), strict=True):
        axes.plot(*curve.T, marker, color="k", markersize=4, mfc="none", label=f"Glowinski et al. 2001, {name}")


def of(pairs: dict[str, Pair], *names: str) -> Iterable[tuple[str, Pair]]:
    """Some of the pairs."""
    return [(name, pairs[name]) for name in names]


def off_heights(one: Pair, since: float, until: float) -> tuple[float, float]:
    """Largest difference of height from the published points in a span of time, of both disks, over the box."""
    return off_curves(one, "y", HEIGHTS, since, until, np.max, HEIGHT_OF_BOX)


def off_velocities(one: Pair, until: float) -> tuple[float, float]:
    """Root mean square of the difference from the published velocities, of both disks [cm/s]."""
    return off_curves(one, "vy", VELOCITIES, 0.0, until, lambda off: np.sqrt(np.mean(off**2)), 1.0)


def off_curves(one: Pair, column: str, curves: Iterable[np.ndarray], since: float, until: float, norm, unit: float):
    """A norm of the differences from published curves, of both disks."""
    found = []
    for way, curve in zip(one.ways, curves, strict=True):
        points = curve[(curve[:, 0] >= since) & (curve[:, 0] <= until)]
        found.append(float(norm(np.abs(np.interp(points[:, 0], way["time"], way[column]) - points[:, 1]))) / unit)
    return found[0], found[1]


def story(one: Pair) -> str:
    """What is seen, and whether it is what was published."""
    worst, own = (max(off_heights(one, 0.0, kiss)) for kiss in (PAIR_KISSES, one.kiss))
    beside, closest = abs(np.subtract(*one.at(one.time[-1], "x"))), float(one.gap.min())
    reynolds = one.run.summary["reynolds"]
    when = "earlier" if one.kiss > PAIR_KISSES else "later"
    tumbles = "tumbles" if one.tilt[-1] > 45 else "begins to tumble"
    verdict = "within" if worst <= ALLOWED else "NOT within"
    return f"""\
The trailing disk drafts in the wake of the leading one, and comes within the range of the law at {one.kiss:.4f} s; the
published pair kisses at {PAIR_KISSES:g} s, {abs(one.kiss / PAIR_KISSES - 1):.0%} {when}. Until then the heights are
{verdict} {ALLOWED:.0%} of the box, {worst:.2%} at most; until its own kissing, {own:.2%}. The highest Reynolds number
is {reynolds:.0f} with the density of the fluid. Afterwards the pair {tumbles}: at {one.time[-1]:g} s its line of
centres is {one.tilt[-1]:.0f}° from the vertical, and the disks are {beside:.3f} cm beside each other. The
smallest gap is {closest:.5f} cm, {"no overlap" if closest > 0 else "an OVERLAP"}.

![Vorticity](drafting_kissing_tumbling_moments.png)"""


def before_kissing(pairs: dict[str, Pair]) -> str:
    """Errors until kissing."""
    rows = []
    for name, one in pairs.items():
        created, lost = energy_shares(one.run)
        rows.append((
            RUNS[name][0], *(f"{off:.2%}" for off in off_heights(one, 0.0, PAIR_KISSES)),
            *(f"{off:.2f}" for off in off_velocities(one, PAIR_KISSES)), f"{one.kiss:.4f}", f"{one.gap.min():.5f}",
            f"{created:.1e}", f"{lost:.1e}", str(one.run.summary["unknowns"]), f"{one.run.cpu_seconds:.0f}",
        ))  # fmt: skip
    integrated = [drop(curve, curve_y) for curve, curve_y in zip(VELOCITIES, HEIGHTS, strict=True)]
    head = ("run", "height of the trailing disk off the published, of the box", "of the leading disk")
    head += ("velocity of the trailing disk off, root mean square [cm/s]", "of the leading disk", "kisses at [s]")
    head += ("smallest gap [cm]", "energy created, of that put in", "lost", "unknowns", "CPU [s]")
    return f"""\
## Until kissing

{table(head, rows)}

What longer steps take of the energy in the wake is on the page of [wakes](wakes.md).

The published points were read from a figure. Their velocities, integrated from release to kissing, give ways that
differ from those of their own heights by {integrated[0]:.2%} (trailing) and {integrated[1]:.2%} (leading) of the
box: so far the published curves agree with each other."""


def drop(velocity: np.ndarray, height: np.ndarray) -> float:
    """Difference of the ways until kissing by the published velocities and heights, over the box's height."""
    start, times = float(np.round(height[0, 1] * 2) / 2), np.linspace(0.0, PAIR_KISSES, 1000)
    speeds = np.interp(times, *np.vstack([[0.0, 0.0], velocity]).T)
    fallen = float(np.sum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times)))
    return abs(start + fallen - float(np.interp(PAIR_KISSES, *height.T))) / HEIGHT_OF_BOX


def after_kissing(pairs: dict[str, Pair]) -> str:
    """Both laws after kissing, and how far the runs are apart."""
    rows = []
    for name, one in pairs.items():
        later = one.time >= one.kiss
        near = one.gap[later] < one.range
        rows.append((
            RUNS[name][0], f"{one.gap[later].max():.4f}", str(int(np.sum(near[1:] & ~near[:-1])) + 1),
            f"{one.in_contact / (one.time[-1] - one.kiss):.0%}", f"{one.tilt[-1]:.0f}",
            *(f"{off:.1%}" for off in off_heights(one, PAIR_KISSES, PUBLISHED_END)),
        ))  # fmt: skip
    shipped, elastic = pairs["shipped"], pairs["elastic"]
    others = of(pairs, "coarse", "long_step")
    before, until_end = ([shipped.off(one, time) for _, one in others] for time in (shipped.kiss, shipped.time[-1]))
    bounced = elastic.off(pairs["elastic_coarse"], elastic.time[-1])
    largest, bounce = (float(one.gap[one.time >= one.kiss].max()) for one in (shipped, elastic))
    stays = "stays together" if largest < 2 * shipped.range else "does not stay together"
    agree = "agree" if max(before) < AGREEMENT * HEIGHT_OF_BOX else "do NOT agree"
    bounces = "bounces apart" if bounce > 2 * elastic.range else "does not bounce apart"
    head = ("run", "largest gap after kissing [cm]", "times that they meet", "part of the time in contact")
    head += (
        "tilt at the end [degree]",
        "height of the trailing disk off the published after kissing, of the box",
        "leading",
    )
    return f"""\
## After kissing

{table(head, rows)}

With the lossy law the pair {stays}: its gap stays below {largest:.3f} cm. With the elastic law (`contact.restitution =
1`) it {bounces}, up to {bounce:.3f} cm. Until kissing the run with the coarse mesh and step differs from the shipped
one by up to {before[0]:.4f} cm, and the run with the long step alone by {before[1]:.4f} cm: two meshes and two steps
{agree} within {AGREEMENT:.1%} of the box. Until the end the differences are {until_end[0]:.3f} cm and
{until_end[1]:.3f} cm, and the two elastic runs differ by {bounced:.3f} cm; so far the motion after kissing is
reproducible."""


def about_offsets(offsets: dict[float, Pair]) -> str:
    """What the start beside the line does."""
    rows = [
        (
            f"{offset:g}", *(f"{off:.2%}" for off in off_heights(one, 0.0, PAIR_KISSES)), f"{one.kiss:.4f}",
            *(f"{tilt:.0f}" for tilt in np.interp((PAIR_KISSES, 0.2, PUBLISHED_END), one.time, one.tilt)),
            *(f"{off:.1%}" for off in off_heights(one, PAIR_KISSES, PUBLISHED_END)),
        )
        for offset, one in offsets.items()
    ]  # fmt: skip
    times = np.linspace(PAIR_KISSES, PUBLISHED_END, 1000)
    side_by_side = times[np.argmin(np.abs(np.interp(times, *HEIGHTS[0].T) - np.interp(times, *HEIGHTS[1].T)))]
    head = ("offset [cm]", "height of the trailing disk off until kissing, of the box", "leading", "kisses at [s]")
    head += (f"tilt [degree] at {PAIR_KISSES:g} s", "at 0.2 s", f"at {PUBLISHED_END:g} s")
    head += ("height of the trailing disk off after kissing", "leading")
    until = [max(off_heights(one, 0.0, PAIR_KISSES)) for one in offsets.values()]
    return f"""\
## The offset

If a pair falls exactly in line, only round-off and the mesh make it tumble. This holds for the published one too, if
it started in line; its disks are at one height at {side_by_side:.3f} s. Here the trailing disk starts beside the
line. Coarse runs:

{table(head, rows)}

Until kissing the offset changes the largest error by {max(until) - min(until):.2%} of the box at most; after it, when
the pair tumbles."""


def overtaking_pairs(work: Work) -> dict[str, Pair]:
    """Runs until the trailing disk has overtaken."""
    return {
        name: pair(
            work.run(
                f"overtaking_{name}",
                SCENE,
                ["time.end=0.31", f"body.0.position=[{first}, 5.0]", f"body.1.position=[{second}, 4.5]", *others],
            )
        )
        for name, (first, second, others) in OVERTAKING.items()
    }


def about_overtaking(pairs: dict[str, Pair]) -> str:
    """When the two are at one height, over the offset at the start, the mesh and the range of the law."""
    wanted, times = PAIR_OVERTAKES[OVERTAKEN], {name: overtakes(one) for name, one in pairs.items()}
    rows = []
    for name, one in pairs.items():
        (trailing, leading, _), when = OVERTAKING[name], times[name]
        rows.append((
            f"{abs(trailing - leading):g}", "left" if trailing < leading else "right", f"{one.range:g}",
            f"{one.scene['mesh']['size_body']:g}", *(f"{aside(one, time):.4f}" for time in (BESIDE, 0.1960)),
            f"{when:.4f}" if np.isfinite(when) else f"after {one.time[-1]:g}",
            f"{when / wanted - 1:+.1%}" if np.isfinite(when) else "", f"{one.run.cpu_seconds:.0f}",
        ))  # fmt: skip
    head = ("offset [cm]", "trailing disk is", "range [cm]", "cells at disks [cm]")
    head += (
        f"leading disk aside at {BESIDE:g} s [cm]",
        "at 0.196 s",
        "at one height at [s]",
        f"off {OVERTAKEN}",
        "CPU [s]",
    )
    saved = times["c001"] - times["c002"]
    rate, mirrored = np.log(2.0) / saved, times["cm002"] - times["c002"]
    curve = PAIR_LEADING_ASIDE[PAIR_LEADING_ASIDE[:, 0] < UNTIL]
    off = max(abs(aside(pairs["f002"], time) - way) for time, way in curve)
    excess = {name: times[name] / wanted - 1 for name in ("c002short", "f002")}
    misses = [abs(times[name] / wanted - 1) for name in ("c001", "c004")]
    judged = "within" if max(map(abs, excess.values())) < WANTED else "NOT within"
    published = "; ".join(f"{when:.3f} s, {who}" for who, when in PAIR_OVERTAKES.items())
    return f"""\
## Overtaking

When are the two disks at one height? Published are
{published}.
These are {np.ptp(list(PAIR_OVERTAKES.values())):.3f} s apart: the line of centres is an unstable equilibrium, and what
the disks are beside each other grows as exp({rate:.0f} t/s), an offset at the start twice as large saves {saved:.3f} s,
and one that is not known leaves the time open. Uhlmann's disks start d/250 on either side of the line, and Koblitz et
al. repeat his case: in their figure 10a the leading disk is .0009 cm off the middle until 0.09 s, by a digitised copy.
That is an offset of {PAIR_OFFSET:g} cm, twice that of the scene as shipped. The trailing disk's curves are missing in
that copy, so that the time of Koblitz et al. could not be read anew.

{table(head, rows)}

With {PAIR_OFFSET:g} cm the leading disk goes aside as that of Koblitz et al. does: with the finer cells it is off by
{off:.4f} cm at most until {UNTIL:g} s. Half that offset, or twice, misses their time by {misses[0]:.0%} and
{misses[1]:.0%}, on the same mesh and with the same law. The mesh turns the pair too: at {BESIDE:g} s the ways aside are
in proportion to the offset, but for the least one, which is
{1 - 2 * aside(pairs["c0005"], BESIDE) / aside(pairs["c001"], BESIDE):.0%} short; and with the two disks' sides
exchanged {mirrored:.4f} s more pass, as by an offset {-np.expm1(-rate * mirrored):.0%} smaller.
Half the range of the law saves {times["c002"] - times["c002short"]:.4f} s: the disks turn about each other at the
distance that it keeps, and a shorter line of centres turns faster.

With cells as shipped and a step of .0005 s the time is {times["f002"]:.4f} s ({excess["f002"]:+.1%} of {wanted:g} s),
with coarse cells and half the range {times["c002short"]:.4f} s ({excess["c002short"]:+.1%}): {judged} {WANTED:.0%}."""


def overtakes(one: Pair) -> float:
    """When the line of centres is horizontal, not a number if it never is [s]."""
    after = int(np.argmax(one.tilt > 90.0))
    pair_of_steps = slice(after - 1, after + 1)
    return float(np.interp(90.0, one.tilt[pair_of_steps], one.time[pair_of_steps])) if after else np.nan


def aside(one: Pair, time: float) -> float:
    """How far the leading disk is from where it started, across the box [cm]."""
    way = one.ways[1]
    return abs(float(np.interp(time, way["time"], way["x"])) - float(way["x"][0]))


ABOUT = """\
`scenes/drafting_kissing_tumbling.toml`: two disks, one above the other, are released from rest, after Glowinski, Pan,
Hesla, Joseph and Périaux, J. Comput. Phys. 169 (2001) 363. They computed with repulsion of a short range on grids of
h = 1/96 to 1/144 cm. Here the range is .015 cm, about two of their cells; the spring takes up the expected impact, and
its dashpot loses energy (`restitution = 0.1`), since the published disks stay together."""
