"""The three-sphere swimmer in cubes of three sizes, against the exact flow without walls."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from spheres_in_box import BACK, BACK_FROM_SHORT, Swim, drag, swim_of, swim_scene, without_box
from spheres_on_a_line import cycle as exact_cycle
from spheres_on_a_line import drag as exact_drag

HALVES = (20.0, 30.0, 45.0)

PAIR = 2.2553

PHASES = ("left in", "right in", "left out", "right out")

OTHER_SWIMS: dict[str, tuple[str, list[str]]] = {
    "half_step": ("half the step", ["time.step=0.125"]),
    "back": ("strokes reversed", [BACK]),
    "back_from_short": ("strokes reversed, begun with short arms", [BACK_FROM_SHORT]),
    "fine": ("size_body 0.5", ["mesh.size_body=0.5"]),
    "grown": ("growth 0.4", ["mesh.growth=0.4"]),
    "fine_grown": ("size_body 0.5, growth 0.4", ["mesh.size_body=0.5", "mesh.growth=0.4"]),
}
"""By folder: the heading, and what differs from the scene in the smallest cube."""


def page(work: Work) -> Page:
    """Displacements over boxes, strokes, steps and meshes, and drags."""

    def swim(label: str, **given: Any) -> Swim:
        return swim_of(work.run(label, swim_scene(**given)).history)

    exact = {stroke: float(exact_cycle(10.0, stroke).sum()) for stroke in (0.5, 1.0, 2.0, 4.0)}
    boxes = {far: [swim(f"{far}_{half:g}", half=half, far=far) for half in HALVES] for far in ("wall", "pressure")}
    small, *_, large = boxes["wall"]
    shorter = {stroke: small if stroke == 4.0 else swim(f"stroke_{stroke:g}", stroke=stroke) for stroke in exact}
    others = {label: swim(name, overrides=overrides) for name, (label, overrides) in OTHER_SWIMS.items()}
    text = ABOUT + table(("half-width", *boxes), box_rows(boxes, exact[4.0]))
    text += EACH_STROKE + table(("", *PHASES), stroke_rows(large))
    text += LAW_OF_STROKES.format(ratio=float(np.abs(large.strokes).max() / abs(large.displacement)))
    text += table(("stroke", "measured/stroke²", "exact/stroke²", "off"), law_rows(shorter, exact))
    rows = [swim_row(name, found) for name, found in {"as shipped": small, **others}.items()]
    text += OTHERS + table(("", "displacement", "off the line", "unknowns", "steps", "CPU s"), rows)
    widths = (f"half-width {half:g}" for half in HALVES)
    text += DRAG + table(("spheres", *widths, "no box", "exact", "off"), drag_rows())
    seconds = sum(found.seconds for found in [*chain(*boxes.values()), *shorter.values(), *others.values()])
    text += f"\n\nThe swims of this page took {(seconds - small.seconds) / 60.0:.0f} minutes of CPU time."
    return Page("Swimmer in three dimensions", text, {"": displacements(boxes, exact[4.0])})


def displacements(boxes: dict[str, list[Swim]], exact: float) -> Figure:
    """In a cycle, over the nearness of the walls."""
    figure = Figure(figsize=(6.0, 3.6), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="(arm/half-width of the cube)⁵", ylabel="displacement in a cycle [radii]")
    nearness = (10.0 / np.array(HALVES)) ** 5
    for far, swims in boxes.items():
        axes.plot(nearness, [found.displacement for found in swims], "o-", label=f"faces of type {far}")
    axes.plot(0.0, exact, "k+", markersize=12, label="exact, no walls")
    axes.legend()
    return figure


def box_rows(boxes: dict[str, list[Swim]], exact: float) -> Iterable[tuple[str, ...]]:
    """Displacements by size of the cube, and beyond it by several powers."""
    for number, half in enumerate(HALVES):
        yield f"{half:g}", *(signed_off(swims[number].displacement, exact) for swims in boxes.values())
    for power in (3, 4, 5):
        beyond = [without_box(HALVES, [found.displacement for found in swims], power) for swims in boxes.values()]
        yield f"∞, by 1/half-width^{power}", *(signed_off(value, exact) for value in beyond)
    yield "exact", *([f"{exact:.5f}"] * len(boxes))


def stroke_rows(found: Swim) -> Iterable[tuple[str, ...]]:
    """Each stroke beside the exact one."""
    exact = exact_cycle(10.0, 4.0)
    yield "measured", *(f"{value:+.5f}" for value in found.strokes)
    yield "exact, no walls", *(f"{value:+.5f}" for value in exact)
    yield "off", *(f"{value:+.2%}" for value in found.strokes / exact - 1.0)


def law_rows(swims: dict[float, Swim], exact: dict[float, float]) -> Iterable[tuple[str, ...]]:
    """Displacement over the square of the stroke."""
    for stroke, found in swims.items():
        values = (f"{value / stroke**2:.5f}" for value in (found.displacement, exact[stroke]))
        yield f"{stroke:g}", *values, f"{found.displacement / exact[stroke] - 1.0:+.2%}"


def swim_row(name: str, found: Swim) -> tuple[str, ...]:
    """One cycle's figures."""
    numbers = f"{found.displacement:+.5f}", f"{found.across:.0e}", f"{found.unknowns}", f"{found.steps}"
    return name, *numbers, f"{found.seconds:.0f}"


