"""Unknowns of a mesh, and memory and time of the factors of their matrix, before there is any."""

from __future__ import annotations

from typing import Literal, NamedTuple

from rigidfluid.core.model.types import SolverCost


class Cost(NamedTuple):
    """Predicted cost of a preconditioner: memory in ``bytes`` and CPU ``seconds`` of one core."""

    bytes: float
    seconds: float


_UNKNOWNS = {2: (4.5, -1.5), 3: (4.19, -2.9)}
"""Unknowns for each cell and each facet of the boundary."""

_BYTES = {2: (950.0, 1.062), 3: (563.0, 1.269)}
_SECONDS = {2: (2.35e-6, 1.1), 3: (9.75e-9, 1.84)}
"""Factor and exponent of the number of unknowns."""

_BLOCKS = {2: Cost(1.0e3, 2.2e-6), 3: Cost(1.8e3, 6.0e-6)}
"""Cost of a block triangle for each unknown."""

_PROCESS = {2: 3.4e8, 3: 3.5e8}
_WITHOUT_FACTORS = {"lu": {2: 1.8e3, 3: 3.7e3}, "schur": {2: 1.1e3, 3: 1.6e3}}
"""Memory of a process with interpreter, libraries and compiled kernels, and, for each unknown: matrices, meshes,
states [byte]. Meshers take more while they make a mesh."""

_STEP_SECONDS = {"lu": {2: (4e-3, 1.8e-6), 3: (1e-2, 9e-6)}, "schur": {2: (4e-3, 5e-6), 3: (1e-2, 1.1e-5)}}
"""CPU seconds of one core for each step, and for each unknown of it."""


def predicted_unknowns(cells: float, facets: float, dimension: int) -> float:
    """Unknowns of P2–P1 on M cells with F facets on bodies and boundary, 4.5 M - 1.5 F in 2D, 4.19 M - 2.9 F in 3D.

    In 2D they follow from Euler's formula, velocity given on all facets. In 3D the vertices, 0.17 M + 0.228 F, are
    fitted to meshes of 5,000 to 90,000 cells.
    """
    of_cell, of_facet = _UNKNOWNS[dimension]
    return of_cell * cells + of_facet * facets


def predicted_factors(unknowns: float, dimension: int) -> Cost:
    """Memory and time of a new mesh's first LU factors of single precision by PARDISO, a·Nᵖ.

    Fitted to PARDISO's own counts, analysis and factors together, and to CPU seconds of one core:

    | 2D, unknowns | MB  | s    | 3D, unknowns | MB   | s    |
    |--------------|-----|------|--------------|------|------|
    | 11,627       | 20  | 0.07 | 16,511       | 120  | 0.57 |
    | 43,790       | 82  | 0.29 | 51,118       | 524  | 4.0  |
    | 158,648      | 321 | 1.2  | 139,551      | 1951 | 28.8 |
    | 325,316      | 697 |      | 248,705      | 4017 | 88   |
    |              |     |      | 505,168      | 9153 |      |

    A sphere's box has these within 6 % of the memory and 10 % of the time. In a narrow domain less is filled in: an
    ellipsoid in a flat box took 5.9 GB with 420,809 unknowns, where 7.7 GB are predicted.

    Parameters
    ----------
    unknowns : float
        Unknowns of a step.
    dimension : int
        2 or 3.

    Returns
    -------
    Cost
        Without the matrix itself.
    """
    return Cost(*(factor * unknowns**power for factor, power in (_BYTES[dimension], _SECONDS[dimension])))


def predicted_blocks(unknowns: float, dimension: int) -> Cost:
    """Memory and time of the block triangle of `rigidfluid.taylor_hood.schur`, both in proportion to the unknowns.

    Measured in 3D were 0.26 s with 51,118 unknowns, 0.91 with 139,551, 1.49 with 248,705, and 0.45 GB with the last.
    """
    of_one = _BLOCKS[dimension]
    return Cost(of_one.bytes * unknowns, of_one.seconds * unknowns)


def predicted_run(method: Literal["lu", "schur"], unknowns: float, dimension: int, inertia: bool) -> SolverCost:
    """Predicted cost of the steps of a run in one process, by LU factors of the whole matrix or by blocks.

    With ``inertia`` of the fluid the matrix of the masses has factors too while bodies are near contacts. A falling
    sphere took 5.5 GB by LU and 1.3 GB by blocks with 248,705 unknowns, far from contacts.
    """
    cost = (predicted_factors if method == "lu" else predicted_blocks)(unknowns, dimension)
    without_factors = _PROCESS[dimension] + _WITHOUT_FACTORS[method][dimension] * unknowns
    memory = without_factors + (2 if inertia else 1) * cost.bytes
    of_step, of_unknown = _STEP_SECONDS[method][dimension]
    return SolverCost(method, unknowns, memory, cost.seconds, of_step + of_unknown * unknowns)
