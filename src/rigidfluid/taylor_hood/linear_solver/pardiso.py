"""MKL's PARDISO, called directly: pypardiso knows double precision alone, and copies the matrix at each call."""

from __future__ import annotations

import ctypes
import functools
import weakref
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.memory import require_memory
from rigidfluid.taylor_hood.linear_solver.mkl import installed_mkl

_ANALYSE, _FACTORISE, _SOLVE, _FREE = 11, 22, 33, -1
_UNSYMMETRIC = 11
_SAME_BITS = 2  # MKL_CBWR_AUTO

# Places in PARDISO's iparm, from 0.
_GIVEN, _REORDERING, _PERMUTATION, _PIVOTS, _SCALED, _MATCHED = 0, 1, 4, 9, 10, 12
_FOR_FACTORS, _ENTRIES, _MFLOP, _SINGLE, _FROM_ZERO = 16, 17, 18, 27, 34
_NESTED_DISSECTION = 2
_TAKEN, _RETURNED = 1, 2

_OUT_OF_MEMORY = -2
_BYTES_OF_ANALYSIS = 56.0
"""An analysis takes about so much for each entry of the matrix."""

_Numbers = NDArray[np.int32]


class PardisoError(Exception):
    """PARDISO refuses; its error code."""


@dataclass(frozen=True)
class Settings:
    """Settings of a factorisation: its ``precision``; whether unknowns are ``matched`` by the matrix' numbers first;
    pivots below 10^-``pivots`` are replaced."""

    precision: type[np.floating[Any]]
    matched: bool
    pivots: int


FAST = Settings(np.float32, matched=False, pivots=6)
"""Half the memory and two thirds of the time of double precision. The analysis asks for the pattern alone, so that it
serves all matrices that have it."""

EXACT, SAFE = Settings(np.float64, matched=True, pivots=13), Settings(np.float64, matched=False, pivots=8)
"""Settings for matrices on which `FAST` fails: unknowns matched first; and small pivots replaced by greater numbers."""


class Orderings:
    """The order of elimination of the latest pattern, for all that factorise it: half of an analysis is to find it."""

    def __init__(self) -> None:
        self._latest: tuple[_Numbers, _Numbers, _Numbers] | None = None

    def find(self, rows: _Numbers, columns: _Numbers) -> _Numbers | None:
        """Order of elimination (N,) of a pattern; None unless it is the latest that `keep` was given."""
        if self._latest is None or not (
            np.array_equal(self._latest[0], rows) and np.array_equal(self._latest[1], columns)
        ):
            return None
        return self._latest[2]

    def keep(self, rows: _Numbers, columns: _Numbers, order: _Numbers) -> None:
        """Keep the order of elimination that was found for a pattern."""
        self._latest = rows, columns, order


