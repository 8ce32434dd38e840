"""A flow that begins at once converges with the scheme's second order, as one that begins smoothly does."""

from __future__ import annotations

import numpy as np
import pytest
from starts import INFLOW, disk_in_box

import rigidfluid

pytestmark = pytest.mark.long


@pytest.mark.parametrize(
    "tables", [{"boundary": INFLOW}, {"body": {"prescribed": {"velocity": [0.5, 0.0]}}}], ids=["inflow", "body"]
)
def test_order_after_a_start_at_once(tables: dict[str, object]) -> None:
    """Of the kinetic energy a while later; it was 1.2 with an inflow, by steps that differenced over the jump."""
    steps = (0.05, 0.025, 0.0125, 0.003125)
    *energies, exact = (rigidfluid.run(disk_in_box(step, 0.4, **tables)).energy["kinetic"][-1] for step in steps)
    errors = np.abs(np.array(energies) / exact - 1.0)
    orders = np.log2(errors[:-1] / errors[1:])
    assert orders.min() > 1.8, (orders, errors)
    assert errors[0] < 0.01
