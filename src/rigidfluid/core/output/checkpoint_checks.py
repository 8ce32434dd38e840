"""Checks of what a checkpoint holds: shapes that fit each other, and values that a run can have."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.stored_records import Misfit
from rigidfluid.core.output.vtu import DATASETS

Shapes = Mapping[str, "str | Shapes"]
"""Shapes of a record's arrays by their names, a letter for each axis, and those of records in it."""


def _pose(count: str) -> Shapes:
    return {"position": f"{count}d", "orientation": f"{count}q"}


def _twist(count: str) -> Shapes:
    return {"velocity": f"{count}d", "angular_velocity": f"{count}k"}


def _wrench(count: str) -> Shapes:
    return {"force": f"{count}d", "torque": f"{count}k"}


_MESH: Shapes = {
    **{"points": "Pd", "cells": "Ms", "facets": "Fd", "markers": "F"},
    "part": {"vertices": "P", "cells": "M", "facets": "F", "owned": "P", "counts": "3"},
    "curved": {"vertices": "K2", "surface": "K", "middles": "Kd"},
    "periods": {"ways": "wd", "winding": "nw"},
}

_STATE: Shapes = {
    **{"pose": _pose("n"), "twist": _twist("n"), "mesh": _MESH, "gaps": "n"},
    "past": {"pose": _pose("N"), "twist": _twist("N"), "applied": _wrench("N")},
    "reference": {"mesh": _MESH, "pose": _pose("n"), "gaps": "n"},
    "coupling": {
        "model": {"velocities": "c", "modes": "cc", "decay": "c"},
        **dict.fromkeys(("load", "load_before", "correction"), "c"),
    },
    "contacts": {
        **dict.fromkeys(
            ("body_a", "body_b", "gap", "radius_a", "radius_b", "at_wall", "effective_radius", "sign"), "m"
        ),
        **dict.fromkeys(("point_a", "point_b", "normal", "shift"), "md"),
        "curvatures": "m2dd",
    },
    "springs": {
        **dict.fromkeys(("body_a", "body_b", "stiffness"), "l"),
        **dict.fromkeys(("arm_a", "arm_b", "normal", "displacement"), "ld"),
        "turning": "lk",
    },
    **{"hydrodynamic_wrench": _wrench("n"), "contact_wrench": _wrench("n"), "applied": _wrench("n")},
    "stresslet": "ndd",
    "boundary_forces": {"force": "bd", "area": "b"},
    "cell_errors": "M",
    "flow_error": {"times": "e", "velocity": "egd", "twist": "eNt"},
    "scalar": {"flux": "r", "value": "r", "inside": "r"},
    "motions": {
        **{"pose": _pose("N"), "twist": _twist("N")},
        **{"contact": _wrench("N"), "hydrodynamic": _wrench("N")},
    },
    "link": {"wrench": "Nt"},
    "prescription": {
        **{"twist": "Nt", "before": "Nt", "over": "N", "amplitude": "Nd", "frequency": "N", "start": "N"},
        "pose": _pose("N"),
    },
}

_SHAPES: Shapes = {"state": _STATE, "extremes": {"highest_speed": "n"}, "sizes": f"o{len(DATASETS)}"}

_INFINITE = ("gaps", "smallest_gap", "since_start", "error", "with_contacts")
_UNKNOWN = ("radius_a", "radius_b", "effective_radius", "curvatures", "load_before", "quality")
"""Names of what may be infinite, and of what may also be no number, as it is not known."""

_OF_BACKENDS = ("memory/", "state/fluid/")
"""Arrays of a backend, which may have any names and signs."""

_SIGNED = ("winding",)
"""Whole numbers that may be below 0, as no others are."""

_POSITIVE = ("state/past/step", "ranks")
_NOT_NEGATIVE = ("elapsed", "cpu_time", "highest_speed", "seconds", "times", "cell_errors")
"""Numbers that are above 0, and those that are no less, as whole ones are anyhow."""


def require_sound(checkpoint: Any) -> None:
    """Raise Misfit unless shapes in a checkpoint fit each other, and its values are finite, in their ranges, and
    numbers of what there is."""
    d = checkpoint.state.pose.position.shape[-1] if checkpoint.state.pose.position.ndim == 2 else 0
    if d not in (2, 3):
        found = f"an array of shape {checkpoint.state.pose.position.shape}"
        raise Misfit("state/pose/position", found, "two or three coordinates of each body")
    k, q = (1, 1) if d == 2 else (3, 4)
    _require_shapes(
        checkpoint,
        _SHAPES,
        {"d": d, "k": k, "q": q, "s": d + 1, "t": d + k, "2": 2, "3": 3, "o": len(checkpoint.times)},
        "",
    )
    for name, value in _values(checkpoint, ""):
        _require_range(name, value)
    _require_indices(checkpoint.state)
    _require_times(checkpoint)
    for name in ("scene", "files", "population"):
        json_table(name, getattr(checkpoint, name))


