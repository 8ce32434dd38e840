"""Steps without a fluid."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.path.substep_path import SubstepPath
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.run.simulation import Simulation

CONTACT = {"law": "centre", "range": 0.02, "epsilon": 1e-4}
BALLS = ball([0.3, 0.3, 0.3], [1.0, 0.0, 0.0]), ball([0.53, 0.32, 0.3], [0.0, 0.0, 0.0])
SQUARE = {"type": "polygon", "points": [[0.0, 0.0], [0.15, 0.0], [0.15, 0.1], [0.0, 0.1]], "density": 1.0}
SWIMMER = {"type": "three_sphere_swimmer", "radius": 0.05, "density": 1.0, "arms": [0.2, 0.2], "amplitude": 0.05}
OTHERS: dict[str, dict[str, Any]] = {
    "several contacts of a pair": dry_tables(
        SQUARE | {"position": [0.3, 0.3], "velocity": [1.0, 0.0]},
        SQUARE | {"position": [0.48, 0.31]},
        contact=CONTACT | {"law": "normal"},
    ),
    "an image": dry_tables(
        ball([0.12, 0.3], [-1.0, 0.0]),
        ball([0.89, 0.32], [0.0, 0.0]),
        contact=CONTACT,
        boundary=[{"on": "all", "type": "periodic"}],
    ),
    "a mechanism": dry_tables(
        ball([0.5, 0.67, 0.5], [0.0, -1.0, 0.0]),
        mechanism=[SWIMMER | {"name": "swimmer", "speed": 2.0, "position": [0.5, 0.5, 0.5]}],
        contact=CONTACT,
    ),
}


@pytest.fixture
def counts(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Contacts at the start of each step, which are compared with those in sight."""
    advance, found = SubstepPath.advance, []

    def compared(path: SubstepPath, sight: Any, contacts: Contacts) -> Any:
        expected = sight.contacts_at(path.dynamics.pose)
        for field in fields(Contacts):
            np.testing.assert_array_equal(getattr(contacts, field.name), getattr(expected, field.name))
        assert (sight.reach > path.system.reach) == (path.system.reach == 0.021)
        found.append(len(contacts))
        return advance(path, sight, contacts)

    monkeypatch.setattr(SubstepPath, "advance", compared)
    return found


@pytest.mark.parametrize("reach", [np.inf, 0.021])
def test_contacts_at_the_start_of_a_step_are_those_in_sight(reach: float, counts: list[int]) -> None:
    """Those of the state, which go as far as the system's reach; the sight goes farther than the second one."""
    run = Simulation(dry_scene(CONTACT, *BALLS, end=0.1, step=1e-3), None, False)
    run.stepper.system = replace(run.system, reach=reach)
    for _ in range(30):
        run.step()
    assert set(counts) == {0, 1}


@pytest.mark.parametrize("name", OTHERS)
def test_contacts_at_the_start_of_a_step_are_those_at_its_pose(name: str, counts: list[int]) -> None:
    """Of corners, of images and of what strokes move, to the last bit."""
    run = Simulation(scene_from_dict(OTHERS[name] | {"time": {"end": 0.1, "step": 1e-3}}), None, False)
    for _ in range(30):
        run.step()
    assert max(counts) > (1 if name == "several contacts of a pair" else 0)
