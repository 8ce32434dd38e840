"""Energy created or lost in runs in which no or much energy is put in is told against what was at hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scenes import dry_tables
from starts import DISK, INFLOW, disk_in_box

import rigidfluid
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.output.energy_account import energy_account
from rigidfluid.core.output.history import History
from rigidfluid.errors import PluginError
from rigidfluid.forces.normal import NormalLaw
from rigidfluid.taylor_hood.stepping import advance

PERIODIC = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]


def warned(history: History) -> list[str]:
    return [warning["text"] for warning in history.summary["energy"]["warnings"]]


def test_a_longer_flow_past_a_disk_has_the_same_error() -> None:
    """It is made at its start; over all that is put in it would be a fraction of that."""
    accounts = [
        energy_account(rigidfluid.run(disk_in_box(0.05, end, boundary=INFLOW)).energy) for end in (0.4, 0.8, 1.6)
    ]
    largest = [account.share(account.creation.largest) for account in accounts]
    assert largest[0] > 1e-4
    assert largest == pytest.approx([largest[0]] * 3, rel=0.15)
    assert accounts[2].created < 0.7 * accounts[0].created


def driven(step: float, **body: Any) -> History:
    """A channel at rest that a force on the fluid sets in motion, past a disk."""
    tables = {"body": body, "fluid": {"force": ["sin(5*t)", 0.0]}, "boundary": PERIODIC}
    return rigidfluid.run(disk_in_box(step, 0.4, **tables))


def test_work_of_a_force_that_is_not_in_the_balance_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing but that force puts energy in."""
    assert warned(driven(0.02)) == []
    monkeypatch.setattr(advance, "_source_power", lambda *_: 0.0)
    history = driven(0.02)
    assert history.summary["energy"]["put_in"] == 0.0
    assert any("came from nowhere" in text for text in warned(history))


def test_a_flow_that_is_driven_past_a_free_body_keeps_its_balance() -> None:
    """Of second order in the step."""
    left = []
    for step in (0.02, 0.01):
        energy = driven(step, density=2.0, fixed=False).energy
        left.append(abs(energy["residual"][-1]) / energy["body_force"][-1])
    assert left[1] < 0.35 * left[0] < 0.01


def attracted() -> History:
    """A disk at rest that a floor attracts, until shortly before it is there."""
    disk = DISK | {"radius": 0.1, "position": [0.5, 0.16]}
    law = {"law": "normal", "range": 0.1, "epsilon": 1e-3, "substeps": 32}
    return rigidfluid.run(rigidfluid.scene_from_dict(dry_tables(disk, end=0.02, contact=law)))


def test_energy_lost_under_attraction_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its energy at the start is negative, as is all that is put in. A law that loses energy everywhere is refused; one
    that does so nearer than it starts, at gaps that are not looked at, shows in the account."""
    force, energy, stiffness = NormalLaw.force, NormalLaw.energy, NormalLaw.stiffness
    monkeypatch.setattr(NormalLaw, "pair_formula", lambda _: None)
    monkeypatch.setattr(NormalLaw, "force", lambda self, contacts: -force(self, contacts))
    monkeypatch.setattr(NormalLaw, "energy", lambda self, contacts: -energy(self, contacts))
    monkeypatch.setattr(NormalLaw, "stiffness", lambda self, contacts: -stiffness(self, contacts))
    history = attracted()
    assert history.summary["energy"]["put_in"] < 0.0 < np.ptp(history.energy["kinetic"])
    assert warned(history) == []
    monkeypatch.setattr(NormalLaw, "energy", lambda self, contacts: -1.2 * energy(self, contacts))
    with pytest.raises(PluginError, match=r"force law 'normal', force: .* minus the slope of the energy"):
        attracted()

    def lost(self: NormalLaw, contacts: Contacts) -> FloatArray:
        near = np.abs(contacts.gap - 0.475 * self.range) < 0.075 * self.range
        return -(1.0 + 0.2 * near) * energy(self, contacts)

    monkeypatch.setattr(NormalLaw, "energy", lost)
    assert any("vanished" in text for text in warned(attracted()))


def test_a_body_at_rest_in_a_fluid_at_rest_is_no_reason_for_a_warning() -> None:
    """A uniform force in a closed box moves nothing but by the solver's tolerance."""
    history = rigidfluid.run(disk_in_box(0.05, 0.2, {"fixed": False, "density": 1.0}, {"force": [0.3, 0.0]}))
    assert warned(history) == []
