"""Meshes that follow the error of forces: runs, when a mesh is judged, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import FloatArray, Scene, Simulation, scene_from_dict
from rigidfluid.core.model.flow_error import RefinedFlow
from rigidfluid.core.model.types import Step
from rigidfluid.core.run.force_errors import ErrorOfForces
from rigidfluid.errors import SceneError

AUTO = {"size": "auto", "goal": "forces"}
MATERIAL = {"type": "bingham", "viscosity": 0.05, "yield_stress": 0.1, "stress_growth": 5.0}


def channel(**tables: Any) -> Scene:
    """A disk that is held in a channel."""
    return scene_from_dict({
        "scene": {"name": "held", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.1, "initial": "steady"},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
        "boundary": [
            {"on": "left", "type": "velocity", "profile": "parabolic", "velocity": [1.0, 0.0]},
            {"on": "right", "type": "pressure", "pressure": 0.0},
        ],
        "body": [{
            **{"name": "disk", "type": "sphere", "radius": 0.15, "density": 1.0, "position": [0.7, 0.5]}, "fixed": True,
        }],
        "mesh": AUTO | {"accuracy": 5e-5},
        "time": {"end": 1.0, "step": 0.1},
        "output": {"every": 0.5},
    } | tables)  # fmt: skip


def test_a_run_gets_to_the_accuracy_of_its_force_and_goes_on_from_there(tmp_path: Path) -> None:
    """The force is nearer by far to that on much finer cells than that of the first mesh."""
    simulation = Simulation(channel(), tmp_path)
    simulation.go(until=0.3)
    simulation.close()
    resumed = rigidfluid.run(channel(), out=tmp_path, resume=True)
    whole = rigidfluid.run(channel())
    for column, values in whole.bodies.items():
        np.testing.assert_array_equal(resumed.bodies[column], values)
    fine = {"size": 0.05, "size_body": 0.012}
    exact = rigidfluid.run(channel(mesh=fine, time={"end": 0.1, "step": 0.1})).bodies["fx"][-1]
    first, last = abs(whole.bodies["fx"][[1, -1]] / exact - 1.0)
    assert whole.summary["remeshes"] == 1
    assert last < 5e-5
    assert 3.0 * last < first


def test_a_mesh_is_judged_once_when_it_is_four_steps_old_and_then_every_twenty_steps() -> None:
    estimate = ErrorOfForces(float)
    asked = [step for step in np.arange(0.0, 62.0, 0.5) if estimate.is_asked(step, step - 13.5)]
    assert asked == [18.0, 20.0, 40.0, 60.0]


def test_a_mesh_around_bodies_that_have_entered_is_judged_by_them(monkeypatch: pytest.MonkeyPatch) -> None:
    from rigidfluid.backends.scikit_fem import ScikitFem

    judged, own = list[int](), ScikitFem.force_errors

    def noted(backend: ScikitFem, flow: RefinedFlow, step: Step) -> FloatArray:
        judged.append(len(step.pose.position))
        return own(backend, flow, step)

    simulation = Simulation(channel(mesh=AUTO | {"accuracy": 0.5, "size_body": 0.1}))
    simulation.step()
    shape = {"type": "sphere", "radius": 0.1, "density": 1.0}
    simulation.add(shape | {"name": "other", "position": [1.4, 0.5], "fixed": True})
    monkeypatch.setattr(ScikitFem, "force_errors", noted)
    simulation.go(until=0.6)
    assert judged
    assert set(judged) == {2}


def test_nothing_is_told_before_the_first_step() -> None:
    simulation = Simulation(channel())
    assert ErrorOfForces(float).error(simulation.system, simulation.state) is None


@pytest.mark.parametrize(
    ("tables", "found"),
    [
        ({"mesh": {"size": 0.2, "size_body": 0.05, "goal": "forces"}}, "'forces' without `accuracy`"),
        (
            {"fluid": {"density": 1.0, "material": MATERIAL}, "mesh": AUTO | {"accuracy": 0.01}},
            "'forces' with material 'bingham'",
        ),
        ({"body": []}, "'forces' without a body"),
    ],
)
def test_goals_that_nothing_follows_are_refused(tables: dict[str, Any], found: str) -> None:
    with pytest.raises(SceneError, match=f"mesh.goal: found {found}"):
        channel(**tables)


def test_a_backend_without_duals_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    from rigidfluid.backends.scikit_fem import ScikitFem

    monkeypatch.setattr(ScikitFem, "duals", False)
    with pytest.raises(SceneError, match=r"mesh.goal: found 'forces' with backend 'scikit-fem'"):
        channel()


def test_a_scene_without_the_goal_solves_no_dual_flow(monkeypatch: pytest.MonkeyPatch) -> None:
    from rigidfluid.backends.scikit_fem import ScikitFem

    def never(*_: Any) -> None:
        raise AssertionError

    monkeypatch.setattr(ScikitFem, "force_errors", never)
    rigidfluid.run(channel(mesh={"size": "auto", "accuracy": 0.3}, time={"end": 0.6, "step": 0.1}))
