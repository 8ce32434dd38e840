"""LU factors, made again for another matrix of the same pattern."""

import ctypes
import gc
import glob
import importlib.util
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import sparse

from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver import pardiso
from rigidfluid.taylor_hood.linear_solver.factorization import factorise
from rigidfluid.taylor_hood.linear_solver.lagged_factors import LaggedFactors
from rigidfluid.taylor_hood.linear_solver.lagged_solver import Operator
from rigidfluid.taylor_hood.linear_solver.pardiso import EXACT, FAST, Orderings, Pardiso, PardisoError

N = 400
RIGHT = np.cos(np.arange(N))
PATTERN = sparse.csr_array(abs(sparse.random_array((N, N), density=0.02, rng=0)) + sparse.eye_array(N))
ANALYSE, FACTORISE = 11, 22
SINGLE = 1e-5  # of what single precision gives

with_pardiso = pytest.mark.skipif(importlib.util.find_spec("pypardiso") is None, reason="MKL is not installed")


def system(matrix):
    """A matrix, and what its factors are made from."""
    return Operator(matrix.__matmul__, lambda: SimpleNamespace(reduced=lambda: matrix))


def matrix(seed, pattern=PATTERN):
    """One of ``pattern``, with zeros in it."""
    made = pattern.copy()
    made.data = np.random.default_rng(seed).normal(size=made.nnz)
    made.data[:: 7 + seed] = 0.0
    made.setdiag(N)
    made.sort_indices()
    return made


@pytest.fixture
def phases(monkeypatch):
    """The phases that PARDISO has run, but for solving."""
    seen = []
    run = Pardiso._run

    def recorded(self, phase, *sides):
        seen.extend([] if sides else [phase])
        run(self, phase, *sides)

    monkeypatch.setattr(Pardiso, "_run", recorded)
    return seen


@with_pardiso
def test_a_pattern_is_analysed_once(phases):
    factors = None
    for seed in range(5):
        factors = factorise(matrix(seed), factors)
        found = factors.solve(RIGHT)
        np.testing.assert_allclose(matrix(seed) @ found, RIGHT, atol=SINGLE)
        np.testing.assert_array_equal(found, factorise(matrix(seed)).solve(RIGHT))
    assert phases.count(FACTORISE) == 10
    assert phases.count(ANALYSE) == 1 + 5  # these for comparison


@with_pardiso
def test_another_pattern_is_analysed_anew(phases):
    other = sparse.csr_array(PATTERN + PATTERN.T)
    factors = factorise(matrix(1, other), factorise(matrix(0)))
    np.testing.assert_allclose(matrix(1, other) @ factors.solve(RIGHT), RIGHT, atol=SINGLE)
    assert phases == [ANALYSE, FACTORISE] * 2


@with_pardiso
def test_another_number_of_threads_has_the_pattern_analysed_anew(phases, monkeypatch):
    """PARDISO ends the process where it is given fewer than its analysis has seen."""
    factors = factorise(matrix(0))
    now = pardiso.threads()
    monkeypatch.setattr(pardiso, "threads", lambda: now + 1)
    np.testing.assert_allclose(matrix(1) @ factorise(matrix(1), factors).solve(RIGHT), RIGHT, atol=SINGLE)
    assert phases == [ANALYSE, FACTORISE] * 2


@with_pardiso
def test_a_known_order_of_elimination_gives_the_same_bits():
    orderings = Orderings()
    one, other = (factorise(matrix(0), None, orderings) for _ in range(2))
    assert other._order is one._order
    np.testing.assert_array_equal(one.solve(RIGHT), other.solve(RIGHT))
    np.testing.assert_array_equal(one.solve(RIGHT), factorise(matrix(0)).solve(RIGHT))


@with_pardiso
@pytest.mark.parametrize("unit", [1e-60, 1e60])
def test_single_precision_serves_in_any_units(unit):
    scaled = matrix(0) * unit
    for right_side in (RIGHT, unit * RIGHT, np.column_stack([RIGHT, 2.0 * RIGHT])):
        np.testing.assert_allclose(
            scaled @ factorise(scaled).solve(right_side), right_side, rtol=0, atol=SINGLE * abs(right_side).max()
        )


@with_pardiso
def test_a_zero_right_side_has_a_zero_solution():
    np.testing.assert_array_equal(factorise(matrix(0)).solve(np.zeros(N)), np.zeros(N))


