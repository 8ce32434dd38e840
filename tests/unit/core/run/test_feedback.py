"""A caller that acts on a run at each step: prescribed velocities, ramps, forces and torques from outside."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rigidfluid.api import SceneError, Simulation, model_of, scene_from_dict

BALL = {"name": "ball", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.3, 0.5]}
PADDLE = {"name": "paddle", "type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.7, 0.5], "fixed": True}
ELLIPSOID = BALL | {"type": "ellipsoid", "semi_axes": [0.1, 0.05, 0.07], "position": [0.5, 0.5, 0.5]}
ELLIPSOID = {key: value for key, value in ELLIPSOID.items() if key != "radius"} | {"angular_velocity": [0.3, 0.2, 1.0]}
WET = {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.05}
PAIR = {
    "name": "it",
    "type": "articulated",
    "position": [0.5, 0.5],
    "component": [
        {"name": name, "type": "sphere", "radius": 0.1, "density": 2.0, "position": [x, 0.0]}
        for name, x in (("a", -0.15), ("b", 0.15))
    ],
    "stroke": [{"moves": ["a"], "along": [1.0, 0.0], "smooth": [[0.0, 0.0], [0.2, -0.1], [0.4, 0.0]]}],
}


def scene(*bodies: dict[str, Any], end: float = 0.4, step: float = 0.02, wet: bool = True, **tables: Any) -> Any:
    d = len((*bodies, *tables.get("mechanism", ()))[0]["position"])
    return scene_from_dict(
        {
            "scene": {"name": "feedback", "dimension": d},
            "fluid": (WET if wet else {"backend": "dry"}) | {"gravity": [*[0.0] * (d - 1), -1.0]},
            "domain": {"lower": [0.0] * d, "upper": [1.0] * d},
            "body": list(bodies),
            "mesh": {"size": 0.2, "size_body": 0.1},
            "time": {"end": end, "step": step},
            "output": {"every": min(0.1, end)},
        }
        | tables
    )


def energies(simulation: Simulation) -> dict[str, float]:
    return {name: column[-1] for name, column in simulation.history.energy.items()}


@pytest.mark.parametrize("gain", [10.0, 2.0])
def test_a_controller_of_every_step_comes_back_to_whole_steps(gain: float) -> None:
    simulation = Simulation(scene(PADDLE))

    def drive(now: Simulation) -> None:
        lacking = 0.55 - now.bodies["paddle"].position[1]
        now.prescribe("paddle", velocity=[0.0, gain * lacking])

    drive(simulation)
    simulation.observe(drive)
    while not simulation.ended and simulation.state.count < 40:
        simulation.step()
    assert simulation.ended
    sizes = simulation.history.steps["size"]
    np.testing.assert_allclose(sizes[sizes.argmax() :], 0.02)
    assert sizes[0] == 0.02 / 64
    assert np.abs(simulation.history.bodies["fy"][sizes.argmax() + 1 :]).max() < 1.0  # dt/64: 31 to 79 at each jump


def test_a_jump_is_followed_by_steps_as_short_as_it_is_large() -> None:
    simulation = Simulation(scene(PADDLE))
    first = {}
    for jump in (1.0, 0.6, 0.45, 0.405, 0.4):
        simulation.prescribe("paddle", velocity=[0.0, 0.4])
        simulation.go(until=0.2)
        saved = simulation.save()
        simulation.prescribe("paddle", velocity=[0.0, jump])
        before = simulation.time
        simulation.step()
        first[jump] = 0.02 / (simulation.time - before)
        simulation.restore(saved)
    assert first == pytest.approx({1.0: 64, 0.6: 32, 0.45: 8, 0.405: 1, 0.4: 1})


def test_a_jump_keeps_the_balance_of_energy() -> None:
    by_hand = Simulation(scene(PADDLE, end=0.2))
    by_hand.prescribe("paddle", velocity=[0.0, 0.2])
    by_hand.go()
    found = energies(by_hand)
    assert abs(found["residual"]) < 0.03 * found["control"]


@pytest.mark.parametrize("wet", [True, False])
def test_a_ramp_is_followed_exactly(wet: bool) -> None:
    simulation = Simulation(scene(PADDLE, wet=wet))
    simulation.prescribe("paddle", velocity=[0.0, 0.4], angular_velocity=2.0, over=0.2)
    simulation.go(until=0.1)
    paddle = simulation.bodies["paddle"]
    np.testing.assert_allclose([*paddle.velocity, *paddle.angular_velocity], [0.0, 0.2, 1.0])
    np.testing.assert_allclose([*paddle.position, *paddle.orientation], [0.7, 0.51, 0.05])
    simulation.go()
    paddle = simulation.bodies["paddle"]
    np.testing.assert_allclose([*paddle.velocity, *paddle.angular_velocity], [0.0, 0.4, 2.0])
    np.testing.assert_allclose([*paddle.position, *paddle.orientation], [0.7, 0.62, 0.6])
    assert simulation.state.count == 20


@pytest.mark.long
def test_a_ramp_in_3d_turns_on_about_the_new_axis() -> None:
    still = PADDLE | {"position": [0.5, 0.5, 0.5]}
    simulation = Simulation(scene(still, wet=False, end=1.0, step=0.1))
    simulation.prescribe("paddle", angular_velocity=[0.0, 0.0, np.pi], over=0.5)
    simulation.go()
    half = 0.5 * 0.75 * np.pi
    turned = [np.cos(half), 0.0, 0.0, np.sin(half)]
    np.testing.assert_allclose(simulation.bodies["paddle"].orientation, turned, atol=1e-14)
    with pytest.raises(SceneError, match=r"about the axis that it turns about"):
        simulation.prescribe("paddle", angular_velocity=[1.0, 0.0, 0.0], over=0.5)


def act(simulation: Simulation, name: str, size: float) -> None:
    """By forces and torques that jump each tenth."""
    d = simulation.model.dimension

    def change(now: Simulation) -> None:
        phase = round(now.time / 0.1)
        torque = 0.02 * size * np.sin(phase + np.arange(2 * d - 3))
        now.apply(name, force=size * np.cos(phase + np.arange(d)), torque=torque)

    change(simulation)
    simulation.observe(change, every=0.1)
    simulation.go()


HINGE = {"type": "hinge", "between": ["ball", "other"], "at": [0.5, 0.5]}
OTHER = BALL | {"name": "other", "position": [0.7, 0.5]}
LAW = {"law": "normal", "range": 0.05, "epsilon": 1e-4}


@pytest.mark.parametrize(
    ("given", "name", "size", "lost"),
    [
        (scene(BALL, wet=False), "ball", 0.05, 1e-13),
        (scene(ELLIPSOID, wet=False), "ball", 0.002, 1e-5),
        (scene(BALL, wet=False, end=2.0, contact=LAW), "ball", 0.05, 1e-4),
        (scene(BALL, OTHER, wet=False, joint=[HINGE]), "ball", 0.05, 1e-4),
        (scene(wet=False, mechanism=[PAIR], step=0.01), "it.a", 0.05, 5e-3),
    ],
    ids=["free", "3d", "contact", "joint", "mechanism"],
)
def test_without_a_fluid_work_from_outside_is_in_the_balance(given: Any, name: str, size: float, lost: float) -> None:
    simulation = Simulation(given)
    act(simulation, name, size)
    found = energies(simulation)
    assert abs(found["control"]) > 5e-5
    assert abs(found["residual"]) < lost * abs(found["control"])


def test_in_a_fluid_the_error_of_that_balance_is_of_second_order() -> None:
    found = []
    for step in (0.02, 0.01):
        simulation = Simulation(scene(BALL, step=step))
        act(simulation, "ball", 0.05)
        found.append(energies(simulation))
    assert abs(found[0]["residual"]) < 0.04 * found[0]["control"]
    assert abs(found[1]["residual"]) < 0.35 * abs(found[0]["residual"])


def test_a_fluid_without_inertia_keeps_the_balance() -> None:
    simulation = Simulation(scene(BALL, fluid=WET | {"model": "stokes"}))
    act(simulation, "ball", 0.05)
    found = energies(simulation)
    assert abs(found["residual"]) < 1e-3 * found["control"]


def test_a_force_presses_a_ball_on_a_wall_in_a_fluid() -> None:
    simulation = Simulation(scene(BALL | {"position": [0.3, 0.2]}, end=1.0, contact=LAW))
    simulation.apply("ball", force=[0.0, -0.2])
    simulation.go()
    ball, weight = simulation.bodies["ball"], simulation.system.weight[0, 1]
    assert ball.contact_force[1] + weight - 0.2 == pytest.approx(-ball.force[1], abs=1e-3)
    found = energies(simulation)
    assert abs(found["residual"]) < 0.01 * (found["control"] + found["gravity"])


@pytest.mark.parametrize("wet", [True, False])
def test_a_controller_holds_a_body_against_gravity(wet: bool) -> None:
    simulation, goal = Simulation(scene(BALL, end=4.0, wet=wet)), np.array([0.4, 0.55])
    mass = float(simulation.system.mass[0])

    def hold(run: Simulation) -> None:
        ball = run.bodies["ball"]
        run.apply("ball", force=mass * (25.0 * (goal - ball.position) - 10.0 * ball.velocity))

    hold(simulation)
    simulation.observe(hold)
    simulation.go()
    weight = simulation.system.weight[0]
    np.testing.assert_allclose(simulation.bodies["ball"].position, goal + weight / (25.0 * mass), atol=1.5e-3)
    np.testing.assert_allclose(simulation.state.applied.force[0], -weight, atol=1e-3)
    found = energies(simulation)
    assert abs(found["residual"]) < (0.005 if wet else 1e-13) * found["control"]


def test_what_is_done_by_hand_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    def begun(folder: Path, end: float) -> Simulation:
        simulation = Simulation(scene(BALL, PADDLE, end=end), folder)
        simulation.apply("ball", force=[0.1, 0.0], torque=0.01)
        simulation.prescribe("paddle", velocity=[0.0, 0.2])
        simulation.go(until=0.1)
        simulation.prescribe("paddle", velocity=[0.1, 0.0], over=0.15)
        simulation.go()
        simulation.close()
        return simulation

    whole, given = begun(tmp_path / "whole", 0.4), scene(BALL, PADDLE)
    begun(tmp_path / "part", 0.2)
    resumed = Simulation(given, tmp_path / "part", resume=True)
    resumed.go()
    resumed.finish("complete")
    resumed.close()
    for name in ("ball", "paddle"):
        np.testing.assert_array_equal(resumed.bodies[name].position, whole.bodies[name].position)
    assert energies(resumed) == pytest.approx(energies(whole), rel=0.0, abs=0.0, nan_ok=True)
    assert resumed.history.summary["by_hand"]["applied"] == {"ball": [0.1, 0.0, 0.01]}


def test_a_way_back_takes_back_what_was_applied() -> None:
    simulation = Simulation(scene(BALL, wet=False))
    saved = simulation.save()
    simulation.apply("ball", force=[0.1, 0.0])
    simulation.go()
    assert simulation.bodies["ball"].velocity[0] > 0.0
    simulation.restore(saved)
    simulation.go()
    assert simulation.bodies["ball"].velocity[0] == 0.0


def test_a_velocity_changes_no_model() -> None:
    given = model_of(scene(PADDLE, wet=False))
    simulation = Simulation(given)
    simulation.prescribe("paddle", velocity=[0.1, 0.0])
    assert simulation.model is given


REFUSED = {
    "a body that is held": (lambda run: run.apply("paddle", torque=1.0), "'paddle', which is fixed or prescribed"),
    "nobody": (lambda run: run.apply("nobody", force=[1.0, 0.0]), "'nobody', which is not there.*ball"),
    "three numbers": (lambda run: run.apply("ball", force=[1.0, 0.0, 0.0]), "force: found.*2 finite numbers"),
    "no number": (lambda run: run.apply("ball", torque=[np.inf]), "torque: found.*1 finite number"),
    "no time": (lambda run: run.prescribe("paddle", velocity=[1.0, 0.0], over=0.0), "over: found 0.0.*a time above 0"),
}


@pytest.mark.parametrize(("call", "said"), REFUSED.values(), ids=REFUSED)
def test_refused(call: Any, said: str) -> None:
    with pytest.raises(SceneError, match=said):
        call(Simulation(scene(BALL, PADDLE, wet=False)))
