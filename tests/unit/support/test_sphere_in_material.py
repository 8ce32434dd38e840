"""Least work around a sphere: the drag in a Newtonian fluid within a wall, and that of weakly thinning fluids."""

import numpy as np
import pytest
from published import SPHERE_IN_POWER_LAW
from sphere_in_material import FAR, drag_on_sphere


def test_a_newtonian_fluid_has_the_drag_of_a_sphere_within_a_sphere():
    k = np.exp(-FAR)  # Happel and Brenner, Low Reynolds Number Hydrodynamics, 1965, equation 4-22.9
    exact = (1.0 - k**5) / (1.0 - 2.25 * k + 2.5 * k**3 - 2.25 * k**5 + k**6)
    assert drag_on_sphere(np.ones_like) == pytest.approx(exact, rel=3e-5)


def test_a_weakly_thinning_fluid_has_the_published_drag():
    assert drag_on_sphere(lambda rate: rate**-0.1) == pytest.approx(SPHERE_IN_POWER_LAW[0.9], rel=2e-3)


def test_the_drag_grows_with_a_power_of_the_speed():
    slow, fast = (drag_on_sphere(lambda rate: rate**-0.3, speed) for speed in (1.0, 2.0))
    assert fast / slow == pytest.approx(2.0**-0.3, rel=1e-5)
