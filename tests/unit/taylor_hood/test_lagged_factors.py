"""GMRES behind old factors: when they are renewed, and when it gives up."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import sparse

from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver import lagged_factors
from rigidfluid.taylor_hood.linear_solver.known_answers import MOST
from rigidfluid.taylor_hood.linear_solver.lagged_factors import LaggedFactors
from rigidfluid.taylor_hood.linear_solver.lagged_solver import Operator

N = 200
RIGHT = np.eye(N)[0]
IDENTITY = sparse.csr_array(sparse.eye_array(N))
SHIFT = sparse.csr_array(np.roll(np.eye(N), 1, axis=0))  # GMRES does not get anywhere in fewer than N iterations


def of(matrix):
    """What factors are made from."""
    return SimpleNamespace(reduced=lambda: matrix)


def system(matrix, made_of=None):
    """A matrix, and the one that factors are made from if it is another."""
    return Operator(matrix.__matmul__, lambda: of(matrix if made_of is None else made_of))


@pytest.fixture
def made(monkeypatch):
    count = []
    factorise = lagged_factors.factorise
    monkeypatch.setattr(lagged_factors, "factorise", lambda *given: count.append(1) or factorise(*given))
    return count


def test_stale_factors_that_fail_are_renewed_once(made):
    solver = LaggedFactors(2)
    solver.solve(system(IDENTITY), RIGHT, 1e-9)
    found, _ = solver.solve(system(SHIFT), RIGHT, 1e-9)
    np.testing.assert_allclose(SHIFT @ found, RIGHT, atol=1e-9)
    assert len(made) == 2


def test_stale_factors_are_given_up_when_they_have_wasted_their_price_twice(made):
    solver, applied = LaggedFactors(2), []
    solver.solve(system(IDENTITY), RIGHT, 1e-9)

    def shift(x):
        applied.append(1)
        return SHIFT @ x

    assert solver.solve(Operator(shift, lambda: of(SHIFT)), RIGHT, 1e-9)[1] == 1
    assert len(applied) <= LaggedFactors.fresh_iterations + 2 * LaggedFactors.rebuild_cost[2] + 5
    assert len(made) == 2


def test_factors_that_columns_have_made_are_stale_for_another_matrix(made):
    solver = LaggedFactors(2)
    solver.solve_columns(system(IDENTITY), np.asfortranarray(np.eye(N)[:, :2]), 1e-9)
    assert solver.solve(system(SHIFT), RIGHT, 1e-9)[1] == 1
    assert len(made) == 2


def test_columns_take_no_more_sweeps_of_stale_factors_than_there_are_eigenvalues(made):
    """Of 1 and 2, where sweeps that take the factors for the inverse do not converge; each column by itself."""
    matrix, sides = sparse.csr_array(sparse.diags_array(1.0 + np.arange(N) % 2)), np.zeros((N, 3), order="F")
    sides[:, 0], sides[:2, 2] = np.cos(np.arange(N)), 1.0
    solver, applied = LaggedFactors(2), []
    solver.solve(system(IDENTITY), RIGHT, 1e-9)
    found = solver.solve_columns(Operator(lambda x: applied.append(1) or matrix @ x, lambda: of(matrix)), sides, 1e-6)
    np.testing.assert_allclose(matrix @ found, sides, atol=1e-6)
    assert len(applied) == 2
    assert len(made) == 1


def test_answers_to_loads_that_come_again_are_first_guesses():
    """A load that is known takes no sweep of the same matrix, and fewer of one that differs little."""
    solver, applied = LaggedFactors(2), []
    near = sparse.csr_array(sparse.diags_array(1.0 + 1e-4 * (np.arange(N) % 7)))
    sides, loads = np.asfortranarray(np.eye(N)[:, :3] + 1.0), np.eye(3)

    def sweeps(matrix, columns):
        applied.clear()
        operator = Operator(lambda x: applied.append(1) or matrix @ x, lambda: of(IDENTITY))
        found = solver.solve_loads(operator, sides[:, columns], 1e-6, loads[:, columns])
        np.testing.assert_allclose(matrix @ found, sides[:, columns], atol=2e-5)
        return len(applied)

    first = sweeps(near, [0, 1])
    assert sweeps(near, [1, 0]) == 1  # the residual alone
    assert sweeps(near, [2]) == first
    assert sweeps(sparse.csr_array(1.001 * near), [0, 1, 2]) == 2
    solver.forget()
    assert sweeps(near, [0, 1]) == first


def test_no_more_answers_are_kept_than_bodies_may_have():
    solver, sides = LaggedFactors(2), np.asfortranarray(np.eye(N)[:, : MOST + 2])
    for loads in (np.eye(MOST + 2), 2.0 * np.eye(MOST + 2)):
        solver.solve_loads(system(IDENTITY), sides, 1e-9, loads)
    np.testing.assert_array_equal(solver.memory()["loads"], 2.0 * np.eye(MOST + 2)[:MOST])
    solver.solve_loads(system(IDENTITY), sides[:, 3:5], 1e-9, 2.0 * np.eye(MOST + 2)[:, 3:5])
    order = [3, 4, 0, 1, 2, *range(5, MOST)]
    np.testing.assert_array_equal(solver.memory()["loads"], 2.0 * np.eye(MOST + 2)[order])


def test_what_does_not_converge_with_fresh_factors_is_refused():
    with pytest.raises(StepRejected, match="does not converge"):
        LaggedFactors(2).solve(system(SHIFT, IDENTITY), RIGHT, 1e-9)


def test_after_a_refusal_the_next_matrix_has_factors_of_its_own():
    solver = LaggedFactors(2)
    with pytest.raises(StepRejected):
        solver.solve(system(SHIFT, IDENTITY), RIGHT, 1e-9)
    assert solver.solve(system(SHIFT), RIGHT, 1e-9)[1] == 1


def test_after_factors_that_cannot_be_made_others_are():
    def refused():
        raise StepRejected("a", "b", "c", "d")

    solver = LaggedFactors(2)
    solver.solve(system(IDENTITY), RIGHT, 1e-9)
    with pytest.raises(StepRejected, match="found b"):
        solver.solve(Operator(SHIFT.__matmul__, refused), RIGHT, 1e-9)
    assert solver.solve(system(SHIFT), RIGHT, 1e-9)[1] == 1


def test_factors_are_renewed_when_the_iterations_wasted_have_paid_for_them(made):
    solver = LaggedFactors(2)
    other = sparse.csr_array(sparse.diags_array(1.0 + np.arange(N) % 4))
    solver.solve(system(IDENTITY), RIGHT, 1e-9)
    cost, seen = solver._rebuild_cost, []
    while len(made) == 1:
        seen.append(solver.solve(system(other), np.ones(N), 1e-9, again=True)[1])
    assert sum(seen[:-1]) - len(seen[:-1]) > cost
    assert seen[-1] <= 2


def test_outdated_factors_are_renewed_at_once(made):
    solver = LaggedFactors(2)
    for outdated in (False, False, True):
        solver.solve(system(IDENTITY), RIGHT, 1e-9, outdated, again=True)
    assert len(made) == 2


def test_what_was_corrected_in_steps_before_is_not_iterated_for():
    """Corrections that change linearly are a combination of the two before, whatever the factors are."""
    solver, spread = LaggedFactors(2), sparse.csr_array(sparse.diags_array(1.0 + np.arange(N) % 4))
    start, slope = np.sin(np.arange(N)), np.cos(np.arange(N))
    taken = []
    for step in range(4):
        found, iterations = solver.solve(system(spread, IDENTITY), spread @ (start + step * slope), 1e-9)
        np.testing.assert_allclose(found, start + step * slope, atol=1e-8)
        taken.append(iterations)
    assert min(taken[:2]) >= 4
    assert taken[2:] == [0, 0]


def test_a_guess_from_an_attempt_leaves_the_corrections_of_steps_alone():
    solver = LaggedFactors(2)
    solver.solve(system(IDENTITY), RIGHT, 1e-9)
    before = solver.memory()["corrections"]
    solver.solve(system(IDENTITY), np.ones(N), 1e-9, again=True)
    np.testing.assert_array_equal(solver.memory()["corrections"], before)


def test_another_solver_goes_on_from_a_memory_to_the_last_bit():
    other = sparse.csr_array(sparse.diags_array(1.0 + np.arange(N) % 20))
    one, two = LaggedFactors(2), LaggedFactors(2)
    one.solve(system(IDENTITY), RIGHT, 1e-9)
    one.solve(system(other), np.ones(N), 1e-9)
    two.recall(one.memory(), lambda: of(IDENTITY))
    for each in (RIGHT, np.ones(N), RIGHT + 1.0):
        found, again = (solver.solve(system(other), each, 1e-9) for solver in (one, two))
        np.testing.assert_array_equal(found[0], again[0])
        assert found[1] == again[1]


def test_another_solver_goes_on_from_the_answers_of_a_memory_to_the_last_bit():
    near = sparse.csr_array(sparse.diags_array(1.0 + 1e-2 * (np.arange(N) % 7)))
    sides, loads = np.asfortranarray(np.eye(N)[:, :3] + 1.0), np.eye(3)
    one, two = LaggedFactors(2), LaggedFactors(2)
    one.solve(system(IDENTITY), RIGHT, 1e-9)
    one.solve_loads(system(near), sides[:, :2], 1e-3, loads[:, :2])
    two.recall(one.memory(), lambda: of(IDENTITY))
    found, again = (solver.solve_loads(system(near), sides[:, 1:], 1e-6, loads[:, 1:]) for solver in (one, two))
    np.testing.assert_array_equal(found, again)


def test_each_iteration_takes_one_solve_by_the_factors_and_the_end_none(monkeypatch):
    solves = []

    class Identity:
        rebuild_cost = None

        def solve(self, vector):
            solves.append(1)
            return vector

    monkeypatch.setattr(lagged_factors, "factorise", lambda *_: Identity())
    matrix = sparse.csr_array(sparse.diags_array(1.0 + np.arange(N) % 5))
    found, iterations = LaggedFactors(2).solve(system(matrix), np.ones(N), 1e-9)
    np.testing.assert_allclose(matrix @ found, np.ones(N), atol=1e-9)
    assert len(solves) == iterations == 5


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_is_refused(value):
    with pytest.raises(StepRejected, match=f"found a residual of {value}"):
        LaggedFactors(2).solve(system(IDENTITY), np.full(N, value), 1e-9)


def test_nothing_to_do():
    assert LaggedFactors(2).solve(system(IDENTITY), np.zeros(N), 0.0)[1] == 0
