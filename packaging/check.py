"""Tries what rigidfluid takes of DOLFINx's installation: mpirun -n 2 python3 packaging/check.py."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import dolfinx
import h5py
import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

import rigidfluid

COMM = MPI.COMM_WORLD
SOLVERS = {"MUMPS": ("preonly", "lu", "mumps"), "hypre": ("cg", "hypre", None)}


def laplacian(size: int) -> PETSc.Mat:
    """A matrix that is shared out over the processes."""
    matrix = PETSc.Mat().createAIJ((size, size), nnz=3, comm=COMM)
    for row in range(*matrix.getOwnershipRange()):
        for column, value in ((row - 1, -1.0), (row, 2.0), (row + 1, -1.0)):
            if 0 <= column < size:
                matrix[row, column] = value
    matrix.assemble()
    return matrix


def residual(method: str, preconditioner: str, package: str | None) -> float:
    """Relative residual of a solution by a package that PETSc was built with; raises where it was not."""
    matrix = laplacian(1000)
    solution, right = matrix.createVecs()
    right.set(1.0)
    solver = PETSc.KSP().create(COMM)
    solver.setOperators(matrix)
    solver.setType(method)
    solver.getPC().setType(preconditioner)
    if package:
        solver.getPC().setFactorSolverType(package)
    solver.setTolerances(rtol=1e-10)
    solver.solve(right, solution)
    return float((right - matrix * solution).norm() / right.norm())


def shared_file(folder: Path) -> bool:
    """Whether all processes write one HDF5 file and read it back."""
    with h5py.File(folder / "shared.h5", "w", driver="mpio", comm=COMM) as file:
        file.create_dataset("rank", (COMM.size,), dtype="i8")[COMM.rank] = COMM.rank
    with h5py.File(folder / "shared.h5", "r", driver="mpio", comm=COMM) as file:
        return bool(np.array_equal(file["rank"][:], np.arange(COMM.size)))


def main() -> int:
    """Print a line for each part; the status is 1 where one of them fails."""
    if COMM.size == 1:
        sys.exit("found 1 process; allowed are 2 or more: mpirun -n 2 python3 packaging/check.py")
    with tempfile.TemporaryDirectory() as own:
        folder = COMM.bcast(Path(own))
        found = {name: residual(*options) < 1e-8 for name, options in SOLVERS.items()}
        found["HDF5 on several processes"] = shared_file(folder)
        COMM.barrier()
    if COMM.rank == 0:
        print(f"rigidfluid {rigidfluid.__version__}, DOLFINx {dolfinx.__version__}, PETSc {PETSc.Sys.getVersion()}")
        for name, works in found.items():
            print(f"{name}: {'works' if works else 'does not work'} on {COMM.size} processes")
    return 0 if all(found.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
