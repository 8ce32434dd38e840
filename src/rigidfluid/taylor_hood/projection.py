"""The velocity without divergence that is nearest to another one, by conjugate gradients along such velocities."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from scipy import sparse

from rigidfluid.core.model.types import FloatArray
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.constraint import Constraint
from rigidfluid.taylor_hood.factorization import factorise
from rigidfluid.taylor_hood.pardiso import Orderings

_MOST = 200
"""Iterations. On straight cells they do not depend on the mesh: 6 a digit in 3D, 3 in 2D."""

_SWEEPS = 2
"""Of factors in single precision, for what is equal to round-off."""


class Masses(NamedTuple):
    """(φⱼ, φᵢ) of the quadratic basis, ``mass`` (nodes, nodes), and -(∇·u, q), ``divergence`` (vertices, nodes · d)."""

    mass: sparse.csr_array
    divergence: sparse.csr_array


class SparseProjection:
    """Minimises ½ (v - u, v - u) over v = held + P x with B v = 0, held where bodies and faces give it.

    Conjugate gradients preconditioned by D, the diagonal of the mass matrix, whose steps are g - D⁻¹Bᵀ(B D⁻¹Bᵀ)⁻¹B g
    (Gould, Hribar and Nocedal 2001, doi:10.1137/S1064827598345667). The matrix in brackets has a row for each pressure,
    and is factorised. All iterates are free of divergence, to round-off, so that what the iteration leaves
    is no burst of pressure.

    Parameters
    ----------
    masses : Masses
        On one geometry.
    constraint : Constraint
        P, placed there; all bodies are held.
    orderings : Orderings
        Of matrices on the same topology.
    """

    def __init__(self, masses: Masses, constraint: Constraint, orderings: Orderings) -> None:
        self._mass, self._constraint = masses.mass, constraint
        velocities, free = masses.divergence.shape[1], constraint.twist_start
        self._spread = constraint.operator[:velocities, :free]
        self._collect = constraint.transposed[:free, :velocities]
        pressures = constraint.transposed[constraint.first_pressure :, velocities:]
        self._whole_divergence = sparse.csr_array(pressures @ masses.divergence)
        self._divergence = sparse.csr_array(self._whole_divergence @ self._spread)
        self._gradient = sparse.csr_array(self._divergence.T)
        d = velocities // masses.mass.shape[0]
        self._diagonal = self._collect.power(2) @ np.repeat(masses.mass.diagonal(), d)
        self._laplacian = sparse.csr_array(self._divergence @ (self._gradient / self._diagonal[:, None]))
        self._factors = factorise(self._laplacian, None, orderings)

    def product(self, first: FloatArray, second: FloatArray) -> float:
        """(first, second) of two velocities (nodes, d)."""
        return float(np.sum(first * _times(self._mass, second)))

    def nearest(self, velocity: FloatArray, tolerance: float, guess: FloatArray) -> FloatArray:
        """The velocity (nodes, d) without divergence nearest to ``velocity``, which it equals where that is held.

        To a residual of ``tolerance`` times the norm of the ``guess``' load; raises StepRejected.
        """
        constraint, surfaces = self._constraint, self._constraint.surfaces
        held = surfaces.held_part(velocity)
        free = constraint.free_unknowns[: constraint.twist_start]
        x = surfaces.frames.into(guess).ravel()[free]
        x -= self._potential(self._divergence @ x + self._whole_divergence @ held.ravel(), _SWEEPS)[1]
        present = self._whole(held, x)
        enough = tolerance * np.linalg.norm(self._load(present))
        residual = self._load(velocity - present)
        direction, before = np.zeros_like(x), 1.0
        for _ in range(_MOST):
            force, step = self._potential(self._divergence @ (residual / self._diagonal), 0)
            residual = residual - force
            step = residual / self._diagonal
            if np.linalg.norm(residual) <= enough:
                break
            now = residual @ step
            direction = step + (now / before) * direction
            image = self._load(self._whole(np.zeros_like(held), direction))
            length = now / (direction @ image)
            x, residual, before = x + length * direction, residual - length * image, now
        else:
            raise StepRejected(
                "fluid.tolerance",
                f"a velocity whose projection does not converge to {tolerance:.1e} in {_MOST} iterations",
                "a converging one",
                "Loosen fluid.tolerance.",
            )
        x -= self._potential(self._divergence @ x + self._whole_divergence @ held.ravel(), _SWEEPS)[1]
        return self._whole(held, x)

    def _potential(self, divergence: FloatArray, sweeps: int) -> tuple[FloatArray, FloatArray]:
        """The pressure's force that gives velocities of this ``divergence``, in D's measure, and these."""
        pressure = self._factors.solve(divergence)
        for _ in range(sweeps):
            pressure = pressure + self._factors.solve(divergence - self._laplacian @ pressure)
        force = self._gradient @ pressure
        return force, force / self._diagonal

    def _whole(self, held: FloatArray, x: FloatArray) -> FloatArray:
        return held + (self._spread @ x).reshape(held.shape)

    def _load(self, velocity: FloatArray) -> FloatArray:
        """(velocity, v) of the free test functions."""
        return np.asarray(self._collect @ _times(self._mass, velocity).ravel())


def _times(matrix: sparse.csr_array, field: FloatArray) -> FloatArray:
    """The matrix (N, N) times a field (N, d); SciPy takes three times as long."""
    result = np.zeros_like(field)
    _add_product(result, matrix.indptr, matrix.indices, matrix.data, field, tuple(range(field.shape[1])))
    return result


@njit(cache=True)
def _add_product(result, rows, columns, data, field, axes):
    for row in range(len(rows) - 1):
        for slot in range(rows[row], rows[row + 1]):
            column, entry = columns[slot], data[slot]
            for axis in range(len(axes)):
                result[row, axis] += entry * field[column, axis]
