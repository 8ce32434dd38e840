"""The velocity without divergence that is nearest to another one, by conjugate gradients along such velocities."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver.factorization import factorise
from rigidfluid.taylor_hood.linear_solver.few_columns import times
from rigidfluid.taylor_hood.linear_solver.pardiso import Orderings
from rigidfluid.taylor_hood.system.constraint import Constraint

_MOST = 200
"""Greatest number of iterations, which do not depend on the mesh on straight cells: 6 a digit in 3D, 3 in 2D."""

_REFINEMENTS, _ROUND_OFF = 5, 1e-13
"""Refinements at most of a solution by factors in single precision, where the iteration starts and ends, and the
relative residual at which it needs no more: rounding leaves 1e-15 to 1e-13, and two refinements reach it as a rule."""


class Masses(NamedTuple):
    """(φⱼ, φᵢ) of the quadratic basis, ``mass`` (nodes, nodes), and -(∇·u, q), ``divergence`` (vertices, nodes · d)."""

    mass: sparse.csr_array
    divergence: sparse.csr_array


class SparseProjection:
    """Minimises ½ (v - u, v - u) over v = prescribed + P x with B v = 0, prescribed on bodies and faces.

    Conjugate gradients preconditioned by D, the diagonal of the mass matrix, whose steps are g - D⁻¹Bᵀ(B D⁻¹Bᵀ)⁻¹B g
    (Gould, Hribar and Nocedal 2001, doi:10.1137/S1064827598345667). The matrix in brackets has a row for each pressure,
    and is factorised. All iterates are free of divergence, to round-off, so that what the iteration leaves
    is no burst of pressure.

    Parameters
    ----------
    masses : Masses
        Masses on one geometry.
    constraint : Constraint
        P, placed there; all bodies are prescribed.
    orderings : Orderings
        Orders of elimination of matrices on the same topology.
    """

    def __init__(self, masses: Masses, constraint: Constraint, orderings: Orderings) -> None:
        self._mass, self._constraint = masses.mass, constraint
        velocities, free = masses.divergence.shape[1], constraint.twist_start
        self._spread = constraint.matrix[:velocities, :free]
        self._collect = constraint.transposed[:free, :velocities]
        pressures = constraint.transposed[constraint.first_pressure :, velocities:]
        self._whole_divergence = sparse.csr_array(pressures @ masses.divergence)
        self._divergence = sparse.csr_array(self._whole_divergence @ self._spread)
        self._gradient = sparse.csr_array(self._divergence.T)
        self._axes = velocities // masses.mass.shape[0]
        self._diagonal = self._collect.power(2) @ np.repeat(masses.mass.diagonal(), self._axes)
        self._laplacian = sparse.csr_array(self._divergence @ (self._gradient / self._diagonal[:, None]))
        self._factors = factorise(self._laplacian, None, orderings)

    def product(self, first: FloatArray, second: FloatArray) -> float:
        """(first, second) of two velocities (nodes, d)."""
        return float(np.sum(first * times(self._mass, second)))

    def nearest(
        self, velocity: FloatArray, tolerance: float, guess: FloatArray, prescribed: FloatArray | None = None
    ) -> FloatArray:
        """The velocity (nodes, d) without divergence nearest to ``velocity``, and equal to ``prescribed`` where it is.

        Its residual is ``tolerance`` times the norm of the ``guess``' load; raises StepRejected.
        """
        constraint, surfaces = self._constraint, self._constraint.surfaces
        prescribed = surfaces.prescribed_part(velocity if prescribed is None else prescribed)
        x = surfaces.frames.local_components(guess).ravel()[constraint.free_unknowns[: constraint.twist_start]]
        x = self._without_divergence(prescribed, x)
        enough = tolerance * float(np.linalg.norm(self._load(self._whole(prescribed, x))))
        iterations = 0
        while True:  # round-off in single precision takes the iterates off those without divergence
            residual = self._load(velocity - self._whole(prescribed, x))
            residual = residual - self._force(self._divergence @ (residual / self._diagonal), refined=True)
            if np.linalg.norm(residual) <= enough:
                return self._whole(prescribed, x)
            if iterations >= _MOST:
                raise StepRejected(
                    "fluid.tolerance",
                    f"a projection that does not converge to {tolerance:.1e} in {_MOST} iterations",
                    "a converging one",
                    "Loosen fluid.tolerance.",
                )
            correction, spent = self._correction(residual, enough, _MOST - iterations)
            x, iterations = self._without_divergence(prescribed, x + correction), iterations + spent

    def _correction(self, residual: FloatArray, enough: float, most: int) -> tuple[FloatArray, int]:
        """Correction of x for a ``residual``, iterated until its norm is ``enough``, and the iterations, at
        ``most``."""
        found, still = np.zeros_like(residual), np.zeros((self._mass.shape[0], self._axes))
        step = direction = residual / self._diagonal
        product = residual @ step
        for iteration in range(most):
            image = self._load(self._whole(still, direction))
            length = product / (direction @ image)
            found, residual = found + length * direction, residual - length * image
            residual = residual - self._force(self._divergence @ (residual / self._diagonal))
            if np.linalg.norm(residual) <= enough:
                return found, iteration + 1
            step, before = residual / self._diagonal, product
            product = residual @ step
            direction = step + (product / before) * direction
        return found, most

    def _without_divergence(self, prescribed: FloatArray, x: FloatArray) -> FloatArray:
        """The nearest x in D's measure, to round-off."""
        divergence = self._divergence @ x + self._whole_divergence @ prescribed.ravel()
        nearest: FloatArray = x - self._force(divergence, refined=True) / self._diagonal
        return nearest

    def _force(self, divergence: FloatArray, refined: bool = False) -> FloatArray:
        """Bᵀp whose velocities D⁻¹Bᵀp have this ``divergence``, to single precision, or ``refined`` to round-off."""
        pressure = self._factors.solve(divergence)
        enough = _ROUND_OFF * np.linalg.norm(divergence)
        for _ in range(_REFINEMENTS if refined else 0):
            residual = divergence - self._laplacian @ pressure
            if np.linalg.norm(residual) <= enough:
                break
            pressure = pressure + self._factors.solve(residual)
        force: FloatArray = self._gradient @ pressure
        return force

    def _whole(self, prescribed: FloatArray, x: FloatArray) -> FloatArray:
        return prescribed + (self._spread @ x).reshape(prescribed.shape)

    def _load(self, velocity: FloatArray) -> FloatArray:
        """(velocity, v) of the free test functions."""
        return np.asarray(self._collect @ times(self._mass, velocity).ravel())
