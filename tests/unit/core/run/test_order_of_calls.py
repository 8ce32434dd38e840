"""The order in which a step calls its parts is that of the page."""

from __future__ import annotations

import re
from typing import Any

import pytest
from falling import falling_disk
from paths import ROOT

from rigidfluid.core.coupling.fluid_scheme import FluidScheme
from rigidfluid.core.mesh.adaptation.mesh_adaptation import MeshUpdater
from rigidfluid.core.run import step
from rigidfluid.core.run.recorder import Recorder
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.run.stepper import Stepper

WALL = {"law": "centre", "range": 0.1, "epsilon": 1e-4, "epsilon_wall": 1e-4}
SHORT = {"time": {"step": 0.004, "end": 0.04}, "mesh": {"size": 0.3, "size_body": 0.05}, "output": {"every": 1.0}}


def drawn() -> list[str]:
    block = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8").split("records:\n\n```\n")[1].split("```")[0]
    return re.findall(r"^(?:  )?(\w[\w ]*?)(?:  |$)", block, flags=re.MULTILINE)


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    made: list[str] = []

    def recorded(owner: Any, name: str, as_: str) -> None:
        whole = getattr(owner, name)

        def call(*given: Any, **named: Any) -> Any:
            made.append(as_)
            return whole(*given, **named)

        monkeypatch.setattr(owner, name, call)

    recorded(Stepper, "longest", "propose a level")
    recorded(FluidScheme, "expect", "expect the coupling")
    recorded(FluidScheme, "follow", "follow the bodies")
    recorded(MeshUpdater, "remesh_if_needed", "adapt the mesh")
    recorded(MeshUpdater, "deform", "move the mesh")
    recorded(step, "detect_contacts_and_gaps", "detect contacts")
    recorded(FluidScheme, "_shown", "show the coupling")
    recorded(Recorder, "record", "record")
    return made


def test_a_step_near_a_wall(calls: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    near = {"position": [1.0, 0.2], "velocity": [0.0, -1.0]}
    simulation = Simulation(falling_disk(**SHORT, body=near, contact=WALL))
    simulation.observe(lambda _: calls.append("call the observers"))
    backend = simulation.system.backend
    advance = backend.advance
    monkeypatch.setattr(backend, "advance", lambda *given: calls.append("advance the fluid") or advance(*given))
    calls.clear()
    simulation.step()
    turn = calls.index("move the mesh")
    first = calls.index("show the coupling") + 1
    turns = calls[first : calls.index("record")]
    assert calls[:first] + ["record", "call the observers"] == drawn()
    assert turns == (["follow the bodies", *calls[turn:first]]) * (len(turns) // (1 + first - turn))
    assert turns


def test_a_step_far_from_all_walls(calls: list[str]) -> None:
    simulation = Simulation(falling_disk(**SHORT))
    simulation.step()
    calls.clear()
    simulation.step()
    near = {"show the coupling", "advance the fluid", "call the observers"}
    assert calls == [call for call in drawn() if call not in near]
