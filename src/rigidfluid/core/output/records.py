"""What a run says of each accepted step: the rows of its tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FloatArray

Row = tuple[float | int | str, ...]
Records = dict[str, list[Row]]
"""Rows by table name."""

LEDGER_COLUMNS = (
    *("kinetic", "contact", "gravity", "boundary", "control"),
    *("dissipation", "contact_loss", "transfer_loss", "path_friction", "residual"),
)


def columns(dimension: int) -> dict[str, tuple[str, ...]]:
    """Column names of each table, in order."""
    axes = "xyz"[:dimension]
    along = tuple(axes)
    spin = ("w",) if dimension == 2 else ("wx", "wy", "wz")
    torque = ("t",) if dimension == 2 else ("tx", "ty", "tz")
    orientation = ("angle",) if dimension == 2 else ("qw", "qx", "qy", "qz")

    def named(prefix: str, names: Sequence[str] = along) -> tuple[str, ...]:
        return tuple(prefix + name for name in names)

    return {
        "bodies": (
            *("time", "step", "body", *along, *orientation, *named("v"), *spin),
            *(*named("f"), *torque, *named("cf"), *named("c", torque), "gap"),
        ),
        "contacts": ("time", "step", "a", "b", *named("a"), *named("b"), *named("n"), "gap"),
        "energy": ("time", "step", *LEDGER_COLUMNS),
        "probes": ("time", "step", "probe", *along, *named("v"), "pressure"),
    }


def records(system: System, probes: FloatArray, state: State, time: float) -> Records:
    """The rows of one state; ``probes`` (p, d) are the points where the fluid is recorded."""
    stamp = (time, state.count)
    return {
        "bodies": list(_body_rows(system, state, stamp)),
        "contacts": list(_contact_rows(system, state, stamp)),
        "energy": [(*stamp, *(getattr(state.ledger, name) for name in LEDGER_COLUMNS))],
        "probes": list(_probe_rows(system, probes, state, stamp)),
    }


def _body_rows(system: System, state: State, stamp: Row) -> Iterator[Row]:
    numbers = np.concatenate(
        [
            state.pose.position,
            state.pose.orientation,
            state.twist.velocity,
            state.twist.angular_velocity,
            state.hydrodynamic_wrench.force,
            state.hydrodynamic_wrench.torque,
            state.contact_wrench.force,
            state.contact_wrench.torque,
            state.gaps[:, None],
        ],
        axis=1,
    ).tolist()
    for body, row in enumerate(numbers):
        yield (*stamp, system.surfaces[body], *row)


def _contact_rows(system: System, state: State, stamp: Row) -> Iterator[Row]:
    near = state.contacts
    for i in np.flatnonzero(near.gap <= system.law.range) if system.law else ():
        names = (system.surfaces[near.body_a[i]], system.surfaces[near.body_b[i]])
        vectors = np.concatenate([near.point_a[i], near.point_b[i], near.normal[i]]).tolist()
        yield (*stamp, *names, *vectors, float(near.gap[i]))


def _probe_rows(system: System, probes: FloatArray, state: State, stamp: Row) -> Iterator[Row]:
    if len(probes) == 0 or state.mesh is None:
        return
    velocity, pressure = system.backend.probe(state.fluid, state.mesh, probes)
    for i, point in enumerate(probes):
        yield (*stamp, i, *point.tolist(), *velocity[i].tolist(), float(pressure[i]))
