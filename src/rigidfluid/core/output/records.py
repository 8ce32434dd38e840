"""Rows of a run's tables, for each accepted step."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.joints import COORDINATES
from rigidfluid.core.model.mesh_error import mesh_error
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose, Twist, Wrench

Row = tuple[float | int | str, ...]
Records = dict[str, list[Row]]
"""Rows by table name."""

LEDGER_COLUMNS = (
    *("kinetic", "contact", "gravity", "boundary", "control", "body_force", "exchange"),
    *("dissipation", "grad_div_loss", "contact_loss", "transfer_loss", "path_friction", "residual"),
    *("residual_start", "residual_remeshing", "residual_contacts", "residual_mesh", "residual_steps"),
)
_ledger_row = attrgetter(*LEDGER_COLUMNS)

ESTIMATED, CAUSES = ("velocity", "angular_velocity", "force", "torque"), ("mesh", "steps")
"""Quantities of bodies whose errors are estimated, and what these are by."""
SCALAR_COLUMNS = ("content", "rate", "source", "imbalance", "least", "greatest", "remeshing")


def columns(
    dimension: int, coordinates: Iterable[str] = COORDINATES, *, periodic: bool = False
) -> dict[str, tuple[str, ...]]:
    """Column names of each table, in order; ``coordinates`` are those of joints, by name; ``periodic`` of scenes with
    periodic surfaces."""
    quantities = quantity_columns(dimension)
    position, velocity, force = quantities["position"], quantities["velocity"], quantities["force"]
    a, b, normal = (_components(name, dimension) for name in "abn")
    wrapped = wrapped_columns(dimension) if periodic else ()
    stresslet = _symmetric_components("s", dimension)
    return {
        "bodies": ("time", "step", "body", *chain(*quantities.values()), "gap", *wrapped),
        "contacts": ("time", "step", "a", "b", *a, *b, *normal, "gap", *force),
        "joints": ("time", "step", "joint", "gap", *coordinates, "rate", *force, *quantities["torque"]),
        "energy": ("time", "step", *LEDGER_COLUMNS),
        "steps": ("time", "step", "size", "error", "unknowns", "remeshes", "cells", "quality"),
        "probes": ("time", "step", "probe", *position, *velocity, "pressure", "scalar"),
        "driving": ("time", "step", "surface", "flux", "pressure_drop"),
        "stresslets": ("time", "step", "body", *stresslet),
        "walls": ("time", "step", "wall", *force, *(f"contact_{name}" for name in force), "area"),
        "statistics": ("time", "step", *_statistics_columns(dimension)),
        "exchanges": ("time", "step", "body", "change", *position, *exchange_columns(dimension)),
        "mesh_error": ("time", "step", "error", "dissipation", "relative"),
        "sensitivities": ("time", "step", "parameter", "body", *_derivative_columns(dimension)),
        "scalar": ("time", "step", *SCALAR_COLUMNS),
        "scalar_fluxes": ("time", "step", "surface", "flux", "value", "inside"),
        "error_estimates": ("time", "step", "body", *estimate_columns(dimension)),
    }


def quantity_columns(dimension: int) -> dict[str, tuple[str, ...]]:
    """Columns of the table of bodies by the quantity that they hold, in order; ``force`` and ``torque`` are the
    fluid's."""
    two = dimension == 2
    return {
        "position": _components("", dimension),
        "orientation": ("angle",) if two else ("qw", "qx", "qy", "qz"),
        "velocity": _components("v", dimension),
        "angular_velocity": ("w",) if two else _components("w", dimension),
        "force": _components("f", dimension),
        "torque": ("t",) if two else _components("t", dimension),
        "contact_force": _components("cf", dimension),
        "contact_torque": ("ct",) if two else _components("ct", dimension),
    }


def wrapped_columns(dimension: int) -> tuple[str, ...]:
    """Columns of positions wrapped into the domain, which scenes with periodic surfaces have."""
    return tuple(f"{axis}_wrapped" for axis in "xyz"[:dimension])


def _derivative_columns(dimension: int) -> Iterator[str]:
    """Columns of derivatives of poses, velocities and forces; in 3D those of the orientation are a rotation vector."""
    quantities = quantity_columns(dimension)
    if dimension == 3:
        quantities["orientation"] = _components("r", 3)
    return chain(*quantities.values())


def estimate_columns(dimension: int) -> tuple[str, ...]:
    """Columns of estimated errors: by the mesh and by the steps, of each column of twists and of the fluid's
    wrenches."""
    quantities = quantity_columns(dimension)
    names = chain(*(quantities[name] for name in ESTIMATED))
    return tuple(f"{name}_{cause}" for name in names for cause in CAUSES)


