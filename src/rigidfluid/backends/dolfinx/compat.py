"""Calls that differ between the supported versions of DOLFINx: 0.9 and newer."""

from __future__ import annotations

from typing import Any

import dolfinx.fem.petsc as assembling
import numpy as np
from dolfinx import graph


def create_block_matrix(blocks: Any) -> Any:
    """A PETSc matrix with the sparsity of a table of forms, the rows of each process together."""
    if hasattr(assembling, "create_matrix_block"):  # until 0.9
        return assembling.create_matrix_block(blocks)
    return assembling.create_matrix(blocks)


def assemble_block_matrix(matrix: Any, blocks: Any) -> None:
    """Overwrite the entries of a ``matrix`` by those of its ``blocks``."""
    matrix.zeroEntries()
    if hasattr(assembling, "assemble_matrix_block"):  # until 0.9
        assembling.assemble_matrix_block(matrix, blocks)
    else:
        assembling.assemble_matrix(matrix, blocks)
    matrix.assemble()


def cell_nodes(mesh: Any) -> Any:
    """DOLFINx' numbers of the geometry's points of each cell: its vertices, then in quadratic ones its edges'."""
    geometry = mesh.geometry
    return geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap  # the second until 0.10


def staying(cells: int, communicator: Any) -> Any:
    """A partition that keeps this many ``cells`` on the rank that has them."""
    made = graph.adjacencylist(np.full((cells, 1), communicator.rank, dtype=np.int32))
    return getattr(made, "_cpp_object", made)  # since 0.10 in a class of Python's
