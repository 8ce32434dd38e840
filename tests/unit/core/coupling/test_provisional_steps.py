"""The first solution of a step in which contacts change is followed by another, and needs fewer digits."""

from __future__ import annotations

import fluid_contacts as scenes
import numpy as np
import pytest

from rigidfluid.core.model.types import Advance, Step
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene


def provisional(scene: Scene, end: float, monkeypatch: pytest.MonkeyPatch) -> list[list[bool]]:
    """Of each step in which contacts took part, whether its solutions were provisional."""
    run, asked = Simulation(scene), []
    backend, advance = run.system.backend, run.system.backend.advance

    def recorded(fluid: object, mesh: object, step: Step) -> Advance:
        asked.append(step.provisional)
        return advance(fluid, mesh, step)  # type: ignore[arg-type]

    monkeypatch.setattr(backend, "advance", recorded)
    found = []
    while run.time < end:
        asked.clear()
        if run.step().coupling is not None:
            found.append(list(asked))
    return found


def test_a_step_with_an_impact_is_solved_roughly_and_then_well(monkeypatch):
    steps = provisional(scenes.bounce(2e-3), 0.01, monkeypatch)
    assert any(step[0] for step in steps)
    assert all(not any(step[1:]) and not step[-1] for step in steps)


def test_contacts_at_rest_are_solved_well_at_once(monkeypatch):
    steps = provisional(scenes.resting(4e-3), 0.04, monkeypatch)
    assert steps[2:]
    assert not np.any([step[0] for step in steps[2:]])


def test_rough_solutions_leave_no_trace(monkeypatch):
    """The second one starts from the first, and ends where it would have anyway, to the solver's tolerance."""
    ends = []
    for rough in (True, False):
        with monkeypatch.context() as patch:
            if not rough:
                patch.setattr("rigidfluid.taylor_hood.backend._PROVISIONAL", 0.0)
            run = Simulation(scenes.bounce(2e-3))
            run.go(0.01)
            ends.append(run.state.twist.velocity)
    assert ends[0] == pytest.approx(ends[1], rel=1e-3)
