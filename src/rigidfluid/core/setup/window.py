"""The window that a scene lets go with a body: what may be one, and what holds at its ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.contact.detection import detection_by
from rigidfluid.core.model.conditions import BoundaryCondition, PrescribedPressure
from rigidfluid.core.model.types import Pose
from rigidfluid.core.model.window import CLEARANCE, Window
from rigidfluid.core.setup.boundary import condition_of, conditions
from rigidfluid.core.setup.boundary_tables import placed_tables
from rigidfluid.errors import SceneError
from rigidfluid.registry import suggestion

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import Scene, WindowTable
    from rigidfluid.core.setup.parts import Parts


def build_window(scene: Scene, parts: Parts, pose: Pose) -> Window | None:
    """Window of a scene at the start, None for a scene without one.

    Raises SceneError for an unknown body or axis, a window that does not fit into the domain, or conditions, a domain,
    detector or backend that allow none.
    """
    table = scene.domain.window
    if table is None:
        return None
    _check_parts(parts)
    body = _followed_body(scene, table)
    axis, sign = "xyz".index(table.direction[-1]), -1.0 if table.direction[0] == "-" else 1.0
    if axis >= scene.dimension:
        remedy = f"The scene has {scene.dimension} dimensions."
        raise SceneError("domain.window.direction", repr(table.direction), "along x or y", remedy)
    if parts.domain.between(axis, *(float(corner[axis]) for corner in parts.domain.extent)) is None:
        found = f"a window in a domain of type {parts.domain.name!r}"
        raise SceneError("domain.window", found, "one in a domain that is the same all along, as 'box'", "Remove it.")
    start = float(pose.position[body, axis])
    behind, ahead = start - sign * table.behind, start + sign * table.ahead
    window = Window(parts.domain, body, axis, start, behind, ahead)
    _check_place(scene, parts, window, table)
    _check_bodies(scene, parts, window, pose)
    _check_conditions(scene, window)
    return window


def open_wake_end(conditions: Sequence[BoundaryCondition], window: Window | None) -> tuple[BoundaryCondition, ...]:
    """The conditions on the pieces of the boundary, with that of the end behind a window: a wall there is far away, and
    the wake leaves through the end at zero pressure."""
    if window is None:
        return tuple(conditions)
    held = conditions[window.ends[0]]
    open_end = PrescribedPressure(held.surface, held.name, held.normal)
    return tuple(open_end if each is held and held.is_wall else each for each in conditions)


def _followed_body(scene: Scene, table: WindowTable) -> int:
    names = [body.name for body in scene.body]
    if table.follow not in names:
        allowed = f"a body: {', '.join(names)}"
        raise SceneError("domain.window.follow", repr(table.follow), allowed, suggestion(table.follow, names))
    number = names.index(table.follow)
    if scene.body[number].fixed:
        found = f"{table.follow!r}, which is fixed"
        raise SceneError("domain.window.follow", found, "a body that moves", "Follow another, or remove the window.")
    return number


def _check_parts(parts: Parts) -> None:
    if not parts.wet:
        found = f"a window with backend {parts.backend.part.name!r}, which has no mesh"
        raise SceneError("domain.window", found, "a backend with a mesh", "Remove the window.")
    if detection_by(parts.detector.part).on_mesh:
        found = f"{parts.detector.part.name!r} with a window, whose ends it would take for the domain's"
        allowed = "a detector that needs no mesh"
        raise SceneError("contact.detector", found, allowed, f"Set it to {parts.exact_detector.name!r}.")


def _check_place(scene: Scene, parts: Parts, window: Window, table: WindowTable) -> None:
    """The end behind is open: it may not start at the domain's own end, nor the one ahead where it must stop."""
    behind, ahead = (parts.domain.names[end] for end in window.ends)
    lower, upper = (float(corner[window.axis]) for corner in parts.domain.extent)
    room = window.sign * (window.behind - (lower if window.sign > 0.0 else upper))
    if room < 0.0:
        found = f"{table.behind:g}, which reaches beyond {behind!r} by {-room:.6g}"
        allowed = f"at most {table.behind + room:.6g} for {table.follow!r} at the start"
        raise SceneError("domain.window.behind", found, allowed, "Shorten it, or lengthen the domain behind the body.")
    if window.way <= 0.0:
        found = f"{table.ahead:g}, which reaches beyond {ahead!r} by {-window.way:.6g}, so that the window cannot move"
        allowed = f"less than {table.ahead + window.way:.6g} for {table.follow!r} at the start"
        raise SceneError("domain.window.ahead", found, allowed, "Shorten it, or leave out [domain.window].")


def _check_bodies(scene: Scene, parts: Parts, window: Window, pose: Pose) -> None:
    left = window.left_by(pose, np.array([body.bounding_radius for body in parts.bodies]))
    if left is not None:
        low, high = window.interval(pose)
        raise SceneError(
            f"body.{left}.position",
            f"{pose.position[left].tolist()}, where body {scene.body[left].name!r} is not well in the window",
            f"at least {CLEARANCE:g} of its radii from {low:.6g} and {high:.6g} along {'xyz'[window.axis]}",
            "Move it, or lengthen domain.window.ahead or domain.window.behind.",
        )


def _check_conditions(scene: Scene, window: Window) -> None:
    """Conditions at the ends must hold as well wherever the window is."""
    for number, (table, place) in enumerate(placed_tables(scene, window.domain)):
        if number in window.ends and not condition_of(table, place).holds_along:
            found = f"{table.type!r} on {place.piece.name!r}, an end of the window"
            raise SceneError("boundary", found, "'wall', 'velocity' or 'pressure' there", "Change it.")
    held = conditions(scene, window.domain)
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
