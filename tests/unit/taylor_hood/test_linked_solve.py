"""Forces of links from the responses of a step's matrix."""

from types import SimpleNamespace

import numpy as np
import pytest

from rigidfluid.core.model.types import Links
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.system.links import solve_linked


def test_two_links_that_hold_the_same_reject_the_step():
    rows = np.tile([[[1.0, 0.0, 0.0]]], (2, 1, 1))
    unit_mass = SimpleNamespace(twist_response=lambda matrix, wrenches, tolerance: wrenches)
    links = Links(rows, np.array([0.0, 1.0]), np.zeros(2))
    with pytest.raises(StepRejected, match="two of them hold the same"):
        solve_linked(unit_mass, SimpleNamespace(matrix=None), links, 1e-6)
