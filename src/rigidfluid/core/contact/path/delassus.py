"""Delassus matrix: response of the gaps' rates to the contact forces."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.contacts import middle
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
    axes = np.eye(contacts.normal.shape[1])
    rates = [_point_rates(contacts, dynamics, np.broadcast_to(axis, contacts.normal.shape)) for axis in axes]
    return _response(sparse.csr_matrix(sparse.vstack(rates)), dynamics, time)


def _response(rates: sparse.csr_matrix, dynamics: BodyDynamics, time: float) -> sparse.csr_matrix:
    return sparse.csr_matrix(rates @ dynamics.inverse_masses(time) @ rates.T)


def _point_rates(contacts: Contacts, dynamics: BodyDynamics, direction: FloatArray) -> sparse.csr_matrix:
    """Matrix G (m, n·(d+k)) that maps the bodies' twists to the relative velocity along a ``direction`` (m, d)."""
    position = dynamics.pose.position
    count, dimension = position.shape
    width = dimension + dynamics.twist.angular_velocity.shape[1]
    point = middle(contacts)
    rows, columns, opening = [], [], []
    for sign, body in ((1.0, contacts.body_a), (-1.0, contacts.body_b)):
        which = np.flatnonzero(body < count)
        index, along = body[which], sign * direction[which]
        rows.append(np.repeat(which, width))
        columns.append((width * index[:, None] + np.arange(width)).ravel())
        opening.append(np.hstack([along, moment(point[which] - position[index], along)]).ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    return sparse.csr_matrix((np.concatenate(opening), places), (len(contacts), count * width))
