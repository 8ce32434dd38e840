"""The extension of boundary values on a mesh in parts, by PETSc."""

from __future__ import annotations

from typing import Any, final

import numpy as np
from petsc4py import PETSc
from scipy.sparse import csc_array, csr_array, diags_array

from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray

_TOLERANCE = 1e-12
"""Relative residual of the iteration: what is left is far below what a cell would feel."""


@final
class DistributedExtension:
    """Solves A_ff u_f = -A_fh u_h, A the sum of the parts' matrices: by Cholesky factors in 2D, by multigrid in 3D.

    ``matrix`` (N, N) is this process' part of A. Values at vertices that are ``held`` (N,) are given; all processes
    that hold a vertex agree on that.
    """

    def __init__(self, space: Space, matrix: csc_array, held: BoolArray) -> None:
        self._space, self._owned = space, len(space.owned_vertices)
        order = space.vertex_of_dof
        ours = csr_array(matrix)[order][:, order]
        self._order, self._free = order, np.flatnonzero(~held)
        on_held, on_free = (diags_array(chosen[order].astype(float)) for chosen in (held, ~held))
        self._coupling = self._summed(on_free @ ours @ on_held)
        self._solver = _solver(self._summed(on_free @ ours @ on_free + on_held), space.numbering.dimension)

    def fill(self, values: FloatArray) -> None:
        given, right_side = self._coupling.createVecs()
        given.array[:] = values[self._order[: self._owned]]
        self._coupling.mult(given, right_side)
        right_side.scale(-1.0)
        solution = given.duplicate()
        self._solver.solve(right_side, solution)
        values[self._free] = self._space.pressures(solution.array)[self._free]

    def _summed(self, ours: Any) -> Any:
        """The sum over the processes, in PETSc's numbers of the vertices."""
        index = self._space.pressure.dofmap.index_map
        local = np.arange(index.size_local + index.num_ghosts, dtype=np.int32)
        comm, kind = self._space.communicator, PETSc.IntType
        numbers = PETSc.LGMap().create(index.local_to_global(local).astype(kind), comm=comm)
        sizes = ((index.size_local, index.size_global),) * 2
        made = PETSc.Mat().createIS(sizes, lgmapr=numbers, lgmapc=numbers, comm=comm)
        part = csr_array(ours)
        csr = part.indptr.astype(kind), part.indices.astype(kind), part.data
        made.setISLocalMat(PETSc.Mat().createAIJ(part.shape, csr=csr, comm=PETSc.COMM_SELF))
        made.assemble()
        return made.convert("aij")


def _solver(matrix: Any, dimension: int) -> Any:
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    ksp = PETSc.KSP().create(matrix.comm)
    ksp.setOperators(matrix)
    ksp.setTolerances(rtol=_TOLERANCE)
    if dimension == 2:
        ksp.setType("preonly")
        ksp.getPC().setType("cholesky")
        ksp.getPC().setFactorSolverType("mumps")
    else:
        ksp.setType("cg")
        ksp.getPC().setType("hypre")
    ksp.setUp()
    return ksp
