"""Course of mechanisms along their strokes: room, resolution of the mesh, steps and cycles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.system import System
from rigidfluid.core.setup.along_strokes import corners, nearest_components, times_along
from rigidfluid.core.setup.model import Model

QUESTION = "stroke"

_MOST_CORNERS_NAMED = 4
_OFF_GRID = 1e-6
"""Greatest distance of a corner from the end of a step, over the step, that counts as being there [1]."""


class _Stroke(NamedTuple):
    """Mechanism of a scene, by its name, and the number of its motion."""

    name: str
    mechanism: Mechanism
    motion: int


def mechanism_findings(model: Model, system: System) -> Iterator[Finding]:
    """Follow the strokes of each mechanism from where it starts: a note on its momentum and its cycles.

    A warning where components come nearer to each other than the mesh resolves, where a component would reach a wall if
    the whole stayed where it starts, and where corners are within steps.
    """
    carried, end = system.motions, model.time.end
    first = len(carried.mass) - len(carried.names)
    for number, (name, mechanism) in enumerate(model.mechanisms_by_name.items()):
        if mechanism.driven:
            stroke = _Stroke(name, mechanism, first + number)
            yield _cycle_finding(stroke, end)
            yield from _component_findings(stroke, model)
            yield from _wall_findings(stroke, model, system, carried)
            yield from _corner_findings(stroke, model.time.step, end)


def _cycle_finding(stroke: _Stroke, end: float) -> Finding:
    text = f"{stroke.name} is carried by its centre of mass: its strokes give no linear momentum, whatever their rates"
    period = stroke.mechanism.period
    if period is None:
        text += "; they do not repeat, and the last values are held beyond their rows"
        return Finding("note", QUESTION, (stroke.name,), text)
    text += f"; they repeat every {figure(period)}, {figure(end / period)} times until the end"
    return Finding("note", QUESTION, (stroke.name,), text, found={"period": period, "cycles": end / period})


def _component_findings(stroke: _Stroke, model: Model) -> Iterator[Finding]:
    nearest, mesh = nearest_components(stroke.mechanism, model.time.end, model.exact_detector), model.fluid.mesh
    if nearest is None:
        return
    both = [stroke.mechanism.components[number] for number in (nearest.first, nearest.second)]
    names = tuple(f"{stroke.name}.{component.name}" for component in both)
    found = {"gap": nearest.gap, "time": nearest.time}
    text = f"{' and '.join(names)} come to a gap of {figure(nearest.gap)} at time {figure(nearest.time)} of the stroke"
    finest = 0.0 if mesh is None else mesh.cells_per_gap * mesh.size_body / 2**mesh.refinements
    if mesh is None or nearest.gap >= finest:
        yield Finding("note", QUESTION, names, text, found=found)
        return
    text += f", and {mesh.cells_per_gap} cells of the finest size need {figure(finest)}"
    size = nearest.gap * 2**mesh.refinements / mesh.cells_per_gap
    remedy = f"Set mesh.size_body to {round_down(size)} or less, allow more mesh.refinements, or shorten the stroke."
    yield Finding("warning", QUESTION, names, text, remedy, found, {"size_body": size})


def _wall_findings(stroke: _Stroke, model: Model, system: System, carried: Motions) -> Iterator[Finding]:
    """The least gap to a surface of the domain while the whole is where it starts."""
    mine = np.flatnonzero(carried.carrier == stroke.motion)
    shapes = [system.bodies[body] for body in mine]
    finder = model.exact_detector(model.exact_detector.Options(), system.bodies, system.walls)
    least, when, names = math.inf, 0.0, ("", "")
    reach = max(2.0 * shape.bounding_radius for shape in shapes)
    for time in times_along(stroke.mechanism, model.time.end):
        contacts = finder.detect(carried.poses(carried.pose, float(time)), None, reach)
        for row in np.flatnonzero(contacts.at_wall & np.isin(contacts.body_a, mine)):
            if contacts.gap[row] < least:
                least, when = float(contacts.gap[row]), float(time)
                names = system.surfaces[contacts.body_a[row]], system.surfaces[contacts.body_b[row]]
    if least > 0.0:
        return
    text = f"{names[0]} would reach {names[1]} at time {figure(when)} of the stroke if the whole stayed where it starts"
    yield Finding("warning", QUESTION, names, text, "Start farther from it.", {"gap": least, "time": when})


def _corner_findings(stroke: _Stroke, step: float, end: float) -> Iterator[Finding]:
    """Warn of corners at which no step ends by itself, so that steps are halved towards them."""
    times = list(corners(stroke.mechanism, min(end, stroke.mechanism.period or end)))
    off = [time for time in times if abs(time / step - round(time / step)) > _OFF_GRID]
    if not off:
        return
    named = ", ".join(figure(time) for time in off[:_MOST_CORNERS_NAMED])
    text = f"{stroke.name} changes its rates at times {named} within steps, which are halved until one ends there"
    remedy = "Choose a time.step that divides the times of the rows, or a smooth stroke."
    yield Finding("warning", QUESTION, (stroke.name,), text, remedy, {"corners": len(off)})
