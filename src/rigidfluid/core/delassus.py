"""How the velocities in contacts answer to the forces in them."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.movement import Movement
from rigidfluid.core.rigid import moment
from rigidfluid.core.types import Contacts


def delassus(contacts: Contacts, movement: Movement) -> sparse.csr_matrix:
    """D = G M⁻¹ Gᵀ, where G takes the bodies' twists to the speeds at which the gaps open.

    Parameters
    ----------
    contacts : Contacts
        m contacts.
    movement : Movement
        The n bodies where the contacts are; walls, and bodies that are driven, do not give way.

    Returns
    -------
    (m, m) sparse matrix
        Symmetric, without negative eigenvalues [1/mass].
    """
    position = movement.pose.position
    count, dimension = position.shape
    point = 0.5 * (contacts.point_a + contacts.point_b)
    rows, columns, opening, answer = [], [], [], []
    for sign, body in ((1.0, contacts.body_a), (-1.0, contacts.body_b)):
        which = np.flatnonzero(body < count)
        index, normal = body[which], sign * contacts.normal[which]
        turn = moment(point[which] - position[index], normal)
        width = dimension + turn.shape[1]
        rows.append(np.repeat(which, width))
        columns.append((width * index[:, None] + np.arange(width)).ravel())
        opening.append(np.hstack([normal, turn]).ravel())
        linear = np.einsum("mij,mj->mi", movement.mobility[index], normal)
        angular = np.einsum("mij,mj->mi", movement.inverse_inertia[index], turn)
        answer.append(np.hstack([linear, angular]).ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    shape = len(contacts), count * (dimension + movement.inverse_inertia.shape[1])
    gap_rates = sparse.csr_matrix((np.concatenate(opening), places), shape)
    answers = sparse.csr_matrix((np.concatenate(answer), places), shape)
    return sparse.csr_matrix(gap_rates @ answers.T)