def _statistics_columns(dimension: int) -> Iterator[str]:
    """Columns of the statistics of the bodies that move."""
    axes, velocity = "xyz"[:dimension], _components("v", dimension)
    yield from ("bodies", "volume_fraction", *velocity, *(f"{name}_fluctuation" for name in velocity))
    yield from ("gap", "least_gap", "least_wall_gap", "coordination", "contacts")
    yield from (f"contact_{row}{column}" for row in axes for column in axes)
    differences = ("first_normal_difference", "second_normal_difference")[: dimension - 1]
    yield from (*_symmetric_components("stress_", dimension), "relative_viscosity", *differences)


def exchange_columns(dimension: int) -> tuple[str, ...]:
    """Columns of what a body brings when it enters or takes when it leaves, in order."""
    angular = ("l",) if dimension == 2 else _components("l", 3)
    return ("mass", *_components("p", dimension), *angular, "kinetic")


def _components(name: str, dimension: int) -> tuple[str, ...]:
    return tuple(name + axis for axis in "xyz"[:dimension])


def _symmetric_components(name: str, dimension: int) -> tuple[str, ...]:
    """Names of the components of a symmetric tensor, row by row."""
    return tuple(f"{name}{'xyz'[row]}{'xyz'[column]}" for row, column in zip(*np.triu_indices(dimension), strict=True))


class StepCost(NamedTuple):
    """Cost of the step to a state: its ``size`` [time], how many meshes have been made since the start, and the
    ``quality`` of the worst cell [1]."""

    size: float
    remeshes: int
    quality: float


def records(
    system: System, probes: FloatArray, state: State, time: float, cost: StepCost | None, forces: FloatArray
) -> Records:
    """The rows of one state; ``probes`` (p, d) are the points where the fluid is recorded, ``cost`` None at a start,
    ``forces`` (m, d) those of its contacts on their first bodies."""
    stamp = (time, state.count)
    return {
        "bodies": list(_body_rows(system, state, stamp)),
        "contacts": list(_contact_rows(system, state, stamp, forces)),
        "joints": list(_joint_rows(system, state, stamp, time)),
        "energy": [(*stamp, *_ledger_row(state.ledger))],
        "steps": [] if cost is None else [_step_row(system, state, stamp, cost)],
        "probes": list(_probe_rows(system, probes, state, stamp)),
        "driving": list(_driving_rows(system, state, stamp)),
        "stresslets": list(_stresslet_rows(system, state, stamp)),
        "walls": list(_wall_rows(system, state, stamp, forces)),
        "statistics": [],
        "exchanges": [],
        "mesh_error": list(_error_rows(state, stamp)),
        "sensitivities": [],
        "scalar": [] if state.scalar is None else [(*stamp, *(getattr(state.scalar, name) for name in SCALAR_COLUMNS))],
        "scalar_fluxes": list(_scalar_flux_rows(system, state, stamp)),
        "error_estimates": [],
    }


def columns_of(system: System) -> dict[str, tuple[str, ...]]:
    """The `columns` of a system's tables."""
    return columns(system.dimension, joint_coordinates(system), periodic=bool(system.domain.periodic))


def joint_coordinates(system: System) -> Mapping[str, str]:
    """Units of the coordinates of a system's joints, by the names of their columns, in order."""
    return system.joints.coordinates


def moving(system: System) -> tuple[str, ...]:
    """Names of all bodies, and of the mechanisms after them: one for each row of a state."""
    return (*system.surfaces[: len(system.bodies)], *system.motions.names)


def _body_rows(system: System, state: State, stamp: Row) -> Iterator[Row]:
    """A row for each body, and one for each mechanism, with the least gap of its components."""
    numbers = _numbers(system, state.pose, state.twist, state.hydrodynamic_wrench, state.contact_wrench, state.gaps)
    if system.motions.names:
        motions, gaps = state.motions, system.motions.least(state.gaps)
        wholes = _numbers(system, motions.pose, motions.twist, motions.hydrodynamic, motions.contact, gaps)
        numbers += wholes[len(wholes) - len(system.motions.names) :]
    for name, row in zip(moving(system), numbers, strict=True):
        yield (*stamp, name, *row)


def _numbers(
    system: System, pose: Pose, twist: Twist, hydrodynamic: Wrench, contact: Wrench, gaps: FloatArray
) -> list[list[float]]:
    fields = [
        *(pose.position, pose.orientation, twist.velocity, twist.angular_velocity),
        *(hydrodynamic.force, hydrodynamic.torque, contact.force, contact.torque),
        gaps[:, None],
        *([system.domain.wrapped(pose.position)] if system.domain.periodic else []),
    ]
    rows: list[list[float]] = np.concatenate(fields, axis=1).tolist()
    return rows


