"""Case 7 of arXiv:2402.19093, its halvings and its other readings."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from page_tools import Page, Run, Work, table

from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.post.reports.plane import fine_triangles
from rigidfluid.post.reports.scale import COLOURMAP
from rigidfluid.post.reports.style import BODY

COARSER = ["mesh.size_body=2.4e-4", "mesh.size=1.2e-3", "mesh.refine.0.size=4e-4"]

FINER = ["mesh.size_body=6e-5", "mesh.size=3e-4", "mesh.refine.0.size=1e-4"]

UNTIL_BOTH_ARE_THROUGH = ["time.step=4e-5", "time.end=0.008"]

OTHERWISE = ["body.0.position=[-0.0068, 0.0017]", "body.1.position=[-0.0068, -0.0017002125]"]

HIGHER = ["boundary.0.pressure=5410.0", "time.step=4e-6", "time.end=0.00095", "output.every=2e-5"]

STENOSIS = {
    "coarse": ("d/3.5, 4e-5", [*COARSER, *UNTIL_BOTH_ARE_THROUGH]),
    "step4": ("d/7, 4e-5", UNTIL_BOTH_ARE_THROUGH),
    "fine": ("d/14, 4e-5", [*FINER, *UNTIL_BOTH_ARE_THROUGH]),
    "step2": ("d/7, 2e-5", ["time.step=2e-5", "time.end=0.008"]),
    "shipped": ("d/7, 1e-5, as shipped", []),
    "mirrored": ("d/7, 4e-5, the lower disk farther out", [*OTHERWISE, *UNTIL_BOTH_ARE_THROUGH]),
    "contact": ("d/7, 4e-5, law `contact`", ["contact.law=contact", *UNTIL_BOTH_ARE_THROUGH]),
    "strong": ("d/7, 4e-6, 5410 dyn/cm²", HIGHER),
}
"""By folder: mesh.size_body and time.step, and what differs from the scene as shipped."""


PUBLISHED = ("lower", "upper")
"""The order in which the disks pass."""

DIAMETER, MOMENTS = 8.5e-4, (0.0042, 0.0054, 0.0060, 0.0066)


def page(work: Work) -> Page:
    """All runs in a table, and what decides which disk passes first."""
    runs = {
        name: work.run(name, "stenosis.toml", overrides, may_stop=True) for name, (_, overrides) in STENOSIS.items()
    }
    head = ("disk's edges, step [s]", "order", "the first at -3d [ms]", "in the throat [ms]", "between them [ms]")
    head += ("the second goes back [d]", "smallest gap [d]", "created, lost [%]")
    head += ("steps, rejected, new meshes, failed", "unknowns", "CPU [s]", "until [ms]")
    rows = [(STENOSIS[name][0], *figures(run)) for name, run in runs.items()]
    passages = {name: passage(run) for name, run in runs.items()}
    text = ABOUT.format(figures=table(head, rows), **judged(passages), **law_forces(runs["shipped"]))
    return Page("Two disks in a stenosed artery", text, {"": picture(runs["shipped"])})


@dataclass(frozen=True)
class Passage:
    """The disks in the ``order`` in which they pass the throat; times [ms] of the first 3d before it and of both in it.

    Lengths [d]: how far the second goes back, the lead of the lower one at 4 ms, and how far past the throat the first
    is at the end.
    """

    order: tuple[str, str]
    near: float
    through: tuple[float, float]
    back: float
    lead: float
    gone: float

    @property
    def between(self) -> float:
        """Of the disks in the throat [ms]."""
        return self.through[1] - self.through[0]


def passage(run: Run) -> Passage:
    """How the disks of a run pass."""
    ways = {name: way_of(run, name) for name in ("upper", "lower")}
    passes = {name: float(np.interp(0.0, way["x"], way["time"], right=np.inf)) for name, way in ways.items()}
    first, second = sorted(passes, key=passes.__getitem__)
    x = ways[second]["x"]
    at_4_ms = {name: np.interp(4.0, way["time"], way["x"]) for name, way in ways.items()}
    return Passage(
        order=(first, second),
        near=float(np.interp(-3.0, ways[first]["x"], ways[first]["time"])),
        through=(passes[first], passes[second]),
        back=float((np.maximum.accumulate(x) - x).max()),
        lead=float(at_4_ms["lower"] - at_4_ms["upper"]),
        gone=float(ways[first]["x"][-1]),
    )


def judged(found: dict[str, Passage]) -> dict[str, object]:
    """What `ABOUT` says of the passages."""
    shipped, halved = found["shipped"], ("coarse", "step4", "fine", "step2", "shipped")
    meshes, steps = (
        (found[name] for name in ("coarse", "step4", "fine")),
        (found[n] for n in ("step4", "step2", "shipped")),
    )
    told: dict[str, object] = {
        "as_published": "So it is here." if shipped.order == PUBLISHED else "It is not so here.",
        "stays": "stays" if len({found[name].order for name in halved}) == 1 else "does not stay",
        "leads": ", ".join(
            f"{found[name].lead:.1e} d with edges of {STENOSIS[name][0].split(',')[0]}"
            for name in ("coarse", "step4", "fine")
        ),
        "mirrored": found["mirrored"].lead,
        "asymmetry": abs(found["mirrored"].lead + found["step4"].lead),
        "decides": "decides" if found["mirrored"].order == found["step4"].order[::-1] else "does not decide",
        "strong": found["strong"],
        "through": shipped.through[1],
        "gone": shipped.gone,
        "strong_over_shipped": found["strong"].back / shipped.back,
    }
    for name, series in (("mesh", list(meshes)), ("step", list(steps))):
        pairs = list(pairwise(series))
        told[f"{name}_near"] = ", ".join(f"{abs(a.near - b.near):.4f}" for a, b in pairs)
        told[f"{name}_between"] = ", ".join(f"{abs(a.between - b.between):.4f}" for a, b in pairs)
        told[f"{name}_through"] = ", ".join(f"{abs(a.through[0] - b.through[0]):.3f}" for a, b in pairs)
    return told


def law_forces(run: Run) -> dict[str, float]:
    """Greatest forces of the law that joins centres, and of that which joins contact points [dyn/cm]."""
    law = run.scene.to_dict()["contact"]
    numbers = {"disks": law["epsilon"], "walls": law["epsilon_wall"]}
    joined = {f"{name}_joined": 4.0 / 27.0 * law["range"] ** 3 / epsilon for name, epsilon in numbers.items()}
    return joined | {name: DIAMETER * law["range"] ** 2 / epsilon for name, epsilon in numbers.items()}


def way_of(run: Run, name: str) -> dict[str, np.ndarray]:
    """The rows of one body, lengths in diameters of the disks and times in ms."""
    bodies = run.history.bodies
    own = bodies["body"] == name
    units = {"time": 1e-3, "x": DIAMETER, "y": DIAMETER, "gap": DIAMETER}
    return {column: bodies[column][own] / unit for column, unit in units.items()}


def picture(run: Run) -> Figure:
    """The flow at four moments, the disks' paths, their gaps, and the balance of energy."""
    figure = Figure(figsize=(12.0, 10.0), dpi=100, layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(5, 6))
    series, moments = dict(read_pvd(run.folder / "fields.pvd")), top.subplots(2, 2, sharex=True, sharey=True).ravel()
    for axes, moment in zip(moments, MOMENTS, strict=True):
        at = min(series, key=lambda time: abs(time - moment))
        fields = read_vtu(series[at])
        speed, triangles = np.linalg.norm(fields.velocity, axis=1), fine_triangles(fields)
        triangles.x, triangles.y = triangles.x / DIAMETER, triangles.y / DIAMETER
        colours = axes.tripcolor(triangles, speed, shading="gouraud", cmap=COLOURMAP, vmin=0.0, vmax=7.0)
        axes.set(title=f"{1e3 * at:.1f} ms", xlim=(-10, 10), aspect="equal", facecolor=BODY)
    top.colorbar(colours, ax=moments, label="speed [cm/s]")
    panels = bottom.subplot_mosaic([["path", "path"], ["gap", "energy"]])
    panels["path"].set(
        xlabel="along the channel [d]", ylabel="across [d]", xlim=(-16, 16), ylim=(-4, 4), aspect="equal"
    )
    panels["gap"].set(xlabel="time [ms]", ylabel="gap [d]", ylim=(0, 2))
    panels["energy"].set(xlabel="time [ms]", ylabel="residual over energy put in [%]")
    for side in (-4.0, 4.0):
        panels["path"].add_patch(Circle((0.0, side), 3.125, facecolor="lightgrey"))
    paths = {name: way_of(run, name) for name in ("upper", "lower")}
    for name, way in paths.items():
        panels["path"].plot(way["x"], way["y"], label=name)
        for moment in MOMENTS:
            centre = [np.interp(1e3 * moment, way["time"], way[along]) for along in ("x", "y")]
            panels["path"].add_patch(Circle(centre, 0.5, fill=False))
        panels["gap"].plot(way["time"], way["gap"], label=f"{name} to the nearest")
    upper, lower = paths.values()
    apart = np.hypot(upper["x"] - lower["x"], upper["y"] - lower["y"]) - 1.0
    panels["gap"].plot(upper["time"], apart, "k:", label="between the disks")
    panels["gap"].axhline(3e-4 / DIAMETER, color="grey", ls="--", label="contact.range")
    energy, put_in = run.history.energy, run.summary["energy"]["put_in"]
    panels["energy"].plot(1e3 * energy["time"], 100 * energy["residual"] / put_in)
    panels["path"].legend()
    panels["gap"].legend()
    return figure