@with_pardiso
def test_where_small_pivots_spoil_the_fast_factors_others_are_made(phases):
    """The diagonal is zero, and no order of elimination helps: unknowns must be matched."""
    shift = sparse.csr_array(np.roll(np.eye(N), 1, axis=0) + 0.0 * np.eye(N))
    shift = sparse.csr_array(shift + sparse.diags_array(np.full(N, 1e-12)))
    factors = factorise(shift)
    np.testing.assert_allclose(shift @ factors.solve(RIGHT), RIGHT, atol=1e-9)
    assert factors.settings is EXACT
    assert not factors.reusable
    assert factorise(matrix(0), factors).settings is FAST


@with_pardiso
def test_factors_that_find_another_solution_with_the_same_residual_are_not_used():
    """A long beam, held at both ends: rounding of its forces in single precision bends it."""
    weights = [1.0, -4.0, 6.0, -4.0, 1.0]
    beam = sparse.csr_array(sparse.diags_array(weights, offsets=range(-2, 3), shape=(N, N)))
    single = Pardiso(beam, FAST, Orderings())
    single.factorise(beam)
    right_side = beam @ np.ones(N)
    wrong = single.solve(right_side)
    assert np.linalg.norm(beam @ wrong - right_side) < 1e-4 * np.linalg.norm(right_side)
    assert abs(wrong - 1.0).max() > 0.1
    factors = factorise(beam)
    assert factors.settings is EXACT
    np.testing.assert_allclose(factors.solve(right_side), 1.0, atol=1e-6)


@with_pardiso
def test_what_pardiso_refuses_is_a_singular_matrix(monkeypatch):
    def refusing(self, matrix):
        raise PardisoError("error -4")

    monkeypatch.setattr(Pardiso, "factorise", refusing)
    with pytest.raises(StepRejected, match="cannot be factorised"):
        factorise(matrix(0))


@with_pardiso
def test_more_operations_make_factors_dearer():
    blocks = sparse.csr_array(sparse.block_diag([np.ones((4, 4)) + 9.0 * np.eye(4)] * (N // 4)))
    full = sparse.csr_array(np.ones((N, N)) + N * np.eye(N))
    assert 1 < factorise(blocks).rebuild_cost < factorise(full).rebuild_cost


@with_pardiso
def test_renewals_by_wasted_iterations_analyse_once_until_all_is_forgotten(phases):
    solver = LaggedFactors(2)
    spread = [matrix(0)]
    for power in range(1, 4):
        spread.append(spread[0].copy())
        spread[-1].data *= np.repeat(10.0 ** (power * RIGHT), np.diff(PATTERN.indptr))
    for each in spread:
        for _ in range(5):
            solver.solve(system(each), RIGHT, 1e-9, again=True)
    assert phases.count(ANALYSE) == 1
    assert phases.count(FACTORISE) >= 4
    solver.forget()
    phases.clear()
    solver.solve(system(each), RIGHT, 1e-9)
    assert phases == [ANALYSE, FACTORISE]


@with_pardiso
@pytest.mark.parametrize("keeps_pattern", [True, False])
def test_renewals_need_no_more_memory_each_time(keeps_pattern):
    others = [PATTERN, sparse.csr_array(PATTERN + PATTERN.T)]
    factors, used = None, []
    gc.collect()
    for seed in range(20):
        pattern = sparse.csr_array(others[0 if keeps_pattern else seed % 2])
        factors = factorise(matrix(seed, pattern), factors)
        used.append(allocated_by_mkl())
    assert used[2:] == used[:2] * 9


def allocated_by_mkl():
    """Memory that MKL holds at the moment [bytes]."""
    count = pardiso._library().MKL_Mem_Stat
    count.restype = ctypes.c_int64
    return count(ctypes.byref(ctypes.c_int()))


@with_pardiso
def test_mkl_is_found_without_a_search_of_the_disk(monkeypatch):
    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    monkeypatch.setattr(glob, "glob", lambda *_, **__: pytest.fail("a search of the disk"))
    pardiso._library.__wrapped__()


def test_superlu_where_there_is_no_pardiso(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    factors = factorise(matrix(1), factorise(matrix(0)))
    assert not factors.reusable
    np.testing.assert_allclose(matrix(1) @ factors.solve(RIGHT), RIGHT, atol=1e-12)
