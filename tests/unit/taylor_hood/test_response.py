"""How exactly impulse responses are solved for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.stepping.response import response


@pytest.mark.parametrize(("shared", "least", "most"), [(False, 1e-6, 1e-4), (True, 1e-3, 3e-3)])
def test_three_digits_do_where_bodies_share_right_sides(shared: bool, least: float, most: float) -> None:
    asked: list[float] = []

    def twist_response(matrix: Any, wrenches: FloatArray, tolerance: float) -> FloatArray:
        asked.append(tolerance)
        return wrenches

    discretisation: Any = SimpleNamespace(twist_response=twist_response)
    matrix: Any = SimpleNamespace(masses=object())
    step: Any = SimpleNamespace(derivative=np.array([2.0, 0.0, 0.0]), shared=shared)
    impulses = np.ones((1, 2, 3))
    found = response(discretisation, matrix, step, impulses)
    np.testing.assert_array_equal(found.viscous, 2.0 * impulses)
    np.testing.assert_array_equal(found.inviscid, impulses)
    assert len(asked) == 2
    assert least <= min(asked) <= max(asked) <= most
