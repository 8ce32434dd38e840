"""The exact rotation of two spheres on a rod, against what the literature says of it and against its limits."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from two_spheres import angle, axis_ratio, period, rotation_in_strain


def test_spheres_that_nearly_touch_turn_as_an_ellipsoid_of_1_982():
    """Period 15.62 (Wakiya, J. Phys. Soc. Japan 31 (1971) 1581) and axis ratio 1.982 (Nir & Acrivos, J. Fluid Mech. 59
    (1973) 209, doi:10.1017/S0022112073001527)."""
    r, _ = rotation_in_strain(2.0 + 1e-6)
    assert axis_ratio(r) == pytest.approx(1.982, abs=5e-4)
    assert period(r) == pytest.approx(15.62, abs=5e-3)


def test_spheres_far_apart_feel_drag_torque_and_each_other_as_points_do():
    """1 - r = 16/(3 s²) - 6/s³ + O(s⁻⁴): drag against torque, less 3/(4s) of the drag (Oseen), and the rotlets."""
    rest = []
    for s in (50.0, 100.0, 200.0):
        r, _ = rotation_in_strain(s)
        rest.append(((1.0 - r) * s**2 - 16.0 / 3.0 + 6.0 / s) * s**2)
    assert abs(rest[0]) < 40.0
    assert rest[2] == pytest.approx(rest[1], rel=0.05)


@pytest.mark.parametrize("distance", [2.01, 2.2, 3.0, 6.0])
def test_more_terms_change_nothing_and_spheres_are_rigid(distance):
    r, missed = rotation_in_strain(distance, 60)
    assert missed < 1e-7
    assert rotation_in_strain(distance, 90)[0] == pytest.approx(r, abs=1e-9)


def test_the_angle_obeys_its_equation_for_more_than_a_turn():
    r, times = 0.7, np.linspace(0.0, 25.0, 200)
    a, b = (1.0 + r) / 2.0, (1.0 - r) / 2.0

    def rate(_, phi):
        return -(a * np.sin(phi) ** 2 + b * np.cos(phi) ** 2)

    turned = solve_ivp(rate, (0.0, 25.0), [0.0], t_eval=times, rtol=1e-10, atol=1e-12).y[0]
    np.testing.assert_allclose(angle(r, times), turned, atol=1e-7)
    assert angle(r, np.array([period(r)]))[0] == pytest.approx(-2.0 * np.pi)
