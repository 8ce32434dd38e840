"""Case 5 of arXiv:2402.19093 to its end at three resolutions, and on until both disks lie on the floor."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from scipy.optimize import brentq

from pages._flow import vorticity_pictures
from pages._one_knob import OneKnob
from pages._pair import Pair, energy_shares

SCENE, END, REST = "two_disks.toml", 5.0, 10.0
RUNS = {
    "coarse": ("size_body 0.02, step 0.002", ["mesh.size_body=0.02", "time.step=0.002"]),
    "shipped": ("size_body 0.01, step 0.001", []),
    "fine": ("size_body 0.005, step 0.002", ["mesh.size_body=0.005", "time.step=0.002"]),
}
"""By folder: the heading, and what differs from the scene as shipped."""

AT_REST = 1e-3
"""Speed below which a disk rests [cm/s]."""

MOMENTS = (0.9, 1.5, 2.4, 3.5)
"""Drafting, kissing, tumbling, apart [s]."""

BEFORE_KISSING = 1.0
"""When the height of the trailing disk is compared in the study [s]."""

STUDY = OneKnob(
    SCENE,
    name=f"height of the trailing disk at {BEFORE_KISSING:g} s [cm]",
    common=[f"time.end={BEFORE_KISSING}", "output.every=0.5"],
    finest=["mesh.size_body=0.005", "mesh.size=0.08", "time.step=0.0005"],
    values={
        "mesh.size_body": (0.04, 0.02, 0.005),
        "mesh.size": (0.3,),
        "time.step": (0.008, 0.004, 0.002, 0.0005),
        "mesh.order": (1,),
        "mesh.remesh_every": (0.05,),
        "mesh.quality": (0.1, 0.4),
    },
    figure=lambda run: pair(run).at(BEFORE_KISSING, "y")[0],
)


def pair(run: Run) -> Pair:
    """The two disks of a run."""
    return Pair(run, "upper_disk", "lower_disk")


def page(work: Work) -> Page:
    """Ways, gap and force of the pair, pictures of the vorticity, what is left of them at the end."""
    pairs = {name: pair(work.run(name, SCENE, overrides)) for name, (_, overrides) in RUNS.items()}
    rest = pair(work.run("rest", SCENE, [*RUNS["coarse"][1], f"time.end={REST}"]))
    study = STUDY.measure(work)
    figures = {
        "": over_time(pairs),
        "_moments": vorticity_pictures(pairs["shipped"].run, MOMENTS, height=3.0, scale=40.0),
        "_study": study.plot(),
    }
    parts = (story(pairs["shipped"]), figures_of(pairs), reproducible(pairs), at_rest(rest), study.section("two_disks"))
    return Page("Two disks", "\n\n".join(parts), figures)


def over_time(pairs: dict[str, Pair]) -> Figure:
    """Heights, ways, gap between the disks, contact force over the weight of one."""
    figure = Figure(figsize=(9.0, 6.4), dpi=120, layout="constrained")
    heights, ways, gaps, forces = figure.subplots(2, 2).ravel()
    for (name, one), style in zip(pairs.items(), (":", "-", "--"), strict=True):
        for way, colour in zip(one.ways, ("C0", "C1"), strict=True):
            heights.plot(one.time, way["y"], style, color=colour)
            ways.plot(way["x"], way["y"], style, color=colour)
        gaps.semilogy(one.time, one.gap, style, color="k", label=RUNS[name][0])
        forces.plot(one.time, np.hypot(*(one.ways[0][key] for key in ("cfx", "cfy"))) / weight(one), style, color="k")
    gaps.axhline(pairs["shipped"].range, color="C2", linewidth=0.8, label="range of the law")
    gaps.legend(fontsize=7)
    heights.set(xlabel="time [s]", ylabel="height [cm]", title="blue: trailing disk, orange: leading disk")
    ways.set(xlabel="x [cm]", ylabel="height [cm]", xlim=(0, 2))
    gaps.set(xlabel="time [s]", ylabel="gap between the disks [cm]")
    forces.set(xlabel="time [s]", ylabel="contact force / submerged weight")
    return figure


def weight(one: Pair) -> float:
    """Submerged, of a disk [dyn/cm]."""
    fluid, body = one.scene["fluid"], one.scene["body"][0]
    return float((body["density"] - fluid["density"]) * np.pi * one.radius**2 * abs(fluid["gravity"][1]))


def story(one: Pair) -> str:
    """What is seen."""
    closest, fastest = float(one.gap.min()), max(np.abs(way["vy"]).max() for way in one.ways)
    lowest = min(way["y"].min() for way in one.ways) - one.radius
    floor = (
        "reaches the floor" if lowest < one.range else f"has reached the floor, the lower is {lowest:.2f} cm above it"
    )
    return f"""\
