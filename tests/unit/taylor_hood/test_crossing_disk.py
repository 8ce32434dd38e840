"""Drag on a disk in a power-law fluid, against a closed form, a slope and bounds."""

import numpy as np
import pytest
from crossing_disk import bounds_of_drag, drag_in_power_law, newtonian_drag, slope_of_drag


def test_the_newtonian_drag_converges_with_the_fourth_order():
    errors = [abs(drag_in_power_law(1.0, layers) / newtonian_drag() - 1.0) for layers in (4, 8)]
    assert np.log2(errors[0] / errors[1]) > 3.5, errors
    assert errors[1] < 1e-4


def test_the_first_effect_of_thinning_is_that_of_the_reciprocal_theorem():
    step = 0.01
    difference = drag_in_power_law(1.0 + step, 8) - drag_in_power_law(1.0 - step, 8)
    assert difference / (2.0 * step) == pytest.approx(slope_of_drag(), rel=1e-3)


@pytest.mark.parametrize("exponent", [0.3, 0.7, 1.4])
def test_the_drag_is_between_the_bounds_of_extremum_principles(exponent):
    below, above = bounds_of_drag(exponent)
    assert below < drag_in_power_law(exponent, 8) < above
    assert above < 1.3 * below


def test_the_bounds_meet_in_a_newtonian_fluid():
    assert bounds_of_drag(1.0) == pytest.approx([newtonian_drag()] * 2, rel=1e-12)
