"""Delassus matrix: response of the gaps' rates to the contact forces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.matrices import assembled
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.contacts import sides, turning_radius
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.types import Contacts

_Rows = Callable[[IntArray, IntArray, FloatArray], FloatArray]
"""Rows on the twists (w, c, d+k) of some contacts, their bodies and points."""


def delassus(contacts: Contacts, dynamics: BodyDynamics, time: float) -> Any:
    """Delassus matrix D = G M⁻¹ Gᵀ (m, m), symmetric and positive semidefinite, where G maps the bodies' twists to the
    rates of the gaps, for forces that last for ``time`` [1/mass]; an array for few bodies, sparse for many.

    Walls and prescribed bodies have no inverse mass; the bodies of ``dynamics`` are where the contacts are.
    """
    return _response(contacts, dynamics, time, _point_rows(dynamics, contacts.normal[:, None]))


def delassus_of_points(contacts: Contacts, dynamics: BodyDynamics, time: float) -> Any:
    """Delassus matrix (d·m, d·m) of all components of the relative velocities in the middle of the gaps, those along
    the first axis first, for forces that last for ``time`` [1/mass]."""
    return _response(contacts, dynamics, time, _all_point_rows(contacts, dynamics))


def delassus_of_turning(contacts: Contacts, dynamics: BodyDynamics, time: float) -> Any:
    """Delassus matrix ((d+k)·m, (d+k)·m) of those components, and of those of the relative angular velocities times the
    effective radii after them, for forces and couples over these radii that last for ``time`` [1/mass]."""
    along, about = _all_point_rows(contacts, dynamics), _turning_rows(contacts, dynamics)
    return _response(contacts, dynamics, time, lambda *on: np.concatenate([along(*on), about(*on)], axis=1))


def _response(contacts: Contacts, dynamics: BodyDynamics, time: float, rows_on: _Rows) -> Any:
    rates = _rates(contacts, dynamics, rows_on)
    return rates @ dynamics.inverse_masses(time) @ rates.T


def _all_point_rows(contacts: Contacts, dynamics: BodyDynamics) -> _Rows:
    """Rows of the velocities along each axis."""
    d = contacts.normal.shape[1]
    return _point_rows(dynamics, np.broadcast_to(np.eye(d), (len(contacts), d, d)))


def _point_rows(dynamics: BodyDynamics, directions: FloatArray) -> _Rows:
    """Rows of the velocities along the ``directions`` (m, c, d)."""
    position = dynamics.pose.position

    def rows(which: IntArray, body: IntArray, point: FloatArray) -> FloatArray:
        arm, towards = (point - position[body])[:, None], directions[which]
        return np.concatenate([towards, moment(arm, towards)], axis=2)

    return rows


def _turning_rows(contacts: Contacts, dynamics: BodyDynamics) -> _Rows:
    """Rows of the angular velocities about each axis, times the effective radii."""
    d, k = dynamics.pose.position.shape[1], dynamics.twist.angular_velocity.shape[1]
    about = turning_radius(contacts)[:, :, None] * np.eye(k)

    def rows(which: IntArray, *_: Any) -> FloatArray:
        return np.concatenate([np.zeros((len(which), k, d)), about[which]], axis=2)

    return rows


def _rates(contacts: Contacts, dynamics: BodyDynamics, rows_on: _Rows) -> Any:
    """Matrix (c·m, n·(d+k)) of ``rows_on`` the contacts, + for a and - for b, the first of all contacts first."""
    count, dimension = dynamics.pose.position.shape
    width = dimension + dynamics.twist.angular_velocity.shape[1]
    rows, columns, entries = [], [], []
    for sign, (body, point) in zip((1.0, -1.0), sides(contacts), strict=True):
        which = np.flatnonzero(body < count)
        index = body[which]
        own = sign * rows_on(which, index, point[which])
        row = which[:, None] + len(contacts) * np.arange(own.shape[1])
        rows.append(np.broadcast_to(row[:, :, None], own.shape).ravel())
        columns.append(np.broadcast_to((width * index[:, None] + np.arange(width))[:, None], own.shape).ravel())
        entries.append(own.ravel())
    shape = len(contacts) * own.shape[1], count * width
    return assembled(np.concatenate(entries), np.concatenate(rows), np.concatenate(columns), shape)
