"""Sliders and balls without a fluid: exact motions, momenta, energy, and what tables tell of them."""

from itertools import pairwise

import jsonschema
import numpy as np
import pytest
from linked_runs import bar, body, hinge, linked_scene, misfit, momenta

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mechanics.rigid import lab_inertia, moment
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.post.reports import report

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])
AXES = {2: np.array([0.6, 0.8]), 3: np.array([0.48, 0.6, 0.64])}
WAVE = {"smooth": [[0.0, 0.0], [0.25, 0.1], [0.75, -0.1], [1.0, 0.0]]}


def slider(*between, axis, **keys):
    return {"type": "slider", "between": list(between), "axis": [float(value) for value in axis]} | keys


def ball(*between, at, **keys):
    return {"type": "ball", "between": list(between), "at": list(at)} | keys


def run(scene):
    it = Simulation(scene)
    it.go()
    return it


def of_joint(it, name="joint0"):
    joints = it.history.joints
    return {column: values[joints["joint"] == name] for column, values in joints.items()}


def falls(errors, factor=0.27):
    return all(finer < factor * coarser for coarser, finer in pairwise(errors))


@DIMENSIONS
def test_a_mass_on_a_spring_along_an_axis_oscillates_to_second_order(dimension):
    """s = a (1 - cos ωt) with ω = √(k/m), from rest where the spring is not."""
    mass = np.pi * 0.01 if dimension == 2 else 4.0 / 3.0 * np.pi * 1e-3
    errors, axis = [], AXES[dimension]
    for step in (0.04, 0.02, 0.01):
        spring = slider("body0", axis=axis, stiffness=16.0 * mass, rest_length=0.2)
        it = run(linked_scene([body(*[2.0] * dimension)], [spring], step=step))
        told, s = of_joint(it), 0.2 * (1.0 - np.cos(4.0))
        errors.append(abs(told["displacement"][-1] - s))
        np.testing.assert_allclose(it.bodies["body0"].position, 2.0 + told["displacement"][-1] * axis, atol=1e-13)
        assert told["rate"][-1] == pytest.approx(0.8 * np.sin(4.0), abs=100.0 * step**2)
        assert abs(it.state.ledger.relative_residual) < 3.0 * step**2
    assert it.system.joints.frequency == pytest.approx(4.0)
    assert errors[0] < 2e-3
    assert falls(errors)


@DIMENSIONS
def test_the_torque_of_a_slider_is_told_about_its_point(dimension):
    """A body that does not turn feels none about its centre, wherever the axis is, its spring included: that is of the
    end of a step, the rest of its mean."""
    rest = [2.0] * (dimension - 2)
    point = np.array([2.3, 2.1, *rest])
    spring = slider("body0", axis=AXES[dimension], stiffness=0.1, rest_length=0.2, at=point.tolist())
    it = run(linked_scene([body(2.0, 2.0, *rest)], [spring], gravity=[0.3, -1.0, 0.2][:dimension], step=0.005))
    told, names = of_joint(it), "xyz"[:dimension]
    force = np.stack([told[f"f{axis}"] for axis in names], axis=1)
    torque = told["t"][:, None] if dimension == 2 else np.stack([told[f"t{axis}"] for axis in names], axis=1)
    arm = point - [2.0, 2.0, *rest]
    assert np.abs(torque[1:]).max() > 1e-3
    expected = -moment(np.broadcast_to(arm, force.shape), force)[1:]
    np.testing.assert_allclose(torque[1:], expected, atol=0.02 * np.abs(expected).max())


def test_the_period_of_a_mass_on_a_slider():
    """2π √(m/k): after it the mass is where it was, to second order."""
    mass, errors = np.pi * 0.01, []
    period = 2.0 * np.pi / 4.0
    for count in (50, 100):
        spring = slider("body0", axis=[1.0, 0.0], stiffness=16.0 * mass, rest_length=0.2)
        it = run(linked_scene([body(2.0, 2.0)], [spring], end=period, step=period / count))
        told = of_joint(it)
        errors.append(abs(told["rate"][-1]))
        assert told["displacement"].max() == pytest.approx(0.4, rel=5e-3)
    assert errors[0] < 5e-3
    assert falls(errors)


