"""How the velocities in contacts answer to the forces in them."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.mechanics.dynamics import BodyDynamics
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.contacts import middle
from rigidfluid.core.model.types import Contacts


def delassus(contacts: Contacts, movement: BodyDynamics, time: float) -> sparse.csr_matrix:
    """D = G M⁻¹ Gᵀ, where G takes the bodies' twists to the speeds at which the gaps open.

    Parameters
    ----------
    contacts : Contacts
        m contacts.
    movement : BodyDynamics
        The n bodies where the contacts are; walls, and bodies that are driven, do not give way.
    time : float
        For how long the contacts' forces last [time].

    Returns
    -------
    (m, m) sparse matrix
        Symmetric, without negative eigenvalues [1/mass].
    """
    gap_rates = _gap_rates(contacts, movement)
    return sparse.csr_matrix(gap_rates @ movement.inverse_masses(time) @ gap_rates.T)


def _gap_rates(contacts: Contacts, movement: BodyDynamics) -> sparse.csr_matrix:
    """G, (m, n·(d+k))."""
    position = movement.pose.position
    count, dimension = position.shape
    width = dimension + movement.twist.angular_velocity.shape[1]
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
