"""Steps without a fluid."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene

from rigidfluid.core.contact.path.substep_path import SubstepPath
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.run.simulation import Simulation

BALLS = ball([0.3, 0.3, 0.3], [1.0, 0.0, 0.0]), ball([0.53, 0.32, 0.3], [0.0, 0.0, 0.0])


@pytest.mark.parametrize("reach", [np.inf, 0.021])
def test_contacts_at_the_start_of_a_step_are_those_in_sight(reach: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the state, which go as far as the system's reach; the sight goes farther than the second one."""
    advance, counts = SubstepPath.advance, set()

    def compared(path: SubstepPath, sight: Any, contacts: Contacts) -> Any:
        expected = sight.contacts_at(path.dynamics.pose)
        for field in fields(Contacts):
            np.testing.assert_array_equal(getattr(contacts, field.name), getattr(expected, field.name))
        assert (sight.reach > reach) == np.isfinite(reach)
        counts.add(len(contacts))
        return advance(path, sight, contacts)

    monkeypatch.setattr(SubstepPath, "advance", compared)
    contact = {"law": "centre", "range": 0.02, "epsilon": 1e-4}
    run = Simulation(dry_scene(contact, *BALLS, end=0.1, step=1e-3), None, False)
    run.stepper.system = replace(run.system, reach=reach)
    for _ in range(30):
        run.step()
    assert counts == {0, 1}