class Pardiso:
    """LU factors of matrices of one pattern, which is analysed once.

    Rows and columns are scaled first, so that single precision serves whatever the units are. There is no iterative
    refinement, which the Krylov iteration around the factors does better.

    Parameters
    ----------
    matrix : csr_array
        The pattern, with sorted indices; and the numbers that unknowns are matched by.
    settings : Settings
        Precision, matching and pivots.
    orderings : Orderings
        Known orders of elimination, used unless the order depends on the numbers.

    Raises
    ------
    PardisoError
        If the matrix cannot be analysed.
    StepError
        If analysis or factors do not fit into the memory that is available; nothing is tried then.
    """

    def __init__(self, matrix: sparse.csr_array, settings: Settings, orderings: Orderings) -> None:
        self.settings = settings
        self._rows, self._columns = (each.astype(np.int32, copy=False) for each in (matrix.indptr, matrix.indices))
        self._instance = _Instance(np.zeros(64, np.int64), np.zeros(64, np.int32), matrix.shape[0])
        self._iparm = self._instance.iparm
        self._iparm[[_GIVEN, _FROM_ZERO, _REORDERING, _PIVOTS]] = 1, 1, _NESTED_DISSECTION, settings.pivots
        self._iparm[[_SCALED, _MATCHED]] = settings.matched
        self._iparm[_SINGLE] = settings.precision is np.float32
        self._iparm[[_ENTRIES, _MFLOP]] = -1  # to be counted
        self._threads = threads()
        self._take(matrix)
        self.free = weakref.finalize(self, _call, self._instance, _FREE)
        """Gives PARDISO's memory back."""
        self._analyse(orderings)

    @property
    def reusable(self) -> bool:
        """Tell whether the analysis serves all matrices of the pattern."""
        return self.settings is FAST

    @property
    def rebuild_cost(self) -> int:
        """Cost of factors for other numbers, in iterations: 9 with 45,000 unknowns in 2D, 20 with 20,000 in 3D.

        The times of an operation and of an entry are measured once for all, since a rule by clock time would make
        no two runs alike.
        """
        factors, matrix = float(self._iparm[_ENTRIES]), float(len(self._data))
        renewal = 2e4 * float(self._iparm[_MFLOP]) + 6.5 * factors + 12.0 * matrix  # [ns]
        return 1 + round(renewal / (1.1 * factors + 2.5 * matrix))

    def has_pattern_of(self, matrix: sparse.csr_array) -> bool:
        """Tell whether the analysis serves this matrix.

        It does not with another number of threads than it was made with: factors would end the process.
        """
        rows, columns = matrix.indptr, matrix.indices
        alike = np.array_equal(self._rows, rows) and np.array_equal(self._columns, columns)
        return alike and self._threads == threads()

    def factorise(self, matrix: sparse.csr_array) -> None:
        """Factors of a matrix of this pattern; raises PardisoError where it is singular."""
        self._take(matrix)
        self._run(_FACTORISE)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """The solution for one right side (N,) or many (N, c)."""
        scale = self._scale if right_side.ndim == 1 else self._scale[:, None]
        scaled = scale * right_side
        size = float(np.max(np.abs(scaled), initial=0.0))
        if size == 0.0:
            return np.zeros_like(right_side)
        given = np.asfortranarray(scaled / size, dtype=self.settings.precision)
        found = np.empty_like(given)
        self._run(_SOLVE, given, found)
        solution: FloatArray = (size * scale) * found
        return solution

    def _analyse(self, orderings: Orderings) -> None:
        known = None if self.settings.matched else orderings.find(self._rows, self._columns)
        self._order = np.zeros(len(self._scale), dtype=np.int32) if known is None else known
        if not self.settings.matched:
            self._iparm[_PERMUTATION] = _RETURNED if known is None else _TAKEN
        unknowns = len(self._scale)
        require_memory(_BYTES_OF_ANALYSIS * len(self._data), f"an analysis and factors of {unknowns} unknowns")
        self._run(_ANALYSE)
        require_memory(1024.0 * self._iparm[_FOR_FACTORS], f"factors of {unknowns} unknowns")
        if not self.settings.matched:
            orderings.keep(self._rows, self._columns, self._order)

    def _take(self, matrix: sparse.csr_array) -> None:
        self._scale = np.empty(matrix.shape[0])
        self._data = np.empty(matrix.nnz, dtype=self.settings.precision)
        _scale(self._rows, self._columns, matrix.data, self._scale, self._data)

    def _run(self, phase: int, *sides: Any) -> None:
        """A phase, with the right sides and where their solutions go."""
        matrix = self._data, self._rows, self._columns, self._order
        error = _call(self._instance, phase, matrix, sides)
        if error == _OUT_OF_MEMORY:
            raise MemoryError(f"PARDISO cannot allocate factors of {len(self._scale)} unknowns")
        if error:
            raise PardisoError(f"PARDISO's error {error} in phase {phase}")


@functools.cache
def _library() -> Any:
    """The loaded MKL, told to answer the same question with the same bits (conditional numerical reproducibility)."""
    path = installed_mkl()
    library = _search_by_pypardiso() if path is None else ctypes.CDLL(str(path))
    library.MKL_CBWR_Set(ctypes.c_int(_SAME_BITS))
    return library


def threads() -> int:
    """Number of threads that MKL takes now."""
    return int(_library().MKL_Get_Max_Threads())


def _search_by_pypardiso() -> Any:
    """The library as pypardiso finds it, by searching the disk, which may take a second."""
    from pypardiso.pardiso_wrapper import PyPardisoSolver

    return PyPardisoSolver().libmkl


class _Instance(NamedTuple):
    """One solver in PARDISO's memory: its ``handle`` (64,), its parameters ``iparm`` (64,), the number of unknowns."""

    handle: NDArray[np.int64]
    iparm: _Numbers
    size: int


def _call(instance: _Instance, phase: int, matrix: Any = (), sides: Any = ()) -> int:
    """One phase; the error code, zero if there is none."""
    columns = sides[0].shape[1] if sides and sides[0].ndim == 2 else 1
    integers = (ctypes.c_int32(each) for each in (1, 1, _UNSYMMETRIC, phase, instance.size, columns, 0))
    copies, number, kind, phases, sizes, right_sides, silent = map(ctypes.byref, integers)
    data, rows, places, order = map(_address, matrix or (None,) * 4)
    given, found = map(_address, sides or (None,) * 2)
    error = ctypes.c_int32(0)
    _library().pardiso(
        _address(instance.handle), copies, number, kind, phases, sizes, data, rows, places, order, right_sides,
        _address(instance.iparm), silent, given, found, ctypes.byref(error),
    )  # fmt: skip
    return error.value


def _address(array: Any) -> Any:
    return None if array is None else array.ctypes.data_as(ctypes.c_void_p)


@njit(cache=True)
def _scale(rows: Any, columns: Any, data: Any, scale: Any, scaled: Any) -> None:
    """Scale rows and columns alike, the greatest entry of each row to about one."""
    for row in range(len(scale)):
        greatest = 0.0
        for place in range(rows[row], rows[row + 1]):
            greatest = max(greatest, abs(data[place]))
        scale[row] = 1.0 / np.sqrt(greatest) if greatest > 0.0 else 1.0
    for row in range(len(scale)):
        for place in range(rows[row], rows[row + 1]):
            scaled[place] = scale[row] * data[place] * scale[columns[place]]
