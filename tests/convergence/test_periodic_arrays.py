"""The drag on balls in periodic arrays."""

from __future__ import annotations

import pytest
from periodic_arrays import array_of_balls, exact_array

pytestmark = pytest.mark.long


@pytest.mark.parametrize(("dimension", "layers", "allowed"), [(2, 8, 3e-3), (3, 6, 5e-3)])
def test_the_drag_in_an_array_is_that_of_the_series(dimension: int, layers: int, allowed: float) -> None:
    """Of cylinders and of spheres; the series for cylinders is right to .2 % at this volume fraction."""
    assert array_of_balls(dimension, layers) == pytest.approx(exact_array(dimension), rel=allowed)
