"""Tables of energies that are made up."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.output.energy_account import energy_account, energy_warnings
from rigidfluid.core.output.energy_flows import PARTS
from rigidfluid.core.output.records import LEDGER_COLUMNS

PUT_IN = 10.0


def table(states=6, **columns):
    """States of a body thrown with an energy of 10; the residual follows from the other columns."""
    energy = {name: np.zeros(states) for name in LEDGER_COLUMNS}
    energy |= {"time": 0.1 * np.arange(states), "kinetic": np.full(states, PUT_IN)}
    energy |= {name: np.array(values, dtype=float) for name, values in columns.items()}
    stored = energy["kinetic"] + energy["contact"]
    incoming = energy["gravity"] + energy["boundary"] + energy["control"] + energy["body_force"] + energy["exchange"]
    outgoing = energy["dissipation"] + energy["grad_div_loss"] + energy["contact_loss"] + energy["transfer_loss"]
    energy["residual"] = incoming - outgoing - (stored - stored[0])
    energy["residual_steps"] = energy["residual"] - sum(energy[name] for name in PARTS if name != "residual_steps")
    return energy


def warned(energy):
    """Warnings of a table's own account."""
    return energy_warnings(energy, energy_account(energy))
