"""The assembly's rule of quadrature."""

import math

import numpy as np
import pytest

from rigidfluid.backends.scikit_fem.assembly import reference_tables
from rigidfluid.taylor_hood.elements.numbering import Numbering


@pytest.mark.parametrize(
    ("dimension", "cells", "degree"), [(2, "cubic", 5), (3, "cubic", 5), (2, "curved", 6), (3, "curved", 7)]
)
def test_the_rule_is_exact_for_the_convection(dimension, cells, degree):
    """∫ λᵢⁿ = n! / (n + d)! over the reference simplex."""
    rule = getattr(reference_tables(dimension), cells)
    one_cell = Numbering(np.arange(dimension + 1)[None], dimension + 1)
    at_nodes = one_cell.node_points(np.eye(dimension + 1))[one_cell.cell_nodes[0]]
    integral = rule.weight @ (rule.value @ at_nodes) ** degree
    np.testing.assert_allclose(integral, math.factorial(degree) / math.factorial(degree + dimension), rtol=1e-12)