@DIMENSIONS
def test_a_bead_on_a_driven_arm_flies_outwards_to_second_order(dimension):
    """r = r₀ cosh(ωt), and the arm pushes it aside by 2 m ω dr/dt."""
    rest, spin, errors, balance = [2.0] * (dimension - 2), 1.5, [], []
    turning = spin if dimension == 2 else [0.0, 0.0, spin]
    for step in (0.04, 0.02, 0.01):
        arm = body(2.0, 2.0, *rest, name="arm", prescribed={"angular_velocity": turning})
        bead = body(2.4, 2.0, *rest, name="bead")
        axis = [1.0] + [0.0] * (dimension - 1)
        it = run(linked_scene([arm, bead], [slider("bead", "arm", axis=axis)], step=step))
        arm_angle, radius = spin, 0.4 * np.cosh(spin)
        exact = radius * np.array([np.cos(arm_angle), np.sin(arm_angle)])
        errors.append(np.abs(it.bodies["bead"].position[:2] - 2.0 - exact).max())
        balance.append(abs(it.state.ledger.residual))
        assert of_joint(it)["displacement"][-1] + 0.4 == pytest.approx(radius, abs=step**2)
        assert misfit(it) < 1e-13
    pushed = 2.0 * it.system.mass[1] * spin**2 * 0.4 * np.sinh(spin * (1.0 - 0.5 * step))
    side = np.array([-np.sin(arm_angle), np.cos(arm_angle)])
    told = of_joint(it)
    assert np.array([told["fx"][-1], told["fy"][-1]]) @ side == pytest.approx(pushed, rel=1e-3)
    assert it.state.ledger.control > 0.0
    assert falls(errors)
    assert falls(balance, 0.3)


@pytest.mark.long
@DIMENSIONS
def test_bodies_that_slide_on_each_other_keep_momenta_and_energy(dimension):
    """Their axis turns with both: forces on them have one line, however far they have slid."""
    rest, errors = [2.0] * (dimension - 2), []
    spin = 1.5 if dimension == 2 else [0.4, 0.3, 1.5]
    for step in (0.01, 0.005, 0.0025):
        bars = [bar(1.6, 2.0, *rest, name="a", angular_velocity=spin), bar(2.2, 2.1, *rest, name="b")]
        spring = slider("b", "a", axis=AXES[dimension], stiffness=0.5 if dimension == 2 else 0.05, rest_length=0.1)
        it, gaps = Simulation(linked_scene(bars, [spring], end=0.8, step=step)), []
        before = momenta(it)
        it.observe(lambda now, seen=gaps: seen.append(misfit(now)))
        it.go()
        np.testing.assert_allclose(momenta(it), before, atol=1e-12 * np.abs(before).max())
        assert max(gaps) < 1e-12
        errors.append(abs(it.state.ledger.residual) / it.state.ledger.initial)
    assert np.abs(of_joint(it)["displacement"]).max() > 0.05
    assert errors[0] < 1e-2
    assert falls(errors, 0.3)


def test_a_cart_with_a_pendulum_keeps_its_energy_to_second_order():
    """The cart slides along x, so that momentum along it stays too."""
    errors = []
    for step in (0.02, 0.01, 0.005):
        bodies = [body(2.0, 3.0, name="cart"), bar(2.28, 2.8, name="bar")]
        joints = [slider("cart", axis=[1.0, 0.0]), hinge("bar", "cart", at=[2.0, 2.8])]
        it, seen = Simulation(linked_scene(bodies, joints, gravity=[0.0, -10.0], end=0.6, step=step)), []
        it.observe(lambda now, seen=seen: seen.append(now.state.ledger.residual))
        it.go()
        errors.append(np.abs(seen).max() / it.state.ledger.gravity)
        assert abs(momenta(it)[0]) < 1e-13
        assert it.bodies["cart"].position[1] == pytest.approx(3.0, abs=1e-13)
    assert abs(of_joint(it)["displacement"][-1]) > 0.05
    assert set(it.history.joints) > {"angle", "displacement", "rate"}
    assert falls(errors, 0.3)


@pytest.mark.parametrize("damping", [0.1, 2.0, 1e6])
def test_a_damped_slider_is_exact_at_any_strength(damping):
    """m u' = m g·a - c u along the axis a."""
    mass = np.pi * 0.01
    rail = slider("body0", axis=[0.6, 0.8], damping=damping * mass)
    it = run(linked_scene([body(2.0, 3.0, velocity=[0.6, 0.8])], [rail], gravity=[0.0, -3.0], end=0.5, step=0.1))
    final = -2.4 / damping
    exact = final + (1.0 - final) * np.exp(-0.5 * damping)
    assert of_joint(it)["rate"][-1] == pytest.approx(exact, rel=1e-8, abs=1e-8)
    assert it.state.ledger.contact_loss > 0.0


