"""Systems of a scene on both sides of a value of one of its keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any, NamedTuple

import numpy as np

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.model.system import System
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.overrides import assign
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.errors import RigidfluidError, SceneError

_SHARE = 4e-5
"""Half the difference of values, relative to the value [1]: central differences err by its square, and by rounding over
it, of a place after little way above all."""

_TIGHT = 1e-12
"""Relative residual of flows at the start, which are solved for on both sides."""

_SHAPES = ("scene", "domain", "mesh", "time", "output", "source", "sink", "swarm")
"""Tables on which meshes, steps or the number of bodies depend."""

_FIELD = "output.sensitivities"


class SystemPair(NamedTuple):
    """Systems at p + h and p - h of a ``key`` with the value p; ``half`` is h."""

    key: str
    half: float
    plus: System
    minus: System


def system_pairs(document: Mapping[str, Any], system: System, keys: Sequence[str]) -> list[SystemPair]:
    """Systems of the scene in a ``document``, whose own is ``system``, on both sides of the values of all keys.

    Raises SceneError where one has no derivative, or none has, as the fluid's solution holds motions by forces that are
    unknowns of their own.
    """
    if len(system.solved_joints.links(system.motions.pose, 0.0).rate):
        found = "joints, held directions or dampers in a fluid"
        raise SceneError(_FIELD, found, "bodies without them", "Run with two values.")
    with all_told() as ask:
        return [ask(_system_pair, document, system, keys, number) for number in range(len(keys))]


def _system_pair(document: Mapping[str, Any], system: System, keys: Sequence[str], number: int) -> SystemPair:
    """Systems of the scene in a ``document``, whose own is ``system``, on both sides of the value of one of ``keys``.

    Raises SceneError where the key is there before, has no number to differ, or the mesh would be another one.
    """
    key, at = keys[number], f"{_FIELD}.{number}"
    if key in keys[:number]:
        raise SceneError(at, f"{key!r} again", "each key once", "Leave it out here.")
    value = _number(document, key, at)
    half = _SHARE * abs(value)
    plus, minus = (_system(document, key, at, each) for each in (value + half, value - half))
    if not (_has_same_shapes(system, plus) and _has_same_shapes(system, minus)):
        raise SceneError(at, repr(key), "a key on which no shape and no place depends", "Run with two values.")
    return SystemPair(key, half, plus, minus)


def _number(document: Mapping[str, Any], key: str, at: str) -> float:
    """Number of a ``key``, also in a list of its own, as an angular velocity in 2D."""
    table, *rest = key.split(".")
    remedy = "Name a key with a number as fluid.viscosity, body.0.density or fluid.gravity.1."
    if table in _SHAPES:
        found = f"{key!r}, on which meshes or steps depend"
        raise SceneError(at, found, "a key of another table", "Run with two values.")
    value: Any = document
    for part in (table, *rest):
        if isinstance(value, Mapping) and part in value:
            value = value[part]
        elif isinstance(value, list | tuple) and part.isdecimal() and int(part) < len(value):
            value = value[int(part)]
        else:
            known = [*value] if isinstance(value, Mapping) else []
            raise SceneError(at, repr(key), "a key that the scene has", suggestion(part, known) or remedy)
    if isinstance(value, list | tuple) and len(value) == 1:
        (value,) = value
    if isinstance(value, bool) or not isinstance(value, int | float) or value == 0:
        raise SceneError(at, f"{key!r} with {describe(value)}", "a key with a number other than 0", remedy)
    return float(value)


def _system(document: Mapping[str, Any], key: str, at: str, value: float) -> System:
    tables = deepcopy(dict(document))
    assign(tables, key, value)
    if tables["fluid"].get("backend") != "dry":
        assign(tables, "fluid.tolerance", _TIGHT)
    try:
        return assemble(model_of(scene_from_dict(tables)))
    except RigidfluidError as error:
        raise error.renamed(lambda subject: f"{at} with {key} = {value!r}: {subject}") from error


def _has_same_shapes(system: System, other: System) -> bool:
    return (
        np.array_equal(system.bounding_radii, other.bounding_radii)
        and np.array_equal(system.pose.position, other.pose.position)
        and np.array_equal(system.pose.orientation, other.pose.orientation)
        and np.array_equal(system.prescribed, other.prescribed)
        and [body.volume for body in system.bodies] == [body.volume for body in other.bodies]
    )
