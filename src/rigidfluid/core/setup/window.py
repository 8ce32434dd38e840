"""The window that a model lets go with a body: what may be one, and what holds at its ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.contact.path.detection import detection_by
from rigidfluid.core.fluid.conditions import BoundaryCondition, PrescribedPressure
from rigidfluid.core.model.types import Pose
from rigidfluid.core.model.window import CLEARANCE, Window
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.scene.domain_table import WindowTable
    from rigidfluid.core.setup.model import Model


def build_window(model: Model, pose: Pose) -> Window | None:
    """Window of a model at the start, None without one.

    Raises SceneError for an unknown body or axis, a window that does not fit into the domain, or conditions, a domain,
    detector or backend that allow none.
    """
    table, domain = model.window, model.domain
    if table is None:
        return None
    _check_parts(model)
    body = _followed_body(model, table)
    axis, sign = "xyz".index(table.direction[-1]), -1.0 if table.direction[0] == "-" else 1.0
    if axis >= model.dimension:
        remedy = f"The scene has {model.dimension} dimensions."
        raise SceneError("domain.window.direction", repr(table.direction), "along x or y", remedy)
    if domain.between(axis, *(float(corner[axis]) for corner in domain.extent)) is None:
        found = f"a window in a domain of type {domain.name!r}"
        raise SceneError("domain.window", found, "one in a domain that is the same all along, as 'box'", "Remove it.")
    start = float(pose.position[body, axis])
    behind, ahead = start - sign * table.behind, start + sign * table.ahead
    window = Window(domain, body, axis, start, behind, ahead)
    _check_place(window, table)
    _check_bodies(model, window, pose)
    _check_conditions(model, window)
    return window


def open_wake_end(conditions: Sequence[BoundaryCondition], window: Window | None) -> tuple[BoundaryCondition, ...]:
    """The conditions on the pieces of the boundary, with that of the end behind a window: a wall there is far away, and
    the wake leaves through the end at zero pressure."""
    if window is None:
        return tuple(conditions)
    held = conditions[window.ends[0]]
    open_end = PrescribedPressure(held.surface, held.name, held.normal)
    return tuple(open_end if each is held and held.is_wall else each for each in conditions)


def _followed_body(model: Model, table: WindowTable) -> int:
    names = [body.name for body in model.all_bodies]
    if table.follow not in names:
        allowed = f"a body: {', '.join(names)}"
        raise SceneError(
            "domain.window.follow", repr(table.follow), allowed, suggestion(table.follow, names) or "Name one of these."
        )
    number = names.index(table.follow)
    if model.all_bodies[number].fixed:
        found = f"{table.follow!r}, which is fixed"
        raise SceneError("domain.window.follow", found, "a body that moves", "Follow another, or remove the window.")
    return number


def _check_parts(model: Model) -> None:
    if not model.wet:
        found = f"a window with backend {model.fluid.backend.part.name!r}, which has no mesh"
        raise SceneError("domain.window", found, "a backend with a mesh", "Remove the window.")
    detector = model.detection[0].part
    if detection_by(detector).on_mesh:
        found = f"{detector.name!r} with a window, whose ends it would take for the domain's"
        allowed = "a detector that needs no mesh"
        raise SceneError("contact.detector", found, allowed, f"Set it to {model.exact_detector.name!r}.")


def _check_place(window: Window, table: WindowTable) -> None:
    """The end behind is open: it may not start at the domain's own end, nor the one ahead where it must stop."""
    behind, ahead = (window.domain.names[end] for end in window.ends)
    lower, upper = (float(corner[window.axis]) for corner in window.domain.extent)
    room = window.sign * (window.behind - (lower if window.sign > 0.0 else upper))
    if room < 0.0:
        found = f"{table.behind:g}, which reaches beyond {behind!r} by {-room:.6g}"
        allowed = f"at most {table.behind + room:.6g} for {table.follow!r} at the start"
        raise SceneError("domain.window.behind", found, allowed, "Shorten it, or lengthen the domain behind the body.")
    if window.way <= 0.0:
        found = f"{table.ahead:g}, which reaches beyond {ahead!r} by {-window.way:.6g}, so that the window cannot move"
        allowed = f"less than {table.ahead + window.way:.6g} for {table.follow!r} at the start"
        raise SceneError("domain.window.ahead", found, allowed, "Shorten it, or leave out [domain.window].")


def _check_bodies(model: Model, window: Window, pose: Pose) -> None:
    left = window.left_by(pose, np.array([shape.bounding_radius for shape in model.shapes]))
    if left is not None:
        low, high = window.interval(pose)
        raise SceneError(
            f"body.{left}.position",
            f"{pose.position[left].tolist()}, where body {model.all_bodies[left].name!r} is not well in the window",
            f"at least {CLEARANCE:g} of its radii from {low:.6g} and {high:.6g} along {'xyz'[window.axis]}",
            "Move it, or lengthen domain.window.ahead or domain.window.behind.",
        )


def _check_conditions(model: Model, window: Window) -> None:
    """Conditions at the ends must hold as well wherever the window is."""
    held = model.conditions
    for end in sorted(window.ends):
        if not held[end].prescribes_tangential:
            found = f"{held[end].type!r} on {held[end].name!r}, an end of the window"
            raise SceneError("boundary", found, "'wall', 'velocity' or 'pressure' there", "Change it.")
    behind, ahead = (held[end] for end in window.ends)
    if ahead.is_open and (behind.is_open or behind.is_wall):
        found = f"'pressure' on {ahead.name!r}, ahead of a window that is open behind"
        allowed = "a 'wall' there, or the 'velocity' of the flow far away"
        raise SceneError("boundary", found, allowed, "The flow between two open ends depends on the whole length.")
    sliding = _sliding(held, window)
    if sliding and (behind.is_wall or ahead.is_wall):
        found = f"a velocity on {sliding[0]!r}, along a window with a wall at its end"
        raise SceneError("boundary", found, "sides at rest, as the fluid far away is", "Give the ends a 'velocity'.")


def _sliding(held: Sequence[BoundaryCondition], window: Window) -> list[str]:
    """Names of the sides that move the fluid far away from all bodies."""
    sides = [side for number, side in enumerate(held) if number not in window.ends]
    return [side.name for side in sides if side.holds_all and not side.rests]
