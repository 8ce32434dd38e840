import numpy as np
from scipy.interpolate import CubicHermiteSpline

from rigidfluid.core.geometry.piecewise_cubic import PiecewiseCubic


def test_is_the_hermite_spline_of_scipy() -> None:
    random = np.random.default_rng(1)
    nodes = np.sort(random.uniform(-1.0, 2.0, 7))
    values, slopes = random.normal(size=(2, 7))
    places = np.concatenate([nodes, random.uniform(-1.5, 2.5, 40)])
    expected = CubicHermiteSpline(nodes, values, slopes)(places)
    np.testing.assert_allclose(PiecewiseCubic(nodes, values, slopes)(places), expected, rtol=1e-10, atol=1e-10)


def test_takes_a_single_place() -> None:
    cubic = PiecewiseCubic(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 8.0]), np.array([0.0, 3.0, 12.0]))
    assert float(cubic(np.array(1.5))) == 1.5**3
