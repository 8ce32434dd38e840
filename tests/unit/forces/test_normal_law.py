import numpy as np
import pytest
from touching import NORMAL, contact

from rigidfluid.forces.normal import NormalLaw, NormalOptions

RANGE, EPSILON = 0.02, 5e-6
LAW = NormalLaw(NormalOptions(epsilon=EPSILON), RANGE)


@pytest.mark.parametrize("gap", [0.013, 0.0, -0.1])
def test_force_is_the_unit_normal_times_the_square(gap: float) -> None:
    np.testing.assert_allclose(LAW.force(contact(gap)), NORMAL * (RANGE - gap) ** 2 / EPSILON)


def test_energy_at_contact() -> None:
    np.testing.assert_allclose(LAW.energy(contact(0.0)), RANGE**3 / (3 * EPSILON))


def test_the_nearer_the_stronger_all_the_way() -> None:
    along = [float(LAW.force(contact(gap))[0] @ NORMAL[0]) for gap in np.linspace(RANGE, -2 * RANGE, 50)]
    assert np.all(np.diff(along) > 0)
