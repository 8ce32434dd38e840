"""Impacts that stir the fluid."""

from __future__ import annotations

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.model.state import State

FELT, STORED = 3e-5, 1e-2
"""Shares of the energy put in: an impact whose friction takes less than the first in a step, and whose contacts store
or give back less than the second, leaves the fluid as it was."""


def impact_tick(state: State, path: BodyStep, candidate: State) -> int | None:
    """The ``candidate``'s tick where an impact is on the ``path`` that led there, and else that of the one before."""
    put_in, stored = candidate.ledger.put_in, abs(candidate.ledger.contact - state.ledger.contact)
    return candidate.tick if path.friction > FELT * put_in or stored > STORED * put_in else state.impact
