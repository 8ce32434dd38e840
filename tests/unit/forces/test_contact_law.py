import numpy as np
import pytest
from touching import contact

from rigidfluid.forces.contact import ContactPointLaw, ContactPointOptions

RANGE, EPSILON = 0.02, 5e-6


def law(epsilon_wall: float | None = None) -> ContactPointLaw:
    return ContactPointLaw(ContactPointOptions(epsilon=EPSILON, epsilon_wall=epsilon_wall), RANGE)


@pytest.mark.parametrize("gap", [0.013, 0.001, -0.1])
def test_force_is_the_vector_of_the_contact_points_also_in_overlap(gap: float) -> None:
    found = contact(gap)
    expected = (found.point_a - found.point_b) * (RANGE - gap) ** 2 / EPSILON
    np.testing.assert_allclose(law().force(found), expected)


def test_largest_at_a_third_of_the_range() -> None:
    along = [float(law().force(contact(gap))[0] @ contact(gap).normal[0]) for gap in np.linspace(0, RANGE, 301)]
    assert np.argmax(along) == 100
    assert max(along) == pytest.approx(4 * RANGE**3 / (27 * EPSILON))


def test_vanishes_at_contact_and_pulls_in_overlap() -> None:
    assert not law().force(contact(0.0)).any()
    np.testing.assert_allclose(law().energy(contact(0.0)), RANGE**4 / (12 * EPSILON))
    assert float(law().force(contact(-0.001))[0] @ contact(0.0).normal[0]) < 0
    assert law().energy(contact(-0.001)) < law().energy(contact(0.0))


def test_steepest_at_two_thirds_of_the_range() -> None:
    np.testing.assert_allclose(law().stiffness(contact(2 * RANGE / 3)), RANGE**2 / (3 * EPSILON))


def test_wall_has_its_own_stiffness() -> None:
    for radius_b, ratio in ((0.3, 1.0), (np.inf, 2.0)):
        found = contact(0.01, 0.5, radius_b)
        np.testing.assert_allclose(law(EPSILON / 2).force(found), ratio * law().force(found))
