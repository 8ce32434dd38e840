"""LU factors, made again for another matrix of the same pattern."""

import gc
import glob
import importlib.util
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse

from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood import factorization
from rigidfluid.taylor_hood.factorization import factorise
from rigidfluid.taylor_hood.lagged_factors import LaggedFactors

N = 400
RIGHT = np.cos(np.arange(N))
PATTERN = sparse.csr_array(abs(sparse.random_array((N, N), density=0.02, rng=0)) + sparse.eye_array(N))
ANALYSE, FACTORISE = 12, 22

with_pardiso = pytest.mark.skipif(importlib.util.find_spec("pypardiso") is None, reason="MKL is not installed")


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
    run = factorization._run
    monkeypatch.setattr(
        factorization, "_run", lambda solver, phase, matrix: seen.append(phase) or run(solver, phase, matrix)
    )
    return seen


@with_pardiso
def test_a_pattern_is_analysed_once(phases):
    factors = None
    for seed in range(5):
        factors = factorise(matrix(seed), factors)
        found = factors.solve(RIGHT)
        np.testing.assert_allclose(matrix(seed) @ found, RIGHT, atol=1e-12)
        np.testing.assert_allclose(found, factorise(matrix(seed)).solve(RIGHT), rtol=1e-10)
    assert phases.count(FACTORISE) == 4
    assert phases.count(ANALYSE) == 1 + 5  # these for comparison


@with_pardiso
def test_another_pattern_is_analysed_anew(phases):
    other = sparse.csr_array(PATTERN + PATTERN.T)
    factors = factorise(matrix(1, other), factorise(matrix(0)))
    np.testing.assert_allclose(matrix(1, other) @ factors.solve(RIGHT), RIGHT, atol=1e-12)
    assert phases == [ANALYSE, ANALYSE]


@with_pardiso
def test_where_the_analysis_does_not_suit_there_is_another(phases):
    """Matched on the diagonal, where the second matrix has zeros."""
    one = sparse.csr_array(np.eye(N) + np.roll(np.eye(N), 1, axis=0))
    swapped = one.copy()
    on_diagonal = np.repeat(np.arange(N), 2) == one.indices
    one.data, swapped.data = np.where(on_diagonal, 1.0, 0.0), np.where(on_diagonal, 0.0, 1.0)
    factors = factorise(swapped, factorise(one))
    np.testing.assert_allclose(swapped @ factors.solve(RIGHT), RIGHT, atol=1e-12)
    assert phases == [ANALYSE, FACTORISE, ANALYSE]


@with_pardiso
def test_where_pardiso_refuses_by_the_old_analysis_there_is_another(monkeypatch):
    run, seen = factorization._run, []

    def refusing(solver, phase, matrix):
        seen.append(phase)
        if phase == FACTORISE:
            raise StepRejected("a", "b", "c", "d")
        run(solver, phase, matrix)

    monkeypatch.setattr(factorization, "_run", refusing)
    factors = factorise(matrix(1), factorise(matrix(0)))
    np.testing.assert_allclose(matrix(1) @ factors.solve(RIGHT), RIGHT, atol=1e-12)
    assert seen == [ANALYSE, FACTORISE, ANALYSE]


@with_pardiso
def test_renewals_by_wasted_iterations_analyse_once_until_all_is_forgotten(phases):
    solver = LaggedFactors(2)
    spread = [matrix(0)]
    for power in range(1, 4):
        spread.append(spread[0].copy())
        spread[-1].data *= np.repeat(10.0 ** (power * RIGHT), np.diff(PATTERN.indptr))
    for each in spread:
        for _ in range(5):
            _, iterations = solver.solve(each.__matmul__, lambda each=each: each, RIGHT, 1e-9)
        assert iterations == 1
    assert phases == [ANALYSE, FACTORISE, FACTORISE, FACTORISE]
    solver.forget()
    solver.solve(each.__matmul__, lambda: each, RIGHT, 1e-9)
    assert phases[4:] == [ANALYSE]


@with_pardiso
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="asks Linux for the memory in use")
@pytest.mark.parametrize("keeps_pattern", [True, False])
def test_renewals_need_no_more_memory_each_time(keeps_pattern):
    """Full factors take 1.3 MB."""
    others = [PATTERN, sparse.csr_array(PATTERN + PATTERN.T)]

    def renewed(factors, seed):
        pattern = sparse.csr_array(others[0 if keeps_pattern else seed % 2])
        return factorise(matrix(seed, pattern), factors)

    factors, used = None, []
    for seed in range(50):
        factors = renewed(factors, seed)
        gc.collect()
        used.append(4096 * int(Path("/proc/self/statm").read_text().split()[1]))
    assert used[-1] - used[10] < 10e6


@with_pardiso
def test_mkl_is_found_without_a_search_of_the_disk(monkeypatch):
    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    monkeypatch.setattr(glob, "glob", lambda *_, **__: pytest.fail("a search of the disk"))
    factorization._library.__wrapped__()


def test_superlu_where_there_is_no_pardiso(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    factors = factorise(matrix(1), factorise(matrix(0)))
    assert not factors.reusable
    np.testing.assert_allclose(matrix(1) @ factors.solve(RIGHT), RIGHT, atol=1e-12)
