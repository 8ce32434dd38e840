"""Velocities that are linear in each cell, as combinations of the unknowns: the coarse level of two."""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc
from scipy import sparse

from rigidfluid.backends.dolfinx.constraint import DistributedConstraint


def linear_functions(constraint: DistributedConstraint, constraint_matrix: Any) -> Any:
    """Free velocities and twists by those at vertices and by twists: half-way along an edge is the mean of its ends.

    ``constraint_matrix`` is the constraint's P, which gives vertices on bodies their velocity.
    """
    comm, moving = constraint_matrix.comm, constraint.velocities + constraint.twists
    halves = _halves(constraint, constraint_matrix.getOwnershipRange()[0])
    csr = halves.indptr.astype(PETSc.IntType), halves.indices.astype(PETSc.IntType), halves.data
    mean = PETSc.Mat().createAIJ(((moving, None), (constraint.rows, None)), csr=csr, comm=comm)
    by_all = mean.matMult(constraint_matrix)
    rows = PETSc.IS().createStride(moving, first=by_all.getOwnershipRange()[0], step=1, comm=comm)
    kept = constraint.first_column + np.flatnonzero(constraint.is_coarse)
    found = by_all.createSubMatrix(rows, PETSc.IS().createGeneral(kept.astype(PETSc.IntType), comm=comm))
    found.axpy(1.0, _twists(constraint, found), structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    for matrix in (mean, by_all):
        matrix.destroy()
    return found


def _halves(constraint: DistributedConstraint, first_row: int) -> sparse.csr_array:
    """Each free velocity of this process by the rows of P at its edge's ends; none for twists."""
    space, numbering, d = constraint.space, constraint.space.numbering, constraint.space.numbering.dimension
    number = space.velocities(first_row + np.arange(space.owned_nodes.size * d, dtype=float))
    vertices = np.arange(numbering.vertices)
    ends = np.concatenate([np.column_stack([vertices, vertices]), numbering.edges])[space.owned_nodes]
    columns = np.moveaxis(number[ends], 1, 2).reshape(-1, 2)[constraint.velocity_free].astype(np.int64)
    rows = np.repeat(np.arange(len(columns)), 2)
    shape = (len(columns) + constraint.twists, space.communicator.allreduce(constraint.rows))
    return sparse.coo_array((np.full(columns.size, 0.5), (rows, columns.ravel())), shape=shape).tocsr()


def _twists(constraint: DistributedConstraint, like: Any) -> Any:
    """Ones on the twists, the last of the root's rows and columns."""
    found = PETSc.Mat().createAIJ(like.getSizes(), nnz=1, comm=like.comm)
    row, column = (end - constraint.twists for _, end in (like.getOwnershipRange(), like.getOwnershipRangeColumn()))
    for twist in range(constraint.twists):
        found.setValue(row + twist, column + twist, 1.0)
    found.assemble()
    return found
