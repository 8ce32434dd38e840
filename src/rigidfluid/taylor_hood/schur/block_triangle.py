"""The upper block triangle [[A, Bᵀ], [0, S]] of the coupled matrix, inverted block by block."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.taylor_hood.schur.cahouet_chabard import CahouetChabard
from rigidfluid.taylor_hood.schur.scalar_space import ScalarSpace, scalar_spaces
from rigidfluid.taylor_hood.schur.two_levels import TwoLevels, mean_of_components
from rigidfluid.taylor_hood.system.parts import Parts


class BlockTriangle:
    """Inverse of [[A, Bᵀ], [0, S]]: S by Cahouet and Chabard; A, of velocities and twists, by components, in which
    bodies move without turning, and by how bodies turn.

    Parameters
    ----------
    parts : Parts
        Ingredients of the coupled matrix.
    """

    def __init__(self, parts: Parts) -> None:
        constraint, d = parts.constraint, parts.constraint.surfaces.numbering.dimension
        numbering = constraint.surfaces.numbering
        velocities = numbering.nodes * d
        self._moving = constraint.twist_start + parts.masses.shape[0] * parts.masses.shape[1]
        self._pressures = CahouetChabard(parts)
        self._gradient = _gradient(parts, velocities, self._moving)
        mean = mean_of_components(parts.system_matrix, numbering.nodes, d)
        self._spaces = scalar_spaces(constraint, mean)
        self._levels = [TwoLevels(space, mean, _masses(parts, space)) for space in self._spaces]
        self._turning, self._by_turning, self._turn = self._turns(parts)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """The inverse of the triangle times ``right_side`` (unknowns,)."""
        found = np.empty_like(right_side)
        moving = self._moving
        pressure = self._pressures.solve(right_side[moving:])
        left = right_side[:moving] - self._gradient @ pressure
        turn = np.einsum("nij,nj->ni", self._turn, left[self._turning]).ravel()
        found[:moving] = self._translate(left - self._by_turning @ turn)
        found[self._turning.ravel()] = turn
        found[moving:] = pressure
        return found

    def _translate(self, left: FloatArray) -> FloatArray:
        found = np.zeros_like(left)
        for space, levels in zip(self._spaces, self._levels, strict=True):
            found[space.columns] = levels.solve(left[space.columns])
        return found

    def _turns(self, parts: Parts) -> tuple[IntArray, sparse.csr_array, FloatArray]:
        """The unknowns of each motion's rotation (n, k); A's columns there; and the inverses (n, k, k) of what is left
        of A's blocks there once the velocities are eliminated.

        All bodies turn at once: how one drags another along falls off as the third power of their distance.
        """
        constraint, d = parts.constraint, parts.constraint.surfaces.numbering.dimension
        bodies, width, _ = parts.masses.shape
        turning = constraint.twist_start + np.arange(bodies)[:, None] * width + np.arange(d, width)
        constraint_matrix = constraint.matrix[:, turning.ravel()]
        on_bodies = np.flatnonzero(np.diff(constraint_matrix.indptr))
        rows = (constraint_matrix[on_bodies].T @ parts.system_matrix[on_bodies]).T  # K is symmetric but for convection
        columns = sparse.csr_array(constraint.transposed[: self._moving] @ sparse.csr_array(rows))
        k = width - d
        blocks = np.zeros((bodies, k, k))
        for c in range(k):
            by_all = columns[:, np.arange(bodies) * k + c].sum(axis=1)
            still = by_all.copy()
            still[turning.ravel()] = 0.0
            taken = columns.T @ self._translate(still)
            own = columns[:, np.arange(bodies) * k + c][turning.ravel()].toarray().reshape(bodies, k, bodies)
            blocks[:, :, c] = own[np.arange(bodies), :, np.arange(bodies)] - taken.reshape(bodies, k)
        blocks += parts.masses[:, d:, d:]
        return turning, columns, np.linalg.inv(blocks) if bodies else blocks


def _masses(parts: Parts, space: ScalarSpace) -> FloatArray:
    """The mass of each scalar unknown that is a body's."""
    found = np.zeros(len(space.columns))
    first, width = parts.constraint.twist_start, parts.masses.shape[1]
    place = np.flatnonzero(space.columns[:, 0] >= first)
    body = (space.columns[place, 0] - first) // width
    d = parts.constraint.surfaces.numbering.dimension
    found[place] = np.mean(np.diagonal(parts.masses[:, :d, :d], axis1=1, axis2=2), axis=1)[body]
    return found


def _gradient(parts: Parts, velocities: int, moving: int) -> sparse.csr_array:
    """Bᵀ, what pressures do to velocities and twists."""
    constraint = parts.constraint
    pressures = constraint.matrix[velocities:, moving:]
    to_velocities = parts.system_matrix[:velocities, velocities:] @ pressures
    return sparse.csr_array(constraint.transposed[:moving, :velocities] @ sparse.csr_array(to_velocities))
