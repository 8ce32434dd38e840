"""Delassus matrix: response of the gaps' rates to the contact forces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.contacts import sides, turning_radius
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.types import Contacts


def delassus(contacts: Contacts, dynamics: BodyDynamics, time: float) -> sparse.csr_matrix:
    """Delassus matrix D = G M⁻¹ Gᵀ (m, m), symmetric and positive semidefinite, where G maps the bodies' twists to the
    rates of the gaps, for forces that last for ``time`` [1/mass].

    Walls and prescribed bodies have no inverse mass; the bodies of ``dynamics`` are where the contacts are.
    """
    return _response(_point_rates(contacts, dynamics, contacts.normal), dynamics, time)


def delassus_of_points(contacts: Contacts, dynamics: BodyDynamics, time: float) -> sparse.csr_matrix:
    """Delassus matrix (d·m, d·m) of all components of the relative velocities in the middle of the gaps, those along
    the first axis first, for forces that last for ``time`` [1/mass]."""
    return _response(sparse.csr_matrix(sparse.vstack(_all_point_rates(contacts, dynamics))), dynamics, time)


def delassus_of_turning(contacts: Contacts, dynamics: BodyDynamics, time: float) -> sparse.csr_matrix:
    """Delassus matrix ((d+k)·m, (d+k)·m) of those components, and of those of the relative angular velocities times the
    effective radii after them, for forces and couples over these radii that last for ``time`` [1/mass]."""
    axes, radius = np.eye(dynamics.twist.angular_velocity.shape[1]), turning_radius(contacts)
    turning = [_turning_rates(contacts, dynamics, radius * axis) for axis in axes]
    rates = sparse.csr_matrix(sparse.vstack([*_all_point_rates(contacts, dynamics), *turning]))
    return _response(rates, dynamics, time)


def _response(rates: sparse.csr_matrix, dynamics: BodyDynamics, time: float) -> sparse.csr_matrix:
    return sparse.csr_matrix(rates @ dynamics.inverse_masses(time) @ rates.T)


def _all_point_rates(contacts: Contacts, dynamics: BodyDynamics) -> list[sparse.csr_matrix]:
    """Matrices (m, n·(d+k)) that map the bodies' twists to the relative velocity along each axis."""
    axes = np.eye(contacts.normal.shape[1])
    return [_point_rates(contacts, dynamics, np.broadcast_to(axis, contacts.normal.shape)) for axis in axes]


def _point_rates(contacts: Contacts, dynamics: BodyDynamics, direction: FloatArray) -> sparse.csr_matrix:
    """Matrix G (m, n·(d+k)) that maps the bodies' twists to the relative velocity along a ``direction`` (m, d)."""
    position = dynamics.pose.position

    def rows(which: IntArray, body: IntArray, point: FloatArray) -> FloatArray:
        return np.hstack([direction[which], moment(point - position[body], direction[which])])

    return _rates(contacts, dynamics, rows)


def _turning_rates(contacts: Contacts, dynamics: BodyDynamics, axis: FloatArray) -> sparse.csr_matrix:
    """Matrix (m, n·(d+k)) that maps the bodies' twists to the relative angular velocity along an ``axis`` (m, k), times
    its length."""

    def rows(which: IntArray, *_: Any) -> FloatArray:
        return np.hstack([np.zeros((len(which), dynamics.pose.position.shape[1])), axis[which]])

    return _rates(contacts, dynamics, rows)


def _rates(
    contacts: Contacts, dynamics: BodyDynamics, rows_on: Callable[[IntArray, IntArray, FloatArray], FloatArray]
) -> sparse.csr_matrix:
    """Matrix (m, n·(d+k)) of ``rows_on`` some contacts, their bodies and points (w, d+k), + for a and - for b."""
    count, dimension = dynamics.pose.position.shape
    width = dimension + dynamics.twist.angular_velocity.shape[1]
    rows, columns, entries = [], [], []
    for sign, (body, point) in zip((1.0, -1.0), sides(contacts), strict=True):
        which = np.flatnonzero(body < count)
        index = body[which]
        rows.append(np.repeat(which, width))
        columns.append((width * index[:, None] + np.arange(width)).ravel())
        entries.append((sign * rows_on(which, index, point[which])).ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    return sparse.csr_matrix((np.concatenate(entries), places), (len(contacts), count * width))
