"""Joints, held directions and springs that contradict themselves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.rigid_body import DIRECTIONS
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.geometry.arrays import FloatArray
    from rigidfluid.core.scene.joint_tables import SpringTable
    from rigidfluid.core.setup.model import Model
    from rigidfluid.core.setup.rigid_body import JoinedBodies, RigidBody


def check_joints(model: Model) -> None:
    """Refuse, with SceneError, invalid joints and bodies' links to the ground, before anything is built."""
    for number, body in enumerate(model.bodies):
        _check_free(body, f"body.{number}")
        _check_spring(body, f"body.{number}")
    names = Counter(joint.name for joint in model.joints)
    for name in names:
        if names[name] > 1 or name in (body.name for body in model.all_bodies):
            raise SceneError("joint.name", repr(name), "a name that no other joint or body has", "Rename it.")
    for number, joint in enumerate(model.joints):
        _check_ends(model, joint, f"joint.{number}")
        _check_point(model, joint, f"joint.{number}")


def _check_free(body: RigidBody, at: str) -> None:
    if body.free is None:
        return
    dimension = body.shape.dimension
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
        for held, speed in zip(part, _values(getattr(body, key)), strict=False):
            if held not in body.free and speed != 0.0:
                raise SceneError(f"{at}.{key}", f"{speed:g} along {held!r}, which is held", "0 there", "Set it to 0.")


def _check_spring(body: RigidBody, at: str) -> None:
    if body.spring is None:
        return
    _refuse_beside(body, "spring", at)
    dimension, held = body.shape.dimension, body.held_directions
    names = DIRECTIONS[dimension]
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
        statement = "a spring has a rest position only if it has a stiffness"
        raise SceneError(f"{at}.spring.rest", statement, None, "Remove it.")


def _strengths(spring: SpringTable) -> list[tuple[float, ...]]:
    keys = ("stiffness", "damping", "angular_stiffness", "angular_damping")
    return [getattr(spring, key) or () for key in keys]


def _refuse_beside(body: RigidBody, key: str, at: str) -> None:
    """Whose motion is given cannot be held or pulled."""
    for other in ("fixed", "prescribed"):
        if getattr(body, other):
            statement = f"a body of which {other!r} is given cannot have {key!r} as well"
            raise SceneError(f"{at}.{key}", statement, None, f"Remove `{key}` or `{other}`.")


def _values(vector: Sequence[float] | FloatArray | None) -> Sequence[float] | FloatArray:
    """Components of a vector, none where it is not given."""
    return () if vector is None else vector


def _check_point(model: Model, joint: JoinedBodies, at: str) -> None:
    if joint.kind.dimension != model.dimension:
        found, allowed = f"a {joint.kind.name} in {joint.kind.dimension}D", f"one in {model.dimension}D"
        raise SceneError(at, found, allowed, "Make it with that dimension.")
    if joint.at is None and joint.kind.needs_point:
        raise SceneError(f"{at}.at", "nothing", f"the point of a {joint.kind.name} at the start", "Add the key 'at'.")
    if joint.at is not None and len(joint.at) != model.dimension:
        raise SceneError(f"{at}.at", f"{joint.at}", f"{model.dimension} numbers", "Correct it.")


def _check_ends(model: Model, joint: JoinedBodies, at: str) -> None:
    names = [body.name for body in model.all_bodies]
    for number, name in enumerate(joint.between):
        if name not in names:
            shown = ", ".join(names[:20]) + (", …" if len(names) > 20 else "")
            remedy = suggestion(name, names) or "Name a body, or a component as 'mechanism.component'."
            raise SceneError(f"{at}.between.{number}", f"{name!r}, no body", f"one of {shown}", remedy)
    if len(set(joint.between)) < len(joint.between):
        remedy = "Name another, or one alone to join it to the ground."
        raise SceneError(f"{at}.between", list(joint.between), "two different bodies", remedy)
