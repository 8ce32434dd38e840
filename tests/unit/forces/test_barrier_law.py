import numpy as np
import pytest
from touching import NORMAL, contact

from rigidfluid.errors import StepRejected
from rigidfluid.forces.barrier import BarrierLaw, BarrierOptions

RANGE, EPSILON = 0.02, 5e-6
LAW = BarrierLaw(BarrierOptions(epsilon=EPSILON), RANGE)


@pytest.mark.parametrize("gap", [0.019, 0.004, 1e-9])
def test_energy_is_the_barrier_of_incremental_potential_contact(gap: float) -> None:
    expected = -((gap - RANGE) ** 2) * np.log(gap / RANGE) / EPSILON
    np.testing.assert_allclose(LAW.energy(contact(gap)), expected)


def test_force_grows_as_one_over_the_gap() -> None:
    for gap in (1e-10, 1e-12):
        np.testing.assert_allclose(LAW.force(contact(gap)), NORMAL * RANGE**2 / (gap * EPSILON), rtol=1e-6)


def test_stiffness_fades_out_at_range() -> None:
    found = [float(LAW.stiffness(contact(RANGE * (1 - part)))[0]) for part in (1e-3, 1e-6, 0.0)]
    assert found[0] / found[1] == pytest.approx(1e3, rel=1e-2)
    assert found[2] == 0.0


@pytest.mark.parametrize("gap", [0.0, -0.01])
def test_overlap_has_infinite_energy_and_no_force(gap: float) -> None:
    assert LAW.energy(contact(gap)) == np.inf
    with pytest.raises(StepRejected, match=r"surfaces 0 and 1: found a gap of .*a positive gap"):
        LAW.force(contact(gap))
    with pytest.raises(StepRejected):
        LAW.stiffness(contact(gap))
