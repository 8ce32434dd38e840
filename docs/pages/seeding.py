"""Seeded swarms: fraction, smallest gap, radial distribution and cost."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from page_tools import Page, Work, table
from swarms import DISK, ELLIPSE, ELLIPSOID, SQUARE, Table, least_gap_of_balls, seeded, start

from rigidfluid import Scene
from rigidfluid.core.geometry.arrays import FloatArray

BALL = {"type": "sphere", "radius": 0.085}
DENSE: dict[str, tuple[int, Table, float]] = {
    "disks": (2, DISK, 0.75),
    "ellipses, 2 : 1": (2, ELLIPSE, 0.75),
    "squares": (2, SQUARE, 0.6),
    "balls, thin": (3, BALL, 0.2),
    "balls": (3, BALL, 0.5),
    "ellipsoids, 6 : 4 : 3": (3, ELLIPSOID, 0.5),
}
"""Dimension, shape and fraction of swarms in a box of side 1."""

FRACTIONS, SEEDS, RADIUS = (0.1, 0.2, 0.28), 6, 0.025
"""Fractions of inserted balls whose neighbours are counted, seeds for each, and their radius."""

EDGES = 2.0 * RADIUS * np.linspace(1.0, 2.5, 31)
"""Distances between which neighbours are counted."""

COLOURS = ("#2b83ba", "#1a9641", "#d7191c")


def page(work: Work) -> Page:
    """The table of swarms, and g(r) of inserted balls."""
    rows = work.rows(measured)
    swarms = [row for row in rows if "name" in row]
    curves = [row for row in rows if "curve" in row]
    head = ("bodies", "number", "fraction asked", "reached", "way", "smallest gap over the least", "same by seed", "s")
    text = ABOUT + table(head, map(_told, swarms))
    head = ("fraction", "balls counted", "g at contact", "± by seeds", "1 + 5φ/2", "Carnahan–Starling", "difference")
    text += NEIGHBOURS.format(seeds=SEEDS) + table(head, map(_contact_row, curves)) + "\n"
    return Page("Seeded swarms", text, {"": _figure(curves)})


def measured() -> Iterator[dict[str, Any]]:
    """Rows of swarms, and of numbers of neighbours."""
    seeded(2, DISK, ELLIPSE, SQUARE, number=3)  # kernels are compiled before
    seeded(3, BALL, ELLIPSOID, fraction=0.3)
    for name, (dimension, shape, fraction) in DENSE.items():
        began = time.process_time()
        scene = seeded(dimension, shape, fraction=fraction)
        seconds = time.process_time() - began
        record = scene.swarm[0].seeded
        assert record is not None
        least = 0.01 * _bounding_radius(shape)
        gap = least_gap_of_balls(scene) if "radius" in shape else record.gap
        same = seeded(dimension, shape, fraction=fraction) == scene
        yield {"name": name, "asked": fraction, **record.model_dump(), "gap": gap / least, "same": same, "s": seconds}
    for fraction in FRACTIONS:
        shape = {"type": "sphere", "radius": RADIUS}
        scenes = [seeded(3, shape, fraction=fraction, gap=1e-6, seed=seed) for seed in range(SEEDS)]
        found = [radial_distribution(start(scene).position) for scene in scenes]
        counted = [sum(_is_inside(start(scene).position)) for scene in scenes]
        yield {"curve": fraction, "g": np.array(found).tolist(), "balls": int(sum(counted))}


def radial_distribution(position: FloatArray) -> FloatArray:
    """Neighbours of centres far from walls in shells between `EDGES`, over those of points that are independent, with
    the density of centres far from walls."""
    inner = _is_inside(position)
    distance = np.linalg.norm(position[inner, None] - position, axis=2)
    count = np.histogram(distance[distance > 0.0], EDGES)[0] / np.count_nonzero(inner)
    density = np.count_nonzero(inner) / (1.0 - 2.0 * EDGES[-1]) ** 3
    return np.asarray(count / (density * 4.0 / 3.0 * np.pi * np.diff(EDGES**3)))


def carnahan_starling(fraction: float) -> float:
    """Contact value (1 - φ/2)/(1 - φ)³ of hard spheres in equilibrium."""
    return (1.0 - 0.5 * fraction) / (1.0 - fraction) ** 3


def _is_inside(position: FloatArray) -> FloatArray:
    return np.all((position > EDGES[-1]) & (position < 1.0 - EDGES[-1]), axis=1)


def _bounding_radius(shape: Table) -> float:
    if "points" in shape:
        points = np.array(shape["points"])
        return float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
    return float(shape.get("radius") or max(shape["semi_axes"]))


def _at_contact(row: dict[str, Any]) -> FloatArray:
    """Values at contact (seeds,), of a parabola through those of the first eight shells."""
    middle = 0.5 * (EDGES[1:] + EDGES[:-1])[:8] / (2.0 * RADIUS) - 1.0
    return np.asarray(np.polynomial.polynomial.polyfit(middle, np.array(row["g"])[:, :8].T, 2)[0])


def _told(row: dict[str, Any]) -> Iterator[str]:
    yield from (row["name"], str(row["number"]), f"{row['asked']:g}", f"{row['fraction']:.3f}", row["way"])
    yield from (f"{row['gap']:.3f}", "yes" if row["same"] else "no", f"{row['s']:.1f}")


def _contact_row(row: dict[str, Any]) -> Iterator[str]:
    value, exact = _at_contact(row), carnahan_starling(row["curve"])
    yield from (f"{row['curve']:g}", str(row["balls"]), f"{value.mean():.3f}")
    yield f"{value.std(ddof=1) / np.sqrt(len(value)):.3f}"
    yield from (f"{1.0 + 2.5 * row['curve']:.3f}", f"{exact:.3f}", f"{100.0 * (value.mean() / exact - 1.0):+.1f} %")


def _figure(curves: list[dict[str, Any]]) -> Figure:
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    _draw(left, seeded(2, DISK, ELLIPSE, fraction=0.7))
    middle = 0.5 * (EDGES[1:] + EDGES[:-1]) / (2.0 * RADIUS)
    for row, colour in zip(curves, COLOURS, strict=True):
        right.plot(middle, np.mean(row["g"], axis=0), color=colour, label=f"φ = {row['curve']:g}")
        right.plot(1.0, carnahan_starling(row["curve"]), "o", color=colour)
    right.set(xlabel="distance over diameter", ylabel="g", title="inserted balls; dots: Carnahan–Starling at contact")
    right.legend(frameon=False)
    return figure


def _draw(axes: Any, scene: Scene) -> None:
    pose = start(scene)
    for body, centre, angle in zip(scene.body, pose.position, pose.orientation[:, 0], strict=True):
        half = body.options.get("semi_axes") or [body.options["radius"]] * 2
        colour = COLOURS[0] if "radius" in body.options else COLOURS[2]
        axes.add_patch(Ellipse(centre, 2.0 * half[0], 2.0 * half[1], angle=np.degrees(angle), color=colour, lw=0))
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xticks=[], yticks=[], title="disks and ellipses, φ = 0.7")


ABOUT = """Bodies are seeded by [`[[swarm]]`](../howto/seed-bodies.md) in a box of side 1, with gaps of at least .01 of
the bounding radius. The smallest gap of balls is that of the formula |x - x'| - r - r', and at the faces; of other
shapes it is that of the exact detector, which tests compare with the naive one. Seconds are CPU time of one core to
load the scene.

"""
NEIGHBOURS = """

Balls that are inserted one by one are not a fluid in equilibrium: their distributions of neighbours agree in the first
order of the density and differ in the second (B. Widom, J. Chem. Phys. 44 (1966) 3888, doi:10.1063/1.1726548). The
distribution g(r) counts neighbours of balls that are farther from the walls than the largest r, with {seeds} seeds; g
at contact is that of a parabola through the first eight shells, each .05 of the diameter wide. To first order it is
1 + 5φ/2; hard spheres in equilibrium have (1 - φ/2)/(1 - φ)³ (N. F. Carnahan and K. E. Starling, J. Chem. Phys. 51
(1969) 635, doi:10.1063/1.1672048).

"""
