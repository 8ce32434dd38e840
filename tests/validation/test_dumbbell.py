"""A dumb-bell in shear in three dimensions, against the exact theory of two spheres."""

import numpy as np
import pytest
from shear_boxes import angles, rates, tables_of, time_of, without_box
from two_spheres import axis_ratio, rotation_in_strain

from rigidfluid.api import run, scene_from_dict

pytestmark = pytest.mark.validation


def test_it_turns_as_two_spheres_do():
    """Rates along and across the flow, with walls at 9 and 12 radii and from both without walls; A + B = 1."""
    boxes = 9.0, 12.0
    found = [rates(half, 3.0) for half in boxes]
    r, _ = rotation_in_strain(3.0)
    np.testing.assert_allclose(np.sum(found, axis=1), 1.0, atol=1e-3)
    across, along = (without_box(boxes, pair) for pair in zip(*found, strict=True))
    assert across == pytest.approx((1.0 + r) / 2.0, rel=2e-3)
    assert along == pytest.approx((1.0 - r) / 2.0, rel=5e-3)
    assert np.sqrt(across / along) == pytest.approx(axis_ratio(r), rel=5e-3)


def test_half_a_turn_takes_the_time_that_rates_at_rest_say():
    across, along = rates(9.0, 3.0)
    expected = np.pi / np.sqrt(across * along)
    turned = angles(run(scene_from_dict(tables_of(9.0))))
    assert time_of(-np.pi, turned) == pytest.approx(expected, rel=4e-3)
