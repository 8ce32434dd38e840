"""Formulas of one contact, as compiled loops call them."""

import numpy as np
import pytest

from rigidfluid.core.contact.path.deepest_gaps import deepest_gaps
from rigidfluid.core.model.pair_formula import PairFormula, compiled, own_formula
from rigidfluid.errors import PluginError
from rigidfluid.forces.normal import NormalLaw


def inverse(parameters, gap, radius_a, radius_b, mass, opening, sliding):
    """An energy that is infinite in contact."""
    return parameters[0] / gap, parameters[0] / gap**2, 0.0, 0.0


def at_rest(parameters, gap, radius_a, radius_b, mass, opening, sliding):
    """An energy that is infinite at rest."""
    return parameters[0] / sliding, 0.0, 0.0, 0.0


def unknown(parameters, gap, radius_a, radius_b, mass, opening, sliding):
    return parameters.stiffness * gap, 0.0, 0.0, 0.0


def three(parameters, gap, radius_a, radius_b, mass, opening, sliding):
    return gap, 0.0, 0.0


class InverseLaw(NormalLaw):
    def pair_formula(self):
        return PairFormula(inverse, [1])


def test_a_division_by_zero_is_infinite():
    one = np.ones(1)
    assert deepest_gaps(compiled(at_rest), one[None], one, one, one, one, one, 3) == 1.0


@pytest.mark.parametrize("function", [unknown, three, eval("lambda *numbers: (0.0, 0.0, 0.0, 0.0)")])
def test_a_formula_that_cannot_be_compiled_is_refused_by_name(function):
    with pytest.raises(PluginError, match=r"formula .*(unknown|three|lambda).*let pair_formula give None"):
        compiled(function)


@pytest.mark.parametrize(
    "answer", [(inverse, [1.0]), PairFormula("inverse", [1.0]), PairFormula(inverse, 1.0), PairFormula(inverse, ["1"])]
)
def test_what_is_no_formula_is_refused_by_its_law(answer):
    class Odd(NormalLaw):
        name = "odd"

        def pair_formula(self):
            return answer

    with pytest.raises(PluginError, match="force law 'odd', pair_formula: found"):
        own_formula(Odd(NormalLaw.Options(epsilon=1.0), 0.1))


def test_parameters_may_be_a_list_of_integers():
    formula = own_formula(InverseLaw(NormalLaw.Options(epsilon=1.0), 0.1))
    assert formula is not None
    assert formula.parameters.dtype == np.float64
    one = np.ones(1)
    assert deepest_gaps(compiled(formula.function), formula.parameters[None], one, one, one, one, 0 * one, 60) == 1.0