@pytest.mark.long
@DIMENSIONS
def test_a_driven_slider_goes_where_its_stroke_says_and_works_as_the_ledger_says(dimension):
    errors, rest = [], [2.0] * (dimension - 2)
    spin = 1.0 if dimension == 2 else [0.2, 0.3, 1.0]
    for step in (0.01, 0.005, 0.0025):
        bars = [bar(1.6, 2.0, *rest, name="a", angular_velocity=spin), bar(2.2, 2.1, *rest, name="b")]
        it = run(linked_scene(bars, [slider("b", "a", axis=AXES[dimension], drive=WAVE)], end=0.4, step=step))
        errors.append(abs(it.state.ledger.residual))
        stroke = it.system.joints._parts[0].constraints[-1].drive
        told = of_joint(it)
        np.testing.assert_allclose(told["displacement"], [stroke.value(time) for time in told["time"]], atol=1e-12)
        np.testing.assert_allclose(told["rate"], [stroke.rate(time) for time in told["time"]], atol=1e-11)
    assert abs(it.state.ledger.control) > 100.0 * errors[-1]
    assert falls(errors, 0.3)


def test_a_spherical_pendulum_keeps_energy_and_vertical_angular_momentum():
    errors, pivot = [], np.array([2.0, 2.0, 3.0])
    for step in (0.02, 0.01, 0.005):
        bob = bar(2.6, 2.0, 3.0, name="bob", velocity=[0.0, 1.0, 0.0], angular_velocity=[0.0, 0.0, 1.0 / 0.6])
        it = Simulation(linked_scene([bob], [ball("bob", at=pivot)], gravity=[0.0, 0.0, -10.0], end=0.6, step=step))
        gaps, before, vertical = [], [], []
        it.observe(lambda now, seen=vertical: seen.append(angular_momentum(now, pivot)[2]))
        it.observe(lambda now, seen=gaps: seen.append(misfit(now)))
        it.observe(lambda now, seen=before: seen.append(now.state.ledger.residual))
        start = angular_momentum(it, pivot)[2]
        it.go()
        assert start > 1e-3
        np.testing.assert_allclose(vertical, start, rtol=1e-11)
        assert max(gaps) < 1e-12
        errors.append(np.abs(before).max() / it.state.ledger.gravity)
    assert it.bodies["bob"].position[2] < 2.7
    assert np.isnan(of_joint(it)["angle"]).all()
    assert errors[0] < 0.02
    assert falls(errors, 0.3)


def angular_momentum(it, pivot):
    pose, twist, mass = it.state.pose, it.state.twist, it.system.mass
    inertia = lab_inertia(it.system.inertia, pose.orientation)[0]
    return mass[0] * np.cross(pose.position[0] - pivot, twist.velocity[0]) + inertia @ twist.angular_velocity[0]


def test_a_damped_ball_stops_turning():
    """I ω' = -c ω of a ball that is held at its centre."""
    pin = ball("it", at=[2.0, 2.0, 2.0], damping=1e-5)
    it = run(linked_scene([body(2.0, 2.0, 2.0, name="it", angular_velocity=[1.0, -2.0, 0.5])], [pin], step=0.1))
    decay = np.exp(-1e-5 / it.system.inertia[0, 0, 0])
    assert decay < 0.9
    np.testing.assert_allclose(it.bodies["it"].angular_velocity, decay * np.array([1.0, -2.0, 0.5]), rtol=1e-8)