`scenes/two_disks.toml`, case 5 of [arXiv:2402.19093](https://arxiv.org/abs/2402.19093), to its end at {END:g} s.
The disks start {one.gap[0]:.3g} cm apart, the upper one .001 cm beside the line of the lower one, and fall at up to
{fastest:.2f} cm/s (Reynolds number {one.run.summary["reynolds"]:.1f} with the density of the fluid). The trailing disk
drafts in the wake of the leading one, and comes within the range of the law at {one.kiss:.3f} s (kissing). They stay
in contact for {one.in_contact:.2f} s, while their line turns from the vertical (tumbling): they part at
{one.parts:.2f} s and are side by side at {one.side_by_side:.2f} s. The smallest gap is {closest:.5f} cm,
{"no overlap" if closest > 0 else "an OVERLAP"}. At {END:g} s {"one" if lowest < one.range else "neither"} {floor}.

![Vorticity](two_disks_moments.png)"""


def figures_of(pairs: dict[str, Pair]) -> str:
    """In a table."""
    rows = []
    for name, one in pairs.items():
        created, lost = energy_shares(one.run)
        places = [f"({x:.3f}, {y:.3f})" for x, y in zip(one.at(END, "x"), one.at(END, "y"), strict=True)]
        summary = one.run.summary
        rows.append((
            RUNS[name][0], f"{one.at(BEFORE_KISSING, 'y')[0]:.4f}", f"{one.kiss:.3f}", f"{one.parts:.3f}",
            f"{one.side_by_side:.3f}", f"{one.gap.min():.5f}", *places, f"{created:.1e}", f"{lost:.1e}",
            f"{summary['remeshes']}, {summary['rejected_steps']}", f"{one.run.cpu_seconds:.0f}",
        ))  # fmt: skip
    head = ("resolution", f"trailing disk at {BEFORE_KISSING:g} s [cm]", "kissing at [s]", "parting at [s]")
    head += ("side by side at [s]", "smallest gap [cm]", f"trailing disk at {END:g} s", "leading disk")
    head += ("energy created, of that put in", "lost", "new meshes, rejected steps", "CPU [s]")
    return table(head, rows)


def reproducible(pairs: dict[str, Pair]) -> str:
    """How far the runs are from the finest, before and after tumbling."""
    *others, last = pairs
    finest = pairs[last]
    before = {name: finest.off(pairs[name], finest.kiss) for name in others}
    after = {name: finest.off(pairs[name], END) for name in others}
    verdict = "no more than" if max(after.values()) < 2 * finest.radius else "more than"
    told = "; ".join(f"{RUNS[name][0]}: {before[name]:.4f} cm and {after[name]:.3f} cm" for name in others)
    return f"""\
Largest distance of a disk from where it is in the last run, until kissing and until the end: {told}. At the end the
runs are {verdict} a diameter ({2 * finest.radius:g} cm) apart, though tumbling grows from .001 cm."""


def at_rest(one: Pair) -> str:
    """The gaps below both disks after the long run, beside those at which the law bears them."""
    law = one.scene["contact"]
    expected = brentq(
        lambda gap: (2 * one.radius + gap) * (one.range - gap) ** 2 / law["epsilon_wall"] - weight(one), 0.0, one.range
    )
    rows = []
    for way in one.ways:
        gap = way["y"][-1] - one.radius
        landed = way["time"][np.argmax(way["y"] - one.radius < one.range)] if gap < one.range else np.nan
        rows.append((
            str(way["body"][0]), f"{landed:.3f}", f"{(way['y'] - one.radius).min():.5f}", f"{gap:.5f}",
            f"{expected:.5f}", f"{way['cfy'][-1] / weight(one):.4f}", f"{way['vy'][-1]:.1e}", f"{way['vx'][-1]:.1e}",
        ))  # fmt: skip
    created, lost = energy_shares(one.run)
    head = ("disk", "within range of the floor at [s]", "smallest gap there [cm]", f"gap at {REST:g} s [cm]")
    head += (
        "gap at which the law bears its weight [cm]",
        "contact force / weight",
        "velocity up [cm/s]",
        "along the floor [cm/s]",
    )
    creeps = max(abs(way["vx"][-1]) for way in one.ways) > AT_REST
    return f"""\
## On the floor

The scene with {RUNS["coarse"][0]} and `time.end = {REST:g}`. Energy created: {created:.1e} of that put in,
lost: {lost:.1e}. At the end the disks {"still move along the floor, whose law has no friction" if creeps else "rest"}.

{table(head, rows)}"""