def drag_rows() -> Iterable[tuple[str, ...]]:
    """Drag of one sphere and of two, in the cubes and beyond them."""
    for name, places in (("one", [0.0]), (f"two, {PAIR} apart", [-PAIR / 2.0, PAIR / 2.0])):
        exact = float(exact_drag(np.array(places), np.ones(len(places)))[0])
        found = np.array([drag(places, half) for half in HALVES])
        beyond = 1.0 / without_box(HALVES, 1.0 / found, 1)
        boxed = (f"{value:.4f}" for value in found)
        yield name, *boxed, f"{beyond:.4f}", f"{exact:.4f}", f"{beyond / exact - 1.0:+.2%}"


def signed_off(value: float, exact: float) -> str:
    """A value and how far it is off."""
    return f"{value:.5f} ({value / exact - 1.0:+.2%})"


ABOUT = """Three spheres of radius 1 in a row, whose arms of 10 shorten and lengthen by 4 in turn
(`scenes/swimmer_3d.toml`): Stokes flow, and spheres too light to have inertia. Exact are series of Stokes' stream
function about each sphere, in a fluid without walls (`tests/support/spheres_on_a_line.py`,
doi:10.1017/S0022112071002854). Displacements are those of the middle sphere, in radii.

## How far walls matter

The swimmer is in the middle of a cube. All faces are walls; or no fluid moves along them, and the traction across
them is zero (`pressure`).

What a box reflects to the swimmer is smooth there, and the middle of a cube is a centre of symmetry: velocities per
force are a constant, 1/half-width, then terms of second order in the places of both spheres, 1/half-width³, then of
fourth, 1/half-width⁵. The constant moves all spheres alike in proportion to the total force, which is zero. Terms of
second order cancel in a cycle as far as forces are in proportion to velocities: the common velocity is Σ x² dx/dt, a
derivative. What is left of them is smaller by radius/arm, so that the fourth order is what shows, with either kind of
faces.

"""

EACH_STROKE = """

Each cube has a mesh of its own; what finer meshes change is below.

## Stroke by stroke

In the largest closed cube:

"""

LAW_OF_STROKES = """

A cycle is what is left of strokes of which the longest is {ratio:.1f} times as long: errors of strokes that do not
cancel are as many times as large in the cycle.

## Displacement and stroke

In the smallest closed cube. The displacement is proportional to the square of the stroke where that is short; arms
with long strokes are shorter on average.

"""

OTHERS = """

## Steps, meshes and the way back

In the smallest closed cube. The mesh is moved with the spheres and not made anew: one that begins round short arms is
stretched when they lengthen, and is less accurate then.

"""

DRAG = """

## Drag

This separates the errors of the mesh and of the box. Spheres move along their line in closed cubes; the drag on one of
them is listed over 6πμ. A box makes it 1/(1/drag - k/half-width), so that a line through 1/drag gives the drag without
a box. The error that is left there is the mesh's. All three spheres of the swimmer have the same, and a factor common
to all forces does not change how it swims.

"""