@pytest.mark.long
def test_sliders_are_told_resumed_and_drawn(tmp_path):
    """With a hinge: each has its own column, and a run goes on with the same bits."""
    bodies = [body(2.0, 3.0, name="cart"), bar(2.28, 2.8, name="bar")]
    joints = [slider("cart", axis=[1.0, 0.0], drive=WAVE), hinge("bar", "cart", at=[2.0, 2.8], name="knee")]
    keys = {"gravity": [0.0, -10.0], "step": 0.01, "output": {"every": 0.05}}
    whole, first = (linked_scene(bodies, joints, end=end, **keys) for end in (0.2, 0.1))
    history = rigidfluid.run(whole, tmp_path / "whole")
    rigidfluid.run(first, tmp_path / "parts")
    rigidfluid.run(whole, tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "joints.csv", "energy.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    header = (tmp_path / "whole" / "joints.csv").read_text().splitlines()[0]
    assert header == "time,step,joint,gap,angle,displacement,rate,fx,fy,t"
    told = history.joints
    knee = told["joint"] == "knee"
    assert np.isnan(told["displacement"][knee]).all()
    assert np.isnan(told["angle"][~knee]).all()
    assert np.abs(told["displacement"][~knee]).max() > 0.05
    assert {"joints.png", "joints.svg"} <= {path.name for path in report(tmp_path / "whole")}


def test_a_scene_without_sliders_has_the_columns_that_it_had(tmp_path):
    scene = linked_scene([bar(2.4, 3.0, name="bar")], [hinge("bar", at=[2.1, 3.0])], end=0.02)
    rigidfluid.run(scene, tmp_path)
    assert (tmp_path / "joints.csv").read_text().startswith("time,step,joint,gap,angle,rate,fx,fy,t\n")


def test_the_check_tells_how_far_a_slider_moves():
    """Two balls of radius .1 that are .6 apart, on an axis through both."""
    pair = [body(1.7, 2.0, name="a"), body(2.3, 2.0, name="b")]
    for drive, grade in ((None, "warning"), (0.3, "note"), (0.5, "error")):
        keys = {} if drive is None else {"drive": {"piecewise": [[0.0, 0.0], [0.05, -drive], [0.1, 0.0]]}}
        scene = linked_scene(pair, [slider("b", "a", axis=[1.0, 0.0], **keys)])
        (found,) = [one for one in check(scene).findings if one.text.startswith("slider")]
        assert found.grade == grade
        assert found.found["least_displacement"] == pytest.approx(-0.4, abs=1e-3)
        assert found.found["greatest_displacement"] == np.inf


REFUSED = {
    "no axis": ({"type": "slider"}, "joint.0.axis: found nothing", "Add the key 'axis'"),
    "an axis of 3D": ({"type": "slider", "axis": [1.0, 0.0, 0.0]}, "joint.0.axis", "2 numbers"),
    "a rest alone": (
        {"type": "slider", "axis": [1.0, 0.0], "rest_length": 1.0},
        "joint.0.rest_length: a slider has a rest length only if it has a stiffness",
        "`stiffness`",
    ),
    "a key of the hinge": (
        {"type": "slider", "axis": [1.0, 0.0], "stiffness": 1.0, "rest_angle": 1.0},
        "joint.0.rest_angle: found a key that nothing reads",
        "Did you mean",
    ),
    "a drive and a damper": (
        {"type": "slider", "axis": [1.0, 0.0], "drive": WAVE, "damping": 1.0},
        "joint.0.drive: a slider whose displacement is driven does not feel a `damping`",
        "Remove `drive`",
    ),
    "a drive that starts elsewhere": (
        {"type": "slider", "axis": [1.0, 0.0], "drive": {"piecewise": [[0.0, 0.1], [1.0, 0.1]]}},
        "joint 'joint0'",
        "starts at the displacement 0.1",
    ),
    "a ball in 2D": ({"type": "ball", "at": [2.0, 2.0]}, "joint.0.type: found 'ball' in 2D", "Set type = 'hinge'"),
    "a hinge nowhere": ({"type": "hinge"}, "joint.0.at: found nothing", "Add the key 'at'"),
    "no such joint": ({"type": "slyder"}, "joint.0.type", "Did you mean 'slider'?"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_joints_that_cannot_be_are_refused_with_a_remedy(case):
    joint, field, remedy = REFUSED[case]
    with pytest.raises(rigidfluid.errors.RigidfluidError) as raised:
        build_system(linked_scene([body(2.0, 2.0)], [joint | {"between": ["body0"]}]))
    assert field in str(raised.value)
    assert remedy in str(raised.value)


def test_a_scene_of_sliders_is_read_back_as_it_was():
    scene = linked_scene([body(2.0, 2.0)], [slider("body0", axis=[1, 0], drive=WAVE)])
    assert scene_from_dict(scene.to_dict()) == scene
    assert scene.to_dict()["joint"][0]["drive"]["repeat"] is True


def test_the_schema_has_the_keys_of_each_type():
    schema = jsonschema.Draft7Validator(json_schema())
    rail = slider("body0", axis=[1.0, 0.0], stiffness=1.0, rest_length=0.1, drive=WAVE)
    for given, wrong in ((rail, {"rest_angle": 0.1}), ({"type": "rod", "between": ["body0"]}, {"stiffness": 1.0})):
        scene = linked_scene([body(2.0, 2.0)], []).to_dict()
        assert not list(schema.iter_errors(scene | {"joint": [given]}))
        assert list(schema.iter_errors(scene | {"joint": [given | wrong]}))