def _contact_rows(system: System, state: State, stamp: Row, forces: FloatArray) -> Iterator[Row]:
    near = state.contacts
    for i in system.acting(near):
        names = (system.surfaces[near.body_a[i]], system.surfaces[near.body_b[i]])
        vectors = np.concatenate([near.point_a[i], near.point_b[i], near.normal[i]]).tolist()
        yield (*stamp, *names, *vectors, float(near.gap[i]), *forces[i].tolist())


def _joint_rows(system: System, state: State, stamp: Row, time: float) -> Iterator[Row]:
    names = joint_coordinates(system)
    for one in system.joints.readings(state.pose, state.twist, time, state.link.force):
        values = [one.value if name == one.coordinate else math.nan for name in names]
        yield (*stamp, one.name, one.gap, *values, one.rate, *one.force.tolist(), *one.torque.tolist())


def _step_row(system: System, state: State, stamp: Row, cost: StepCost) -> Row:
    """The error is infinite where it is not known."""
    unknowns = system.backend.unknowns(state.mesh, system.motions.prescribed)
    error = math.inf if state.estimate is None else state.estimate.error
    return (*stamp, cost.size, error, unknowns, cost.remeshes, count_cells(state.mesh), cost.quality)


def count_cells(mesh: Mesh) -> int:
    """Number of cells of the whole mesh."""
    return len(mesh.cells) if mesh.part is None else int(mesh.part.counts[1])


def _probe_rows(system: System, probes: FloatArray, state: State, stamp: Row) -> Iterator[Row]:
    if len(probes) == 0 or count_cells(state.mesh) == 0:
        return
    velocity, pressure = system.backend.probe(state.fluid, state.mesh, probes)
    scalar = np.full(len(probes), np.nan)
    if system.fluid is not None and system.fluid.scalar is not None:
        scalar = system.backend.probe_scalar(state.fluid, state.mesh, state.pose, probes)
    if system.window is not None:  # nothing is known of the fluid outside
        outside = ~system.window.meshed_domain(state.pose).contains(probes)
        velocity[outside], pressure[outside] = np.nan, np.nan
    for i, point in enumerate(probes):
        yield (*stamp, i, *point.tolist(), *velocity[i].tolist(), float(pressure[i]), float(scalar[i]))


def _driving_rows(system: System, state: State, stamp: Row) -> Iterator[Row]:
    """A row for each pair of periodic surfaces, by the name of the first."""
    if system.fluid is None or count_cells(state.mesh) == 0:
        return
    names = [condition.name for condition in system.fluid.conditions if condition.image is not None]
    if names and system.backend.held_fluxes:
        for name, row in zip(names, system.backend.driving(state.fluid, state.mesh).tolist(), strict=True):
            yield (*stamp, name, *row)


def _stresslet_rows(system: System, state: State, stamp: Row) -> Iterator[Row]:
    """A row for each body, where stresslets are known."""
    if state.stresslet is not None:
        upper = np.triu_indices(system.dimension)
        for name, stresslet in zip(system.surfaces, state.stresslet, strict=False):
            yield (*stamp, name, *stresslet[upper].tolist())


def _wall_rows(system: System, state: State, stamp: Row, forces: FloatArray) -> Iterator[Row]:
    """A row for each surface of the domain that is not periodic, where its forces are known."""
    found = state.boundary_forces
    if found is None:
        return
    pushed, acting = np.zeros((len(system.surfaces), system.dimension)), system.acting(state.contacts)
    np.subtract.at(pushed, state.contacts.body_b[acting], forces[acting])
    for number, name in enumerate(system.domain.names):
        if number not in system.domain.periodic_pieces:
            by_contacts = pushed[len(system.bodies) + number].tolist()
            yield (*stamp, name, *found.force[number].tolist(), *by_contacts, float(found.area[number]))


def _error_rows(state: State, stamp: Row) -> Iterator[Row]:
    """A row where the mesh's error is known."""
    found = mesh_error(state)
    if found is not None:
        yield (*stamp, found.total, found.whole, found.relative)


def _scalar_flux_rows(system: System, state: State, stamp: Row) -> Iterator[Row]:
    """A row for each surface, bodies first, where a scalar is transported."""
    if state.scalar is not None:
        found = state.scalar
        for name, *row in zip(system.surfaces, found.flux, found.value, found.inside, strict=True):
            yield (*stamp, name, *map(float, row))
