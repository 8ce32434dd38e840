"""When a moved mesh is regenerated."""

from __future__ import annotations

from dataclasses import fields
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from falling import falling_disk

import rigidfluid
from rigidfluid.core.coupling.fluid_scheme import FluidScheme
from rigidfluid.core.mesh.adaptation import mesh_adaptation
from rigidfluid.core.mesh.adaptation.mesh_adaptation import TANGLED, MeshUpdater, Renewal
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.run import stepper as loop
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import StepError, StepRejected

SHORT = {"time": {"step": 0.004, "end": 0.016}, "mesh": {"size": 0.3, "size_body": 0.05}, "output": {"every": 0.008}}


@pytest.mark.parametrize(
    ("asked", "made", "worst", "anew"),
    [
        (0.01, 0.5, 1.5 * TANGLED, True),
        (0.01, 0.5, 0.1, False),
        (0.25, 0.5, 0.2, True),
        (0.25, 0.3, 0.2, False),
        (0.25, 1.5 * TANGLED, 0.9 * TANGLED, True),
    ],
)
def test_quality(monkeypatch, asked, made, worst, anew):
    """Below what is asked and half of what it was, and below that of tangled cells, since others would ask too late."""
    still: Any = SimpleNamespace(move=lambda pose: None)
    monkeypatch.setattr(mesh_adaptation, "worst_quality", lambda *_: worst)
    monkeypatch.setattr(mesh_adaptation, "_gap_changed", lambda *arguments: np.array([False]))
    monkeypatch.setattr(mesh_adaptation, "is_due", lambda *arguments: False)
    system: Any = None
    mesh_updater = MeshUpdater(system, Sizes(0.1, 0.1), Renewal(asked, 1))
    monkeypatch.setattr(mesh_updater, "_map", lambda reference: (still, None))
    mesh = SimpleNamespace(periods=None, images_of=lambda pose: pose)
    reference = SimpleNamespace(gaps=None, mesh=mesh, pose=None, quality=made, tick=0)
    unknown = {"ledger": SimpleNamespace(power=None), "cell_errors": None}
    state: Any = SimpleNamespace(reference=reference, gaps=None, pose=None, tick=1, **unknown)
    assert mesh_updater.needs_remesh(state, state) is anew


def test_a_rejected_attempt_changes_nothing(monkeypatch):
    simulation = Simulation(falling_disk(**SHORT))
    state = simulation.state
    before = {field.name: getattr(state, field.name) for field in fields(state)}

    def refuse(*_):
        raise StepRejected("x", "y", "z", "Mend it.")

    monkeypatch.setattr(loop, "attempt", refuse)
    with pytest.raises(StepError):
        simulation.step()
    assert simulation.state is state
    assert all(getattr(state, key) is value for key, value in before.items())


@pytest.mark.long
def test_steps_whose_turns_did_not_settle_are_counted(monkeypatch):
    wall = {"law": "centre", "range": 0.1, "epsilon": 1e-4, "epsilon_wall": 1e-4}
    scene = falling_disk(**SHORT, body={"position": [1.0, 0.2], "velocity": [0.0, -1.0]}, contact=wall)
    assert rigidfluid.run(scene).summary["unsettled_steps"] == 0
    converge = FluidScheme.converge
    monkeypatch.setattr(FluidScheme, "converge", lambda *step: (converge(*step)[0], False))
    summary = rigidfluid.run(scene).summary
    assert summary["unsettled_steps"] == summary["steps"] > 0


def test_a_mesh_is_moved_to_a_pose_once(monkeypatch):
    poses, move = [], MeshMotion.move
    monkeypatch.setattr(MeshMotion, "move", lambda motion, pose: poses.append(pose) or move(motion, pose))
    rigidfluid.run(falling_disk(**SHORT, body={"velocity": [0.0, -1.0]}))
    assert len({id(pose) for pose in poses}) == len(poses) > 4


def test_a_mesh_is_made_anew_at_the_age_that_the_scene_gives():
    made = []
    mesh = {"size": 0.3, "size_body": 0.05, "remesh_every": 0.008}
    simulation = Simulation(falling_disk(time={"step": 0.004, "end": 0.032}, mesh=mesh, output={"every": 0.032}))
    simulation.observe(lambda now: made.append(now.clock.time(now.state.reference.tick)))
    simulation.go()
    assert sorted(set(made)) == pytest.approx([0.0, 0.008, 0.016, 0.024])


@pytest.mark.long
def test_a_run_looks_at_its_cells_sizes_on_the_way_and_heeds_them(monkeypatch):
    """A driven disk goes six growth lengths, far from walls."""
    driven = {"prescribed": {"velocity": [0.0, -10.0]}}
    mesh = {"size": 0.3, "size_body": 0.05}
    scene = falling_disk(time={"step": 0.01, "end": 0.16}, mesh=mesh, output={"every": 1.0}, body=driven)
    made = []
    for coarse in (True, False):
        monkeypatch.setattr(mesh_adaptation, "has_coarsened", lambda *_, coarse=coarse: coarse)
        made.append(rigidfluid.run(scene).summary["remeshes"])
    assert made[0] > 5
    assert made[1] == 0