def _require_shapes(record: Any, shapes: Shapes, sizes: dict[str, int], path: str) -> None:
    """Raise Misfit where an axis has another length than in ``sizes``, to which those are added that are not there."""
    for name, shape in shapes.items():
        value = getattr(record, name)
        if value is not None and not isinstance(shape, str):
            _require_shapes(value, shape, sizes, f"{path}{name}/")
        elif value is not None and isinstance(shape, str):
            known = [sizes.get(axis) for axis in shape]
            is_right = value.ndim == len(shape) and all(
                sizes.setdefault(axis, length) == length for axis, length in zip(shape, value.shape, strict=True)
            )
            if not is_right:
                wanted = " × ".join("any" if length is None else str(length) for length in known)
                raise Misfit(f"{path}{name}", f"an array of shape {value.shape}", f"one of {wanted}")


def _values(record: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Numbers and arrays of a record and of all in it, with their names in the file."""
    names = record if isinstance(record, Mapping) else [field.name for field in fields(record)]
    for name in names:
        value = record[name] if isinstance(record, Mapping) else getattr(record, name)
        if is_dataclass(value) or isinstance(value, Mapping):
            yield from _values(value, f"{path}{name}/")
        elif isinstance(value, int | float | tuple | np.ndarray):
            yield f"{path}{name}", np.asarray(value)


def _require_range(name: str, values: Any) -> None:
    """Raise Misfit where numbers are not finite, but for those that may be, or are negative where none can be."""
    if name.startswith(_OF_BACKENDS):
        _require(name, values, np.isfinite(values), "finite numbers")
        return
    parts = name.split("/")
    if values.dtype.kind == "f":
        may_be_infinite = parts[-1] in _INFINITE
        is_right = np.isfinite(values) | ((values == np.inf) & may_be_infinite) | (parts[-1] in _UNKNOWN)
        _require(name, values, is_right, "numbers, infinite ones among them" if may_be_infinite else "finite numbers")
    if name in _POSITIVE:
        _require(name, values, values > 0, "a number above 0")
    elif parts[-1] in _SIGNED:
        return
    elif values.dtype.kind in "iu" or not {parts[0], parts[-1]}.isdisjoint(_NOT_NEGATIVE):
        _require(name, values, values >= 0, "numbers of 0 or more")


def _require(name: str, values: Any, is_right: Any, allowed: str) -> None:
    if not np.all(is_right):
        raise Misfit(name, f"{np.asarray(values)[~np.asarray(is_right)].flat[0]}", allowed)


def _require_indices(state: State) -> None:
    """Raise Misfit where a mesh, contacts or the model of the coupling have numbers of what there is not."""
    n, contacts = len(state.pose.position), state.contacts
    for path, mesh in (("state/reference/mesh", state.reference.mesh), ("state/mesh", state.mesh)):
        _require_vertices(path, mesh)
    _require("state/contacts/body_a", contacts.body_a, contacts.body_a < n, f"numbers below {n}, that of the bodies")
    if state.springs is not None:
        body = state.springs.body_a
        _require("state/springs/body_a", body, body < n, f"numbers below {n}, that of the bodies")
    if state.coupling is not None:
        velocities, count = state.coupling.model.velocities, state.link.wrench.size
        _require("state/coupling/model/velocities", velocities, velocities < count, f"numbers below {count}")


def _require_vertices(path: str, mesh: Mesh) -> None:
    named = {"cells": mesh.cells, "facets": mesh.facets}
    if mesh.curved is not None:
        named["curved/vertices"] = mesh.curved.vertices
    for name, numbers in named.items():
        count = len(mesh.points)
        _require(f"{path}/{name}", numbers, numbers < count, f"numbers below {count}, that of the points")


def _require_times(checkpoint: Any) -> None:
    """Raise Misfit where there are no times of outputs, or not in their order, or ticks after the present one, or
    more steps than these."""
    times, state = np.array(checkpoint.times), checkpoint.state
    if len(times) == 0 or np.any(np.diff(times) <= 0.0):
        raise Misfit("times", f"{times.tolist()}", "times of outputs, each after the one before")
    ticks = {
        "count": state.count,
        "reference/tick": state.reference.tick,
        "impact": state.impact,
        "jumped": state.jumped,
    }
    if state.remesh_failed is not None:
        ticks["remesh_failed/tick"] = state.remesh_failed.tick
    for name, tick in ticks.items():
        if tick is not None and tick > state.tick:
            raise Misfit(f"state/{name}", f"{tick}", f"a number until {state.tick}, the tick of the state")


def json_table(name: str, text: str) -> dict[str, Any]:
    """The table that a text is in JSON; raises Misfit where it is none."""
    try:
        table = json.loads(text)
    except ValueError:
        table = None
    if not isinstance(table, dict):
        raise Misfit(name, f"{text[:40]!r}", "a table in JSON")
    return table
