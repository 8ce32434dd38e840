"""Matrices of few bodies are arrays, those of many sparse, with the same entries."""

import numpy as np
import pytest
from scipy import sparse

from rigidfluid.core.mechanics import matrices
from rigidfluid.core.mechanics.matrices import assembled, full, sparse_as


@pytest.mark.parametrize("most_full", [2, 3])
def test_entries_at_one_place_add_up(monkeypatch, most_full):
    monkeypatch.setattr(matrices, "MOST_FULL", most_full)
    found = assembled(np.array([1.0, 2.0, 4.0]), np.array([0, 1, 1]), np.array([0, 2, 2]), (2, 3))
    assert sparse.issparse(found) == (most_full < 3)
    np.testing.assert_array_equal(full(found), [[1.0, 0.0, 0.0], [0.0, 0.0, 6.0]])
    assert sparse.issparse(sparse_as(found, np.eye(2))) == sparse.issparse(found)
    np.testing.assert_array_equal(full(sparse_as(found, np.eye(2))), np.eye(2))
