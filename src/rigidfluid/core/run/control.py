"""Bodies that the caller of a run moves: which may be moved, and what the run has after that."""

from __future__ import annotations

from dataclasses import replace

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.wrenches import flat, nothing, wrench_of
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.setup.model import Model
from rigidfluid.core.setup.prescribed import PrescribedMotion, prescribed_motion
from rigidfluid.errors import SceneError


def body_row(system: System, name: str, prescribed: bool) -> int:
    """Number of a body whose motion is prescribed, or of a free one; raises SceneError where none has this name."""
    names = system.surfaces[: len(system.bodies)]
    right = [body for body, given in zip(names, system.prescribed, strict=True) if given == prescribed]
    if name in right:
        return names.index(name)
    other = "free" if prescribed else "fixed or prescribed"
    found = f"{name!r}, which {f'is {other}' if name in names else 'is not there'}"
    wanted = "a body that is fixed or prescribed" if prescribed else "a free body or component"
    remedy = "Name another, or give it 'fixed = true' in the scene." if prescribed else "Name another."
    raise SceneError("body", found, f"{wanted}: {', '.join(map(str, right)) or 'there is none'}", remedy)


def present_motion(model: Model, system: System, state: State) -> PrescribedMotion:
    """Prescribed motion at present: since the start by the scene, or by the caller."""
    if state.prescription is not None:
        return PrescribedMotion(state.prescription)
    return prescribed_motion(model.bodies, system.motions.pose)


def following(system: System, motion: PrescribedMotion) -> System:
    """The same system, with prescribed bodies that move so."""
    joints = system.joints.following(motion)
    return replace(system, prescribed_twist=motion, prescribed_pose=motion.pose_at, joints=joints)


def with_applied(state: State, row: int, wrench: FloatArray) -> State:
    """The same state, with a ``wrench`` (d+k,) applied to the body of this row."""
    rows = flat(nothing(state.pose) if state.applied is None else state.applied)
    rows[row] = wrench
    return replace(state, applied=wrench_of(rows, state.pose.position.shape[1]))
