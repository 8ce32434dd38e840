"""A simulation that its caller drives: steps, observers, a body that is moved, a way back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rigidfluid import load_results, load_scene
from rigidfluid.api import ArgumentError, OutputError, SceneError, Simulation, StepError, run, scene_from_dict

BALL = {"name": "ball", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.3, 0.5]}
PADDLE = {"name": "paddle", "type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.7, 0.5]}
DRIVEN = PADDLE | {"prescribed": {"velocity": [0.0, 0.2]}}


def scene(*bodies: dict[str, Any], wet: bool = True, end: float = 0.4) -> Any:
    fluid = {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.05} if wet else {"backend": "dry"}
    tables = {
        "scene": {"name": "by_hand", "dimension": 2},
        "fluid": fluid | {"gravity": [0.0, -1.0]},
        "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        "body": list(bodies),
        "contact": {"law": "centre", "range": 0.05, "epsilon": 1e-4},
        "time": {"end": end, "step": 0.02},
        "output": {"every": 0.1},
    }
    return scene_from_dict(tables | ({"mesh": {"size": 0.2, "size_body": 0.1}} if wet else {}))


def same(one: Any, other: Any) -> None:
    for name in ("bodies", "energy"):
        for column, values in one.table(name).items():
            np.testing.assert_array_equal(values, other.table(name)[column])


@pytest.mark.parametrize("wet", [True, False])
def test_steps_taken_by_hand_are_those_of_a_run(wet: bool) -> None:
    simulation = Simulation(scene(BALL, DRIVEN, wet=wet))
    while not simulation.ended:
        simulation.step()
    same(run(scene(BALL, DRIVEN, wet=wet)), simulation.history)
    assert simulation.time == pytest.approx(0.4)


def test_there_is_no_step_after_the_end() -> None:
    simulation = Simulation(scene(BALL, wet=False))
    simulation.go()
    with pytest.raises(StepError, match=r"time\.end"):
        simulation.step()


def test_observers_are_called_when_they_are_due() -> None:
    simulation, each, now_and_then = Simulation(scene(BALL, wet=False)), [], []
    simulation.observe(lambda s: each.append(s.time))
    simulation.observe(lambda s: now_and_then.append(s.time), every=0.15)
    simulation.go(until=0.2)
    assert simulation.time == pytest.approx(0.2)
    simulation.go()
    np.testing.assert_allclose(each, 0.02 * np.arange(1, 21))
    np.testing.assert_allclose(now_and_then, [0.16, 0.3, 0.4])


def test_bodies_are_told_by_name() -> None:
    simulation = Simulation(scene(BALL, DRIVEN))
    simulation.step()
    ball, paddle = simulation.bodies["ball"], simulation.bodies["paddle"]
    assert ball.velocity[1] < 0.0 != ball.force[1]
    np.testing.assert_array_equal(paddle.velocity, [0.0, 0.2])
    assert paddle.gap == pytest.approx(0.2, abs=0.01)


def test_fields_are_those_of_the_present_state() -> None:
    simulation = Simulation(scene(BALL, DRIVEN))
    simulation.go(until=0.1)
    fields, paddle = simulation.fields(), simulation.bodies["paddle"].position
    on_paddle = np.abs(np.linalg.norm(fields.points - paddle, axis=1) - 0.1) < 1e-3
    assert on_paddle.sum() > 6
    np.testing.assert_allclose(fields.velocity[on_paddle], [[0.0, 0.2]] * on_paddle.sum(), atol=1e-9)
    np.testing.assert_allclose(fields.velocity[fields.points[:, 0] < 1e-12], 0.0, atol=1e-12)
    assert fields.time == simulation.time


def test_there_are_no_fields_without_a_fluid() -> None:
    with pytest.raises(OutputError, match="found none, as 'by_hand' has no fluid; allowed is those of a scene"):
        Simulation(scene(BALL, wet=False)).fields()


def test_a_driven_body_takes_the_velocity_that_it_is_given() -> None:
    simulation = Simulation(scene(BALL, DRIVEN))
    simulation.go(until=0.2)
    simulation.prescribe("paddle", velocity=[0.1, 0.0])
    before = simulation.bodies["paddle"].position
    simulation.go()
    np.testing.assert_allclose(simulation.bodies["paddle"].velocity, [0.1, 0.0])
    np.testing.assert_allclose(simulation.bodies["paddle"].position - before, [0.02, 0.0], atol=2e-3)
    simulation.apply("ball", torque=0.25)
    simulation.finish("complete")
    assert simulation.history.summary["by_hand"] == {
        "prescribed": {"paddle": [0.1, 0.0, 0.0]},
        "applied": {"ball": [0.0, 0.0, 0.25]},
    }


def test_a_fixed_body_may_be_set_in_motion() -> None:
    simulation = Simulation(scene(PADDLE | {"fixed": True}, wet=False))
    simulation.prescribe("paddle", velocity=[-0.5, 0.0], angular_velocity=[1.0])
    simulation.go()
    np.testing.assert_allclose(simulation.bodies["paddle"].position, [0.5, 0.5])
    np.testing.assert_allclose(simulation.bodies["paddle"].orientation, [0.4])


@pytest.mark.parametrize(("name", "said"), [("ball", "is free"), ("nobody", "is not there")])
def test_other_bodies_cannot_be_driven(name: str, said: str) -> None:
    with pytest.raises(SceneError, match=f"'{name}', which {said}.*paddle"):
        Simulation(scene(BALL, DRIVEN, wet=False)).prescribe(name, velocity=[1.0, 0.0])


def test_a_velocity_that_cannot_be_is_refused() -> None:
    with pytest.raises(SceneError, match="velocity"):
        Simulation(scene(BALL, DRIVEN, wet=False)).prescribe("paddle", velocity=[1.0, np.nan])


@pytest.mark.parametrize("wet", [True, False])
def test_a_saved_run_branches_and_comes_back_to_the_last_bit(wet: bool) -> None:
    simulation = Simulation(scene(BALL, DRIVEN, wet=wet))
    simulation.go(until=0.2)
    saved = simulation.save()
    simulation.go()
    rows = {name: len(column["time"]) for name in ("bodies", "energy") for column in [simulation.history.table(name)]}
    end = simulation.bodies["ball"].position
    simulation.restore(saved)
    assert simulation.time == pytest.approx(0.2)
    simulation.prescribe("paddle", velocity=[-1.0, 0.0])
    simulation.go()
    assert np.any(simulation.bodies["ball"].position != end)
    simulation.restore(saved)
    simulation.go()
    np.testing.assert_array_equal(simulation.bodies["ball"].position, end)
    assert {name: len(simulation.history.table(name)["time"]) for name in rows} == rows


def test_a_run_that_writes_does_not_go_back(tmp_path: Any) -> None:
    simulation = Simulation(scene(BALL, wet=False), tmp_path)
    saved = simulation.save()
    with pytest.raises(OutputError, match="go back"):
        simulation.restore(saved)
    simulation.close()


@pytest.mark.parametrize("wet", [True, False])
def test_driven_bodies_are_where_their_motion_says(wet: bool) -> None:
    swings = PADDLE | {"prescribed": {"amplitude": [0.1, 0.0], "frequency": 2.5, "angular_velocity": [3.0]}}
    simulation = Simulation(scene(BALL, swings, wet=wet))
    simulation.observe(lambda now: np.testing.assert_allclose(now.bodies["paddle"].position, at(now.time), atol=1e-14))
    simulation.go()
    assert simulation.bodies["paddle"].orientation[0] == pytest.approx(1.2)


def at(time: float) -> list[float]:
    return [0.7 + 0.1 * np.sin(5.0 * np.pi * time), 0.5]


def test_a_closed_run_writes_no_more(tmp_path: Path) -> None:
    first = Simulation(scene(BALL, wet=False), tmp_path)
    first.step()
    first.close()
    second = Simulation(scene(BALL, wet=False), tmp_path)
    with pytest.raises(OutputError, match=r"found a step after close\(\)"):
        first.step()
    second.step()
    assert len(second.history.bodies["time"]) == 2
    second.finish("complete")
    second.close()
    summary = (tmp_path / "summary.json").read_bytes()
    with pytest.raises(OutputError, match=r"found a summary after close\(\)"):
        first.finish("complete")
    assert (tmp_path / "summary.json").read_bytes() == summary


def test_another_scene_s_save_is_refused() -> None:
    simulation, other = Simulation(scene(BALL, wet=False)), Simulation(scene(BALL, PADDLE, wet=False))
    with pytest.raises(SceneError, match=r"restore: found a run of"):
        simulation.restore(other.save())
    simulation.restore(Simulation(scene(BALL, wet=False)).save())


@pytest.mark.parametrize("every", [0, -1.0, float("nan"), float("inf"), 10**400, "x", [1.0], True])
def test_observers_are_called_after_a_time_above_zero(every: Any) -> None:
    simulation = Simulation(scene(BALL, wet=False))
    with pytest.raises(SceneError, match=r"every: found .*; allowed is a finite time above 0"):
        simulation.observe(lambda _: None, every)


@pytest.mark.parametrize("until", [float("nan"), "x", 10**400, None, True])
def test_a_run_goes_until_a_time_alone(until: Any) -> None:
    with pytest.raises(SceneError, match=r"until: found .*; allowed is a number"):
        Simulation(scene(BALL, wet=False)).go(until)


@pytest.mark.parametrize("level", [-1, 10**6, 0.5, float("nan"), None, True])
def test_a_controller_gives_levels_alone(level: Any) -> None:
    simulation = Simulation(scene(BALL, wet=False))
    simulation.stepper.propose = lambda _: level
    with pytest.raises(StepError, match=r"stepper.propose: found .*; allowed is a whole number from 0"):
        simulation.step()


@pytest.mark.parametrize("observer", [None, 3])
def test_observers_are_functions(observer: Any) -> None:
    with pytest.raises(SceneError, match=r"observer: found .*; allowed is a function"):
        Simulation(scene(BALL, wet=False)).observe(observer)


@pytest.mark.parametrize("saved", [None, 4, "x"])
def test_what_was_not_saved_is_not_restored(saved: Any) -> None:
    with pytest.raises(SceneError, match=r"restore: found .*; allowed is what save\(\) gave"):
        Simulation(scene(BALL, wet=False)).restore(saved)


@pytest.mark.parametrize("case", [None, 3, "scene.toml", Path("scene.toml")])
def test_other_than_scenes_and_models_are_not_run(case: Any) -> None:
    with pytest.raises(ArgumentError, match=r"case: found .*; allowed is a Scene or a Model"):
        run(case)


@pytest.mark.parametrize("out", ["", 5, b"x", "\0", "\ud800"])
def test_a_folder_is_a_path(out: Any) -> None:
    with pytest.raises(ArgumentError, match=r"out: found .*; allowed is a path, or None"):
        Simulation(scene(BALL, wet=False), out)


def test_nothing_is_done_until_a_time_before_the_start() -> None:
    simulation = Simulation(scene(BALL, wet=False))
    simulation.go(float("-inf"))
    assert simulation.time == 0.0


WRONG: dict[str, Callable[[Simulation], object]] = {
    "propose": lambda now: setattr(now.stepper, "propose", 5),
    "needs_remesh": lambda now: setattr(now.mesh_updater, "needs_remesh", 5),
    "state": lambda now: setattr(now, "state", None),
    "force": lambda now: now.apply("ball", force=[10**400, 0]),
    "over": lambda now: now.prescribe("paddle", over="x"),
    "status": lambda now: now.finish(3),
    "resume": lambda now: Simulation(now.model, None, "yes"),
    "fluid.backend": lambda now: Simulation(now.model, processes=np.ones((1, 1))),
    "table": lambda now: now.history.table([]),
    "progress": lambda now: run(now.model, progress=5),
    "overrides": lambda now: load_scene("scene.toml", 3),
    "overrides, no list": lambda now: load_scene("scene.toml", "time.end=1"),
    "overrides, no texts": lambda now: load_scene("scene.toml", [3]),
    "scene": lambda now: scene_from_dict(None),
    "folder": lambda now: load_results(5),
    "path": lambda now: load_scene("\0"),
}


@pytest.mark.parametrize("call", WRONG)
def test_values_of_a_wrong_kind_are_refused(call: str) -> None:
    simulation = Simulation(scene(BALL, DRIVEN, wet=False))
    with pytest.raises(SceneError, match=rf"{call.partition(',')[0]}: found .*; allowed is"):
        WRONG[call](simulation)


@pytest.mark.parametrize("answer", [None, "x", 1])
def test_a_rule_of_re_meshing_says_true_or_false(answer: Any) -> None:
    simulation = Simulation(scene(BALL))
    simulation.step()
    simulation.mesh_updater.needs_remesh = lambda state, pose: answer
    with pytest.raises(StepError, match=r"mesh_updater.needs_remesh: found .*; allowed is True or False"):
        simulation.step()


def test_a_folder_of_results_whose_name_is_too_long() -> None:
    with pytest.raises(OutputError, match=r"found File name too long; allowed is the folder of a run"):
        load_results("x" * 5000)
