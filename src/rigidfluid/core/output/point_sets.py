"""Bodies and contacts of one state as points with numbers and vectors, and what bodies conduct at the points inside."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import InsideFields
from rigidfluid.core.output.vtu import BODIES, CONTACTS, INSIDES, QUADRATIC, in_space, write_grid

_VERTEX, _LINE = 1, 3
"""VTK's numbers of cells of one point and of two."""


@dataclass(frozen=True)
class PointSet:
    """Points (N, d) [length] with ``arrays`` by name, (N,) or (N, components), in ``cells`` (M, b) of one ``kind`` by
    VTK's number."""

    points: FloatArray
    arrays: dict[str, FloatArray | IntArray]
    kind: int
    cells: IntArray

    def write(self, path: Path) -> None:
        """Write a VTU file; vectors of the plane have a third component of zero there."""
        d, arrays = self.points.shape[1], self.arrays.items()
        spatial = {name: in_space(v.astype(np.float64)) if v.ndim == 2 and v.shape[1] == d else v for name, v in arrays}
        write_grid(path, self.points, (self.kind, self.cells), spatial)


def point_sets(system: System, state: State, forces: FloatArray) -> dict[str, PointSet]:
    """Bodies, contacts and insides of bodies that conduct, by the names of their datasets, with the ``forces`` of the
    contacts (m, d)."""
    found = {BODIES: _body_points(system, state), CONTACTS: _contact_points(system, state, forces)}
    insides = system.backend.insides(state.fluid, state.mesh, state.pose)
    return found if insides is None else {**found, INSIDES: _inside_points(insides)}


def _body_points(system: System, state: State) -> PointSet:
    """A point for each body at its centre of mass; ``id`` is its number, from 0.

    In the plane ``angle``, ``angular_velocity``, ``torque`` and ``contact_torque`` have one component each. With
    periodic surfaces there is the ``wrapped_position`` too.
    """
    pose, twist, fluid, contact = state.pose, state.twist, state.hydrodynamic_wrench, state.contact_wrench
    numbers = np.arange(len(system.bodies))
    arrays: dict[str, FloatArray | IntArray] = {
        "id": numbers,
        "bounding_radius": system.bounding_radii,
        "angle" if system.dimension == 2 else "quaternion": pose.orientation,
        "velocity": twist.velocity,
        "angular_velocity": twist.angular_velocity,
        "force": fluid.force,
        "torque": fluid.torque,
        "contact_force": contact.force,
        "contact_torque": contact.torque,
    }
    if system.domain.periodic:
        arrays["wrapped_position"] = system.domain.wrapped(pose.position)
    return PointSet(pose.position, {name: _flat(values) for name, values in arrays.items()}, _VERTEX, numbers[:, None])


def _contact_points(system: System, state: State, forces: FloatArray) -> PointSet:
    """A line for each contact in which a law acts, from the nearest point on one surface to that on the other.

    Each end has the ``surface`` that it is on, the ``force`` on that, of ``forces`` (m, d) on the first bodies
    [force], and the ``gap`` [length]. Surfaces are numbered through, bodies first.
    """
    near, acting = state.contacts, system.acting(state.contacts)
    ends = np.arange(2 * len(acting)).reshape(-1, 2)
    force = forces[acting]
    arrays: dict[str, FloatArray | IntArray] = {
        "surface": np.stack([near.body_a[acting], near.body_b[acting]], axis=1).ravel(),
        "force": np.stack([force, -force], axis=1).reshape(-1, system.dimension),
        "gap": np.repeat(near.gap[acting], 2),
    }
    points = np.stack([near.point_a[acting], near.point_b[acting]], axis=1).reshape(-1, system.dimension)
    return PointSet(points, arrays, _LINE, ends)


def _inside_points(insides: InsideFields) -> PointSet:
    """The nodes inside bodies with the ``scalar`` and the number of the ``body`` that each is in."""
    arrays: dict[str, FloatArray | IntArray] = {"scalar": insides.scalar, "body": insides.body}
    return PointSet(insides.points, arrays, QUADRATIC[insides.cells.shape[1]], insides.cells)


def _flat(values: FloatArray | IntArray) -> FloatArray | IntArray:
    """Values (N, 1) as (N,), all others as they are."""
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values
