"""The ledger of a run, and the energy of bodies."""

import numpy as np
import pytest

from rigidfluid.core.mechanics.rigid import kinetic_energy, rotate, rotation_matrices
from rigidfluid.core.model.energy import Cause, Ledger, Power, Work
from rigidfluid.core.model.types import Pose, Twist


def test_the_ledger_adds_up():
    ledger = (
        Ledger(1.0, 0.0, 1.0)
        .after(0.1, Power(2.0, 3.0, 4.0, 2.0), Work(0.05, 0.0, 0.1, 0.3), 1.0, 0.0)
        .after(0.2, Power(4.0, 5.0, 6.0, 5.0), Work(0.4, 0.25, 0.2, 0.4), 2.0, 0.5)
    )
    assert [ledger.gravity, ledger.boundary, ledger.control, ledger.dissipation] == pytest.approx([0.45, 0.7, 1.2, 1.2])
    assert [ledger.contact_loss, ledger.path_friction] == pytest.approx([0.3, 0.7])
    lost = ledger.after_transfer(0.25)
    assert (lost.kinetic, lost.transfer_loss) == (1.75, 0.25)
    assert lost.residual == pytest.approx(ledger.residual) == pytest.approx(0.45 + 0.7 + 1.2 - 1.2 - 0.3 - (2.5 - 1.0))


@pytest.mark.parametrize(("start", "end"), [(3.0, -3.0), (3.0, -2.0), (2.0, 5.0), (0.0, 1.0)])
def test_dissipation_of_velocities_that_change_linearly_is_exact(start, end):
    friction, step = 0.7, 0.1
    mean = 0.5 * (start + end)
    power = Power(dissipation=friction * end**2, dissipation_midway=friction * mean**2)
    before = Ledger(0.0, 0.0, 0.0, power=Power(dissipation=friction * start**2))
    exact = friction * step * (start**2 + start * end + end**2) / 3.0
    assert before.after(step, power, Work(), 0.0, 0.0).dissipation == pytest.approx(exact)


@pytest.mark.parametrize("stiffness", [0.01, 1.0, 100.0])
def test_a_first_step_dissipates_what_its_own_viscous_impulse_takes(stiffness: float) -> None:
    """u' = -λu by BDF1 from a velocity that begins at once, however many times 1/λ the step is."""
    step, start = 0.1, 3.0
    rate = stiffness / step
    end = start / (1.0 + stiffness)
    mean = 0.5 * (start + end)
    power = Power(dissipation=rate * end**2, dissipation_midway=rate * mean**2, stress_power=rate * end * mean)
    begun = Ledger(0.5 * start**2, 0.0, 0.5 * start**2, power=None)
    assert begun.after(step, power, Work(), 0.5 * end**2, 0.0).residual == pytest.approx(0.0, abs=1e-12)


def grown(ledger: Ledger, by: float, cause: Cause | None, spurious_flux: float = 0.0) -> Ledger:
    """A step of one tenth later; energy has vanished, some of it through faces."""
    after = ledger.after(0.1, Power(spurious_flux=spurious_flux), Work(), ledger.kinetic - by, 0.0)
    return after.attributed(ledger, 0.1, cause)


def test_the_residual_is_put_to_its_causes() -> None:
    ledger = grown(Ledger(1.0, 0.0, 1.0), 0.01, Cause.START)
    ledger = grown(ledger, 0.02, None)
    ledger = grown(ledger, 0.04, Cause.CONTACTS)
    assert ledger.in_impact
    ledger = grown(ledger, 0.07, None, spurious_flux=1.0)
    parts = ledger.residual_start, ledger.residual_contacts, ledger.residual_mesh, ledger.residual_steps
    assert parts == pytest.approx((0.01, 0.04, 0.05, 0.04))
    assert not ledger.in_impact
    assert ledger.residual == pytest.approx(0.14)


@pytest.mark.parametrize(("by", "blamed"), [(0.05, 0.03), (0.01, 0.0), (-0.03, -0.03)])
def test_new_meshes_are_blamed_for_what_smooth_motion_does_not_explain(by: float, blamed: float) -> None:
    ledger = grown(grown(Ledger(1.0, 0.0, 1.0), 0.02, None), by, Cause.REMESHING)
    assert ledger.residual_remeshing == pytest.approx(blamed)
    assert ledger.residual_steps == pytest.approx(0.02 + by - blamed)


def test_a_turned_body_has_the_same_energy():
    turn, spin = np.array([[0.3, -0.7, 1.1]]), np.array([[1.0, 2.0, 3.0]])
    inertia, still = np.diag([1.0, 2.0, 3.0])[None], np.array([[1.0, 0.0, 0.0, 0.0]])
    turned = rotate(still, turn)
    both = [
        kinetic_energy(np.ones(1), inertia, Pose(np.zeros((1, 3)), q), Twist(np.ones((1, 3)), w))
        for q, w in ((still, spin), (turned, spin @ rotation_matrices(turned)[0].T))
    ]
    assert both[0] == pytest.approx(both[1]) == pytest.approx(0.5 * (3 + 1 + 8 + 27))


def test_every_rate_is_in_its_entry_and_every_entry_in_the_balance() -> None:
    """Each by the mean of both ends of a step of .5; what is lost and stored is what came in."""
    before = Power(boundary=1.0, control=2.0, dissipation=3.0, damping=4.0, grad_div=5.0, source=6.0)
    after = Power(2.0, 4.0, 7.0, dissipation_midway=5.0, damping=8.0, grad_div=9.0, source=12.0)
    work = Work(gravity=0.25, control=0.5, contact_loss=0.75, path_friction=9.0, drag_loss=1.25)
    ledger = Ledger(10.0, 1.0, 11.0, since_start=2.0, power=before).after(0.5, after, work, 10.5, 1.5)
    assert (ledger.gravity, ledger.boundary, ledger.control, ledger.body_force) == (0.25, 0.75, 2.0, 4.5)
    assert (ledger.dissipation, ledger.grad_div_loss, ledger.contact_loss) == (3.75, 3.5, 3.75)
    assert ledger.since_start == 2.5
    came, gone = 0.25 + 0.75 + 2.0 + 4.5, 3.75 + 3.5 + 3.75
    assert ledger.residual == pytest.approx(came - gone - 1.0)
    assert ledger.after_transfer(0.5).residual == pytest.approx(ledger.residual)
    assert ledger.put_in == 11.0 + came
