"""The assembly's rule of quadrature."""

import math

import numpy as np
import pytest

from rigidfluid.backends.scikit_fem.assembly import reference_tables
from rigidfluid.taylor_hood.numbering import Numbering


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_rule_is_exact_for_the_convection(dimension):
    """∫ λᵢ⁵ = 5! / (5 + d)! over the reference simplex."""
    tables = reference_tables(dimension)
    one_cell = Numbering(np.arange(dimension + 1)[None], dimension + 1)
    at_nodes = one_cell.node_points(np.eye(dimension + 1))[one_cell.cell_nodes[0]]
    integral = tables.weight @ (tables.value @ at_nodes) ** 5
    np.testing.assert_allclose(integral, math.factorial(5) / math.factorial(5 + dimension), rtol=1e-12)
