import numpy as np
import pytest
from touching import contact

from rigidfluid.errors import ArgumentError, SceneError
from rigidfluid.forces.centre import CentreLaw, CentreOptions

RANGE, EPSILON = 0.02, 5e-6


def law(epsilon_wall: float | None = None) -> CentreLaw:
    return CentreLaw(CentreOptions(epsilon=EPSILON, epsilon_wall=epsilon_wall), RANGE)


@pytest.mark.parametrize(("radius_b", "touching"), [(0.3, 0.8), (np.inf, 1.0)], ids=["ball", "wall"])
def test_force_and_energy_at_contact(radius_b: float, touching: float) -> None:
    found = contact(0.0, 0.5, radius_b)
    expected = touching * RANGE**2 / EPSILON
    np.testing.assert_allclose(law().force(found), expected * found.normal)
    np.testing.assert_allclose(law().energy(found), RANGE**3 * (4 * touching + RANGE) / (12 * EPSILON))


@pytest.mark.parametrize("gap", [0.013, -0.1])
def test_force_is_the_vector_of_the_centres(gap: float) -> None:
    found = contact(gap, 0.5, 0.3)
    centre_a, centre_b = found.point_a + 0.5 * found.normal, found.point_b - 0.3 * found.normal
    np.testing.assert_allclose(law().force(found), (centre_a - centre_b) * (RANGE - gap) ** 2 / EPSILON)


@pytest.mark.parametrize(("radius_b", "touching"), [(0.3, 0.8), (np.inf, 1.0)], ids=["ball", "wall"])
def test_steepest_at_contact(radius_b: float, touching: float) -> None:
    expected = RANGE * (2 * touching - RANGE) / EPSILON
    np.testing.assert_allclose(law().stiffness(contact(0.0, 0.5, radius_b)), expected)


def test_wall_has_its_own_stiffness() -> None:
    for radius_b, ratio in ((0.3, 1.0), (np.inf, 2.0)):
        found = contact(0.01, 0.5, radius_b)
        np.testing.assert_allclose(law(EPSILON / 2).force(found), ratio * law().force(found))
        np.testing.assert_allclose(law(EPSILON / 2).energy(found), ratio * law().energy(found))


@pytest.mark.parametrize("radii", [(np.nan, 0.3), (0.3, np.nan), (np.nan, np.inf)])
def test_shapes_that_are_no_balls_are_refused(radii: tuple[float, float]) -> None:
    with pytest.raises(SceneError, match="centre law needs balls"):
        law().force(contact(0.01, *radii))


@pytest.mark.parametrize(
    "keys", [{}, {"epsilon": 0.0}, {"epsilon": 1.0, "epsilon_wall": -1.0}, {"epsilon": 1.0, "eps": 1.0}]
)
def test_options_refuse_what_has_no_meaning(keys: dict[str, float]) -> None:
    with pytest.raises(ArgumentError):
        CentreOptions(**keys)
