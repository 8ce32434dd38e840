"""Runs of a fluid without bodies: a channel, a cavity, and all that reads their results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.checks.report import check
from rigidfluid.errors import RigidfluidError, SceneError, StepRejected
from rigidfluid.post.reports import report

BALL = {"name": "ball", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.5, 0.5]}


def cavity(dimension: int = 2, **changes: Any) -> rigidfluid.Scene:
    """A box of which one wall slides."""
    lid = {"on": "top", "type": "wall", "velocity": [1.0, 0.0, 0.0][:dimension]}
    tables: dict[str, Any] = {
        "scene": {"name": "cavity", "dimension": dimension},
        "fluid": {"density": 1.0, "viscosity": 0.1},
        "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
        "boundary": [lid],
        "mesh": {"size": 0.4, "size_body": 0.4},
        "time": {"end": 0.04, "step": 0.01},
        "output": {"every": 0.02, "probes": [[0.5] * dimension]},
    }
    return scene_from_dict(tables | changes)


def test_a_driven_channel_has_its_parabola() -> None:
    """u = f y (1 - y)/2μ with f = 2, μ = .1, which elements of second degree hold."""
    given = cavity(
        fluid={"density": 1.0, "viscosity": 0.1, "force": ["2.0", "0.0"], "initial": "steady"},
        boundary=[{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}],
    )
    simulation = Simulation(given)
    simulation.go()
    fields = simulation.fields()
    y = fields.points[:, 1]
    np.testing.assert_allclose(fields.velocity[:, 0], 10.0 * y * (1.0 - y), atol=1e-7)


def test_a_run_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    rigidfluid.run(cavity(), tmp_path / "whole")
    rigidfluid.run(cavity(time={"end": 0.02, "step": 0.01}), tmp_path / "parts")
    history = rigidfluid.run(cavity(), tmp_path / "parts", resume=True)
    for name in ("energy.csv", "steps.csv", "probes.csv", "bodies.csv", "fields/000002.vtu"):
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "parts" / name).read_bytes()
    assert history.probes["vx"][-1] != 0.0
    assert len(history.bodies["x"]) == 0
    assert history.summary["rest_position"] == {}
    assert history.summary["reynolds"] is None


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.long)])
def test_check_and_report_tell_of_the_fluid_alone(dimension: int, tmp_path: Path) -> None:
    found = check(cavity(dimension, time={"end": 0.01, "step": 0.01, "tolerance": 0.01}))
    assert found.bodies == found.pairs == ()
    assert found.count("error") == found.count("warning") == 0
    rigidfluid.run(cavity(dimension, time={"end": 0.01, "step": 0.01}), tmp_path)
    written = {path.name for path in report(tmp_path)}
    assert {"speed_field.png", "energy.png", "whole_mesh.png", "report.html"} <= written
    assert written.isdisjoint({"position.png", "gap.png", "force.png", "mesh.png"})
    assert rigidfluid.load_results(tmp_path).fields().velocity.shape[1] == dimension


def test_without_a_fluid_there_must_be_a_body() -> None:
    with pytest.raises(
        SceneError, match=r"body: found nothing; allowed is a body or a mechanism, unless there is a fl"
    ):
        Simulation(cavity(fluid={"backend": "dry"}, mesh=None, output={"every": 0.02}, boundary=[]))


def test_a_law_without_bodies_acts_on_nothing() -> None:
    law = {"law": "normal", "range": 0.05, "epsilon": "auto"}
    simulation = Simulation(cavity(interaction=[law]))
    simulation.go(0.01)
    assert len(simulation.state.contacts.gap) == 0


def test_bodies_enter_no_run_without_one() -> None:
    region = {"type": "box", "lower": [0.3, 0.3], "upper": [0.7, 0.7]}
    shape = [{"type": "sphere", "radius": 0.1}]
    source = {"name": "s", "shape": shape, "density": 2.0, "region": region, "times": [0.01]}
    with pytest.raises(SceneError, match=r"body: found none, where bodies enter or leave"):
        Simulation(cavity(source=[source]))
    with pytest.raises(SceneError, match=r"body: found none, where bodies enter or leave; allowed is one at the start"):
        Simulation(cavity()).add(BALL)


def test_a_step_that_fails_is_told_without_a_body(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = Simulation(cavity(time={"end": 0.04, "step": 0.01, "shortest": 0.005}))

    def refuse(*_: Any) -> None:
        raise StepRejected("the step", "something", "nothing", "Mend it.")

    monkeypatch.setattr(type(simulation.system.backend), "advance", refuse)
    with pytest.raises(RigidfluidError, match=r"found something, even with a step of 0.005; allowed is nothing. Mend"):
        simulation.go()