def figures(run: Run) -> tuple[str, ...]:
    """What the page tells of one run."""
    found, summary = passage(run), run.summary
    counts = ("steps", "rejected_steps", "remeshes", "failed_remeshes")
    return (
        ", ".join(found.order),
        f"{found.near:.4f}",
        ", ".join(f"{time:.4f}" for time in found.through),
        f"{found.between:.4f}",
        f"{found.back:.3f}",
        f"{summary['smallest_gap'] / DIAMETER:.4f}",
        f"{100 * summary['energy']['created']:.3f}, {100 * summary['energy']['lost']:.3f}",
        ", ".join(str(summary[name]) for name in counts),
        f"{summary['unknowns']}",
        f"{run.cpu_seconds:.0f}",
        f"{1e3 * summary['time']:.2f}",
    )


ABOUT = """`scenes/stenosis.toml`, case 7 of arXiv:2402.19093: pressure drives two disks of diameter
d = 8.5e-4 cm through a channel that two round bumps narrow to 1.75d. They are as heavy as the fluid and start 8d before
the throat, 2d above and below the middle; the upper one is d/4000 farther out. Published is the order alone: the lower
disk passes first, and the upper one stops, goes back and follows (Van Landeghem et al.; Li et al., Phys. Rev. E 69
(2004) 031919). {as_published} In the picture the circles on the paths are the disks at the four moments.

{figures}

* At -3d: when the disk that passes first is 3d before the throat; in the throat: when the first and the second are in
  its middle; `inf` is never. The second goes back by so much against the stream. Gaps are the smallest of the run.
  Created and lost are the signed residual of the energy, over what the pressure put in; of what was lost, friction
  in impacts is taken off.
* **Halvings.** The order {stays}. The time at -3d differs by {mesh_near} ms when edges are halved twice, by {step_near}
  ms when steps are; the time between the two by {mesh_between} and {step_between} ms, the time of the first in the
  throat by {mesh_through} and {step_through} ms. Where the disks meet, the lead of one grows fast, so that a small
  change of it, as by another mesh, moves all that follows.
* **What decides the order.** The lower disk's lead at 4 ms is {leads}, and {mirrored:.1e} d where it is the one farther
  out (the sixth row): meshes that are not symmetric add {asymmetry:.0e} d. So the d/4000 {decides} with edges of d/7.
* **The law.** The force joins centres: at most d·range²/ε = {disks:.2f} dyn/cm between the disks and {walls:.1f} at
  walls. The form that joins contact points gives {disks_joined:.2f} and {walls_joined:.2f} at most and nothing at
  contact.
* **The pressure.** The paper's "541 Pa" is 5410 dyn/cm². The disks then pass within {strong.through[1]:.2f} ms, and the
  second goes back {strong_over_shipped:.0%} as far. The scene has 541 dyn/cm², with which they pass within
  {through:.1f} ms; in the paper's pictures it takes .01 s.
* **To the outlet.** Nothing repels a disk there. At the end of the scene the first one is {gone:.1f} d past the
  throat."""
