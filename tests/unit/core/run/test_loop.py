"""The loop without a fluid: driven bodies, walls, outputs, rejected steps."""

import numpy as np
import pytest
from scenes import dry_tables

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run import stepper as loop
from rigidfluid.errors import StepError, StepRejected

BALL = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [5.0, 5.0]}


def dry(*bodies, gravity=(0.0, -10.0), **tables):
    data = dry_tables(
        *[BALL | body for body in bodies],
        end=0.25,
        scene={"name": "t"},
        fluid={"gravity": list(gravity)},
        domain={"lower": [0.0, 0.0], "upper": [10.0, 10.0]},
        output={"every": 0.1},
    )
    return scene_from_dict(data | tables)


@pytest.mark.long
def test_energy_of_a_driven_ball_that_pushes_a_free_one():
    scene = dry(
        {"position": [5.0, 1.0], "prescribed": {"velocity": [0.0, 0.5]}},
        {"position": [5.0, 1.25]},
        contact={"detector": "sphere", "law": "centre", "range": 0.04, "epsilon": 1e-4, "epsilon_wall": 1e-4},
        time={"step": 2e-4, "end": 0.3},
    )
    history = rigidfluid.run(scene)
    e = history.summary["energy"]
    assert len(history.contacts["gap"]) > 0
    assert abs(e["relative_residual"]) < 5e-3


def test_a_driven_body_has_the_velocity_of_its_time():
    b = rigidfluid.run(dry({"prescribed": {"amplitude": [0.1, 0.0], "frequency": 2.0}})).bodies
    np.testing.assert_allclose(b["vx"], 0.4 * np.pi * np.cos(4 * np.pi * b["time"]))


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_a_dry_scene_that_names_a_fluid_is_no_wetter(model):
    law = {"detector": "sphere", "law": "centre", "range": 0.04, "epsilon": 1e-6}
    ball, time = {"velocity": [1.0, -5.0], "position": [5.0, 0.6]}, {"step": 0.001, "end": 0.25}
    scene = dry(ball, gravity=(0.0, 0.0), contact=law, time=time)
    named = scene.to_dict()
    named["fluid"] |= {"density": 1.0, "viscosity": 0.1, "model": model}
    wetter, drier = rigidfluid.run(scene_from_dict(named)).bodies, rigidfluid.run(scene).bodies
    assert drier["vy"][-1] > 0.0
    for column in ("x", "y", "vx", "vy"):
        np.testing.assert_array_equal(wetter[column], drier[column])


def test_without_a_law_nothing_passes_through_a_wall():
    with pytest.raises(StepError):
        rigidfluid.run(dry({"velocity": [0.0, -5.0], "position": [5.0, 0.5]}))


@pytest.mark.parametrize(("step", "every"), [(0.01, 0.03), (0.1, 0.3), (0.004, 0.02), (0.01, 0.07)])
def test_outputs_come_at_every_multiple_and_at_the_end(tmp_path, step, every):
    end = 10 * every + step
    rigidfluid.run(dry({}, gravity=(0.0, 0.0), time={"step": step, "end": end}, output={"every": every}), tmp_path)
    np.testing.assert_allclose(read_checkpoint(tmp_path / "state.h5").times, [*np.arange(11) * every, end])


def test_all_levels_are_tried(monkeypatch):
    tried = []

    def refuse(*arguments):
        tried.append(arguments[-3])
        raise StepRejected("x", "y", "z", "Mend it.")

    monkeypatch.setattr(loop, "attempt", refuse)
    with pytest.raises(StepError):
        rigidfluid.run(dry({}, time={"step": 0.01, "end": 0.1, "shortest": 0.00125}))
    assert tried == [0, 1, 2, 3]


def test_a_tumbling_ellipsoid_keeps_its_energy_in_a_run():
    scene = scene_from_dict(
        dry_tables(
            {
                "type": "ellipsoid",
                "semi_axes": [0.5, 0.3, 0.2],
                "density": 1.0,
                "position": [5.0] * 3,
                "angular_velocity": [0.3, 2.0, 1.5],
            },
            end=0.3,
            step=0.005,
            scene={"name": "t"},
            domain={"lower": [0.0] * 3, "upper": [10.0] * 3},
            output={"every": 1.0},
        )
    )
    e = rigidfluid.run(scene).summary["energy"]
    assert abs(e["relative_residual"]) < 1e-3


def test_a_thrown_ball_keeps_its_energy():
    energy = rigidfluid.run(dry({"velocity": [1.0, 3.0], "position": [5.0, 3.0]})).summary["energy"]
    assert abs(energy["relative_residual"]) < 1e-3


def test_meeting_among_many_does_not_shorten_the_step():
    """Among many, a gap that comes into reach is no gap that closes."""
    grid = [{"position": [0.5 + x, 9.5 - y]} for x in range(9) for y in range(4)]
    history = rigidfluid.run(dry({"velocity": [0.0, 8.0], "position": [4.2, 5.0]}, *grid, gravity=(0.0, 0.0)))
    assert history.summary["steps"] == 25
    assert np.isfinite(history.bodies["gap"][::37]).any()


def test_a_driven_body_has_no_energy_in_the_books():
    energy = rigidfluid.run(dry({"prescribed": {"amplitude": [0.1, 0.0], "frequency": 2.0}})).summary["energy"]
    assert energy["kinetic"] == 0.0
    assert energy["residual"] == 0.0
