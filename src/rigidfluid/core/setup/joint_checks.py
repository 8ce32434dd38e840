"""Tables of joints, held directions and springs that contradict themselves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.errors import SceneError
from rigidfluid.registry import suggestion

if TYPE_CHECKING:
    from rigidfluid.core.model.types import BoolArray
    from rigidfluid.core.scene.scene import BodyTable, JointTable, Scene, SpringTable

DIRECTIONS = {2: ("x", "y", "rotation"), 3: ("x", "y", "z", "rx", "ry", "rz")}
"""Names of the d+k directions of motion."""


def check_joints(scene: Scene) -> None:
    """Refuse, with SceneError, invalid tables of joints and of bodies' links to the ground, before anything is
    built."""
    for number, body in enumerate(scene.body):
        _check_free(body, scene.dimension, f"body.{number}")
        _check_spring(body, scene.dimension, f"body.{number}")
    names = Counter(joint.name for joint in scene.joint)
    for name in names:
        if names[name] > 1 or name in (body.name for body in scene.body):
            raise SceneError("joint.name", repr(name), "a name that no other joint or body has", "Rename it.")
    for number, joint in enumerate(scene.joint):
        _check_ends(scene, joint, f"joint.{number}")
        (_check_hinge if joint.type == "hinge" else _check_rod)(joint, scene.dimension, f"joint.{number}")


def held_directions(body: BodyTable, dimension: int) -> BoolArray:
    """Directions (d+k,) in which the key `free` of a body's table holds it."""
    names = DIRECTIONS[dimension]
    return np.array([body.free is not None and name not in body.free for name in names])


def _check_free(body: BodyTable, dimension: int, at: str) -> None:
    if body.free is None:
        return
    names, given = DIRECTIONS[dimension], list(body.free)
    _refuse_beside(body, "free", at)
    for name in given:
        if name not in names or given.count(name) > 1:
            found = f"{name!r} twice" if name in names else f"{name!r} in {dimension}D"
            raise SceneError(f"{at}.free", found, f"each of {', '.join(names)} at most once", "Correct the names.")
    if len(given) == len(names):
        raise SceneError(f"{at}.free", f"{given}, which holds nothing", "some of them", "Leave `free` out.")
    if not given:
        raise SceneError(f"{at}.free", "none", "one direction or more", "Set `fixed = true` in its place.")
    for key, part in (("velocity", names[:dimension]), ("angular_velocity", names[dimension:])):
        for held, speed in zip(part, getattr(body, key) or (), strict=False):
            if held not in body.free and speed != 0.0:
                raise SceneError(f"{at}.{key}", f"{speed:g} along {held!r}, which is held", "0 there", "Set it to 0.")


def _check_spring(body: BodyTable, dimension: int, at: str) -> None:
    if body.spring is None:
        return
    _refuse_beside(body, "spring", at)
    names, held = DIRECTIONS[dimension], held_directions(body, dimension)
    for straight, turning in (("stiffness", "angular_stiffness"), ("damping", "angular_damping")):
        for key, part in ((straight, slice(0, dimension)), (turning, slice(dimension, None))):
            given = getattr(body.spring, key) or ()
            for name, value, is_held in zip(names[part], given, held[part], strict=False):
                if is_held and value > 0.0:
                    found = f"{value:g} along {name!r}, which is held"
                    raise SceneError(f"{at}.spring.{key}", found, "0 there", "Set it to 0, or add it to `free`.")
    if not any(any(values) for values in _strengths(body.spring)):
        raise SceneError(f"{at}.spring", "no stiffness and no damping above 0", "one of them", "Add it.")
    if body.spring.rest is not None and not any(body.spring.stiffness or ()):
        raise SceneError(f"{at}.spring.rest", "it without `stiffness`", "`rest` beside `stiffness`", "Remove it.")


def _strengths(spring: SpringTable) -> list[tuple[float, ...]]:
    keys = ("stiffness", "damping", "angular_stiffness", "angular_damping")
    return [getattr(spring, key) or () for key in keys]


def _refuse_beside(body: BodyTable, key: str, at: str) -> None:
    """Whose motion is given cannot be held or pulled."""
    for other in ("fixed", "prescribed"):
        if getattr(body, other):
            raise SceneError(f"{at}.{key}", f"it beside {other!r}", "one of them", f"Remove `{key}` or `{other}`.")


def _check_ends(scene: Scene, joint: JointTable, at: str) -> None:
    names = [body.name for body in scene.body]
    for number, name in enumerate(joint.between):
        if name not in names:
            shown = ", ".join(names[:20]) + (", …" if len(names) > 20 else "")
            remedy = suggestion(name, names) or "Name a body, or a component as 'mechanism.component'."
            raise SceneError(f"{at}.between.{number}", f"{name!r}, no body", f"one of {shown}", remedy)
    if len(set(joint.between)) < len(joint.between):
        remedy = "Name another, or one alone to join it to the ground."
        raise SceneError(f"{at}.between", list(joint.between), "two different bodies", remedy)


def _check_rod(joint: JointTable, dimension: int, at: str) -> None:
    for key in ("axis", "stiffness", "rest_angle", "damping", "drive"):
        if getattr(joint, key) is not None:
            raise SceneError(f"{at}.{key}", "it in a rod", "it in a hinge", f"Set type = 'hinge', or remove `{key}`.")


def _check_hinge(joint: JointTable, dimension: int, at: str) -> None:
    if joint.at is None:
        raise SceneError(f"{at}.at", "nothing", "the point of a hinge at the start", "Add the key 'at'.")
    if dimension == 2 and joint.axis is not None:
        raise SceneError(f"{at}.axis", list(joint.axis), "none in 2D, where all axes are one", "Remove it.")
    if dimension == 3 and joint.axis is None:
        raise SceneError(f"{at}.axis", "nothing", "the direction of a hinge's axis in 3D", "Add the key 'axis'.")
    if joint.axis is not None and not any(joint.axis):
        raise SceneError(f"{at}.axis", list(joint.axis), "a vector of length above 0", "Give its direction.")
    if joint.rest_angle is not None and joint.stiffness is None:
        raise SceneError(f"{at}.rest_angle", "it without `stiffness`", "both", "Add `stiffness`, or remove it.")
    _refuse_in_drive(joint, ("stiffness", "damping"), at)


def _refuse_in_drive(joint: JointTable, keys: Sequence[str], at: str) -> None:
    for key in keys:
        if joint.drive is not None and getattr(joint, key) is not None:
            found = f"it beside `{key}`, which a given angle does not feel"
            raise SceneError(f"{at}.drive", found, "one of them", f"Remove `drive` or `{key}`.")
