"""Joints that hold what is held already, or nothing that can move: no force in them is determined."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.joints.constraints import Constraint
from rigidfluid.errors import SceneError

_LEAST = 1e-8
"""Rows of length one that are nearer than this to what others span are redundant [1]."""


def refuse_void(constraints: Sequence[Constraint], carrier: IntArray, prescribed: BoolArray) -> None:
    """Refuse what has no free relative motion to hold, for bodies on motions ``carrier`` (n,) of which some (N,) are
    given."""
    for constraint in constraints:
        ends = [motion_of(body, carrier, prescribed) for body in constraint.markers.bodies]
        if ends[0] == ends[1]:
            found = "nothing that moves freely" if ends[0] is None else "parts of one mechanism"
            remedy = "Leave it out, or join a body that is free to move."
            raise SceneError(constraint.name, found, "bodies that move relatively to each other", remedy)


def motion_of(body: int | None, carrier: IntArray, prescribed: BoolArray) -> int | None:
    """Number of the free motion that carries a body; None for the ground and for prescribed motions."""
    return None if body is None or prescribed[carrier[body]] else int(carrier[body])


def refuse_redundant(constraints: Sequence[Constraint], rows: FloatArray) -> None:
    """Refuse rigid constraints whose ``rows`` (r, N, d+k), in the metric of the masses, others span: SceneError names
    the first whose rows add nothing to those before it."""
    names = [one.name for one in constraints for _ in range(int(np.sum(one.compliance == 0.0)))]
    flat = rows.reshape(len(rows), rows.shape[1] * rows.shape[2])
    unit = flat / np.linalg.norm(flat, axis=1, keepdims=True)
    if _independent(unit):
        return
    for name in dict.fromkeys(names):
        last = len(names) - names[::-1].index(name)
        if not _independent(unit[:last]):
            found, allowed = "an over-determined joint", "one that holds what no other joint holds already"
            remedy = "Leave it out, or let it hold less: a hinge in place of a rod."
            raise SceneError(name, found, allowed, remedy)


def _independent(unit: FloatArray) -> bool:
    if len(unit) > unit.shape[1]:
        return False
    return len(unit) == 0 or float(np.linalg.svd(unit, compute_uv=False)[-1]) > _LEAST
