"""The coupled matrix Pᵀ K P with the bodies' inertia, as an operator and as a matrix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from petsc4py import PETSc

from rigidfluid.backends.dolfinx.constraint import DistributedConstraint
from rigidfluid.backends.dolfinx.products import projected
from rigidfluid.backends.dolfinx.schur import SchurData
from rigidfluid.core.geometry.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Reduced:
    """``matrix`` K and ``constraint_matrix`` P of one step, ``inertia`` (t, t) of the free bodies' twists.

    ``schur()``: data of the Schur complement of the pressures; called by all processes together.
    """

    constraint: DistributedConstraint
    matrix: Any
    constraint_matrix: Any
    inertia: FloatArray
    schur: Callable[[], SchurData]

    def apply(self, x: FloatArray) -> FloatArray:
        """(Pᵀ K P + inertia) x, this process' unknowns (columns,)."""
        given, everything, image, result = self._vectors
        given.array[:] = x
        self.constraint_matrix.mult(given, everything)
        self.matrix.mult(everything, image)
        self.constraint_matrix.multTranspose(image, result)
        found: FloatArray = result.array.copy()
        twists = self.constraint.twist_slice
        if twists.stop > twists.start:
            found[twists] += self.inertia @ x[twists]
        return found

    def expand(self, x: FloatArray) -> FloatArray:
        """P x, of this process' velocities and pressures."""
        given, everything, _, _ = self._vectors
        given.array[:] = x
        self.constraint_matrix.mult(given, everything)
        return np.asarray(everything.array.copy())

    def collect(self, forces: FloatArray) -> FloatArray:
        """Pᵀ of forces on this process' velocities and pressures."""
        _, _, image, result = self._vectors
        image.array[:] = forces
        self.constraint_matrix.multTranspose(image, result)
        return np.asarray(result.array.copy())

    def times(self, everything: FloatArray) -> FloatArray:
        """K times this process' velocities and pressures."""
        _, source, image, _ = self._vectors
        source.array[:] = everything
        self.matrix.mult(source, image)
        return np.asarray(image.array.copy())

    def to_petsc(self, before: Any = None) -> Any:
        """A PETSc matrix, in the place of one that was made ``before`` with the same constraint, if there is one."""
        made = projected(self.matrix, self.constraint_matrix, before)
        made.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        twists = self.constraint.twist_slice
        numbers = np.arange(twists.start, twists.stop, dtype=PETSc.IntType) + self.constraint.first_column
        for number, row in zip(numbers, self.inertia, strict=True):
            coupled = np.flatnonzero(row)  # a zero between two bodies would be a new entry, which takes PETSc long
            made.setValues(number, numbers[coupled], row[coupled], addv=PETSc.InsertMode.ADD)
        made.assemble()
        return made

    @cached_property
    def _vectors(self) -> tuple[Any, Any, Any, Any]:
        everything, reduced = self.matrix.createVecRight(), self.constraint_matrix.createVecRight()
        return reduced, everything, everything.duplicate(), reduced.duplicate()
