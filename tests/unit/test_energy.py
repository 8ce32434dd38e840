"""The ledger of a run, and the energy of bodies."""

import numpy as np
import pytest

from rigidfluid.core.energy import Ledger, Power, Work, kinetic_energy
from rigidfluid.core.rigid import rotate, rotation_matrices
from rigidfluid.core.types import Pose, Twist


def test_the_ledger_adds_up():
    ledger = (
        Ledger(1.0, 0.0, 1.0)
        .after(0.1, Power(2.0, 3.0, 4.0), Work(0.05, 0.0, 0.1), 1.0, 0.0)
        .after(0.2, Power(4.0, 5.0, 6.0), Work(0.4, 0.25, 0.2), 2.0, 0.5)
    )
    assert [ledger.gravity, ledger.boundary, ledger.control, ledger.dissipation] == pytest.approx([0.45, 0.7, 1.2, 1.2])
    assert ledger.contact_loss == pytest.approx(0.3)
    lost = ledger.after_transfer(0.25)
    assert (lost.kinetic, lost.transfer_loss) == (1.75, 0.25)
    assert lost.residual == pytest.approx(ledger.residual) == pytest.approx(0.45 + 0.7 + 1.2 - 1.2 - 0.3 - (2.5 - 1.0))


def test_a_turned_body_has_the_same_energy():
    turn, spin = np.array([[0.3, -0.7, 1.1]]), np.array([[1.0, 2.0, 3.0]])
    inertia, still = np.diag([1.0, 2.0, 3.0])[None], np.array([[1.0, 0.0, 0.0, 0.0]])
    turned = rotate(still, turn)
    both = [
        kinetic_energy(np.ones(1), inertia, Pose(np.zeros((1, 3)), q), Twist(np.ones((1, 3)), w))
        for q, w in ((still, spin), (turned, spin @ rotation_matrices(turned)[0].T))
    ]
    assert both[0] == pytest.approx(both[1]) == pytest.approx(0.5 * (3 + 1 + 8 + 27))
