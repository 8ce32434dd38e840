"""Bodies leave by rules about their state."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables
from two_parts import run_in_two_parts

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.case.moment import Moment
from rigidfluid.core.case.sinks import rule, rule_values
from rigidfluid.errors import SceneError, SceneErrors, StepError

POST = {"name": "post", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.8, 0.8], "fixed": True}
BALL = {"type": "sphere", "radius": 0.05, "density": 2.0}
SOURCE = {
    "name": "grain",
    "shape": [{"type": "sphere", "radius": 0.05}],
    "density": 2.0,
    "region": {"type": "box", "lower": [0.1, 0.6], "upper": [0.5, 0.9]},
    "velocity": [0.0, -0.5],
    "every": 0.2,
}
BOX = {"type": "box", "lower": [0.0, 0.0], "upper": [1.0, 0.5]}


def run_of(*bodies: dict[str, Any], sink: dict[str, Any], **tables: Any) -> Simulation:
    given = {"fluid": {"gravity": [0.0, 0.0]}, "sink": [sink], "end": 0.5} | tables
    return Simulation(scene_from_dict(dry_tables(POST, *bodies, **given)))


def left(run: Simulation) -> dict[str, float]:
    """Times when bodies left."""
    rows = run.history.exchanges
    gone = rows["change"] == "gone"
    return dict(zip(rows["body"][gone].tolist(), rows["time"][gone].tolist(), strict=True))


def ball(name: str, x: float, **more: Any) -> dict[str, Any]:
    return BALL | {"name": name, "position": [x, 0.4]} | more


def test_bodies_leave_at_an_age() -> None:
    """Those of the start are as old as the run, others count from when they entered."""
    run = run_of(ball("first", 0.3), sink={"when": "age > 0.255"}, source=[SOURCE], end=0.5)
    run.go()
    assert left(run) == {"first": pytest.approx(0.26), "grain0": pytest.approx(0.26), "grain1": pytest.approx(0.46)}


def test_ages_go_on_after_resuming(tmp_path: Path) -> None:
    scene = scene_from_dict(
        dry_tables(POST, source=[SOURCE], sink=[{"when": "age > 0.255"}], output={"every": 0.1}, end=0.7)
    )
    whole, resumed = Simulation(scene), run_in_two_parts(scene, tmp_path, 0.3)
    whole.go()
    assert left(resumed) == left(whole)
    assert list(left(whole)) == ["grain0", "grain1", "grain2"]


@pytest.mark.parametrize(
    ("when", "gone"),
    [
        ("speed < 0.25", ["slow"]),
        ("vx > 0.2 and x > 0.45", ["quick"]),
        ("x < 0.25 or not w < 1", ["slow", "spinning"]),
        ("radius > 0.055", ["large"]),
        ("volume > pi*0.05**2*1.01", ["large"]),
        ("mass > 2*pi*0.05**2*1.01", ["large"]),
        ("vy + 0*t", []),
        ("0.41 - y", ["slow", "quick", "spinning", "large"]),
        ("y - 0.41", []),
    ],
)
def test_rules_know_the_state_of_a_body(when: str, gone: list[str]) -> None:
    """And leave fixed ones alone."""
    quick = ball("quick", 0.4, velocity=[0.3, 0.0])
    spinning = ball("spinning", 0.6, velocity=[0.0, -0.25], angular_velocity=2.0)
    large = ball("large", 0.85, radius=0.06, velocity=[0.0, -0.25])
    run = run_of(ball("slow", 0.2, velocity=[0.0, -0.1]), quick, spinning, large, sink={"when": when}, end=0.2)
    run.go()
    assert sorted(left(run)) == sorted(gone)


def test_a_rule_in_a_region_wants_both() -> None:
    run = run_of(
        ball("slow", 0.2), ball("quick", 0.4, velocity=[0.0, 0.5]), sink={"region": BOX, "when": "speed > 0.1"}
    )
    run.go()
    assert left(run) == {"quick": 0.0}


def test_a_rule_near_a_surface_wants_both() -> None:
    """A ball is near enough from .75 on."""
    bodies = ball("slow", 0.2) | {"position": [0.2, 0.8]}, ball("quick", 0.4, velocity=[0.0, 0.5])
    run = run_of(*bodies, sink={"on": "top", "gap": 0.2, "when": "vy > 0"}, end=0.8)
    run.go()
    assert left(run) == {"quick": pytest.approx(0.7, abs=0.0101)}


def test_a_rule_in_space_knows_all_components() -> None:
    body = {"name": "a", **BALL, "position": [0.3, 0.4, 0.6], "velocity": [0.1, 0.2, 0.3]}
    other = {"name": "b", **BALL, "position": [0.7, 0.4, 0.6], "angular_velocity": [1.0, 2.0, 3.0]}
    run = Simulation(scene_from_dict(dry_tables(body, other, sink=[{"when": "z + vz + wz > 100"}], end=0.1)))
    values = rule_values(Moment(run.model, run.system, run.state, run.population, run.time, ()))
    found = {name: values[name].tolist() for name in values}
    assert found["x"] == [0.3, 0.7]
    assert found["z"] == [0.6, 0.6]
    assert (found["vx"], found["vy"], found["vz"]) == ([0.1, 0.0], [0.2, 0.0], [0.3, 0.0])
    assert (found["wx"], found["wy"], found["wz"]) == ([0.0, 1.0], [0.0, 2.0], [0.0, 3.0])
    assert found["speed"] == pytest.approx([np.sqrt(0.14), 0.0])
    assert rule("wz - wy", "sink.0.when", 3)(values).tolist() == [0.0, 1.0]


def test_a_rule_sees_the_image_in_the_domain() -> None:
    seams = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]
    run = run_of(ball("a", 0.9, velocity=[1.0, 0.0]), sink={"when": "x < 0.3 and x > 0.155"}, boundary=seams)
    run.go()
    assert left(run) == {"a": pytest.approx(0.26)}


@pytest.mark.parametrize(
    ("sink", "text"),
    [
        ({"when": "ages > 5"}, "sink.0.when: found an unknown name: 'ages' at character 1 of 'ages > 5'; allowed is"),
        ({"when": "ages > 5"}, "Did you mean 'age'?"),
        ({"when": "vz > 0"}, "sink.0.when: found an unknown name: 'vz'"),
        ({"when": "age >"}, "sink.0.when: found 'age >', which is no formula"),
        ({"when": "age and x > 1"}, "not a comparison: 'age' at character 1"),
        ({"when": "not age"}, "not a comparison: 'age' at character 5"),
        ({"when": 5.0}, "sink.0.when"),
        ({"when": "age > 5", "gap": 0.1}, "sink.0.gap: found gap without on"),
        ({"when": "age > 5", "on": "outlet"}, "sink.0.on: found 'outlet'"),
        ({"region": BOX, "on": "top"}, "sink.0.on: found both of region and on"),
    ],
)
def test_wrong_rules_are_told(sink: dict[str, Any], text: str) -> None:
    with pytest.raises((SceneError, SceneErrors), match=re.escape(text)):
        scene_from_dict(dry_tables(POST, sink=[sink]))


def test_a_rule_without_a_value_ends_the_run_by_name() -> None:
    run = run_of(ball("a", 0.3), sink={"when": "-(0.095 - age)**0.5"})
    with pytest.raises(StepError, match=r"time 0\.1: sink\.0\.when: found nan from .* for body 'a'"):
        run.go()
