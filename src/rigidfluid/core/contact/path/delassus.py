"""Delassus matrix: response of the gaps' rates to the contact forces."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.contacts import middle
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.types import Contacts


def delassus(contacts: Contacts, dynamics: BodyDynamics, time: float) -> sparse.csr_matrix:
    """Delassus matrix D = G M⁻¹ Gᵀ (m, m), symmetric and positive semidefinite, where G maps the bodies' twists to the
    rates of the gaps, for forces that last for ``time`` [1/mass].

    Walls and prescribed bodies have no inverse mass; the bodies of ``dynamics`` are where the contacts are.
    """
    gap_rates = _gap_rates(contacts, dynamics)
    return sparse.csr_matrix(gap_rates @ dynamics.inverse_masses(time) @ gap_rates.T)


def _gap_rates(contacts: Contacts, dynamics: BodyDynamics) -> sparse.csr_matrix:
    """Matrix G (m, n·(d+k))."""
    position = dynamics.pose.position
    count, dimension = position.shape
    width = dimension + dynamics.twist.angular_velocity.shape[1]
    point = middle(contacts)
    rows, columns, opening = [], [], []
    for sign, body in ((1.0, contacts.body_a), (-1.0, contacts.body_b)):
        which = np.flatnonzero(body < count)
        index, normal = body[which], sign * contacts.normal[which]
        rows.append(np.repeat(which, width))
        columns.append((width * index[:, None] + np.arange(width)).ravel())
        opening.append(np.hstack([normal, moment(point[which] - position[index], normal)]).ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    return sparse.csr_matrix((np.concatenate(opening), places), (len(contacts), count * width))
