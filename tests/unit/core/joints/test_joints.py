"""Joints, held directions and springs as a scene gives them, and what a run tells of them."""

import copy

import numpy as np
import pytest

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.pairs.proximity import interacting
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.setup.geometry_checks import initial_contacts
from rigidfluid.errors import SceneError, StepError
from rigidfluid.post.reports import report

LAW = {"law": "centre", "range": 0.05, "epsilon": 1e-3}


def ball(name, *position, **keys):
    return {"name": name, "type": "sphere", "radius": 0.1, "density": 1.0, "position": list(position)} | keys


def hinge(*between, **keys):
    return {"type": "hinge", "between": list(between), "at": [0.5, 0.5]} | keys


def tables(*bodies, joint=(), dimension=2, end=0.1, step=1e-3, every=None, contact=None, mesh=None, **fluid):
    return {
        "scene": {"name": "joints", "dimension": dimension},
        "fluid": {"backend": "dry"} | fluid,
        "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
        "body": list(bodies),
        "joint": list(joint),
        "contact": contact or {},
        "mesh": mesh or {"size": 0.2, "size_body": 0.05},
        "time": {"end": end, "step": step},
        "output": {"every": every or end},
    }


PAIR = ball("one", 0.3, 0.5), ball("two", 0.7, 0.5)
IN_3D = ball("one", 0.3, 0.5, 0.5), ball("two", 0.7, 0.5, 0.5)
WATER = {"backend": "scikit-fem", "density": 0.01, "viscosity": 1e-4}
STROKE = {"piecewise": [[0.0, 0.0], [1.0, 0.5], [2.0, 0.0]]}


def system_of(*bodies, **keys):
    return build_system(scene_from_dict(tables(*bodies, **keys)))


REFUSED = {
    "an unknown body": (tables(*PAIR, joint=[hinge("one", "tow")]), "joint.0.between.1", "Did you mean 'two'?"),
    "one body twice": (tables(*PAIR, joint=[hinge("one", "one")]), "joint.0.between", "two different bodies"),
    "two of one name": (
        tables(*PAIR, joint=[hinge("one", name="it"), hinge("two", name="it")]),
        "joint.name: found 'it'",
        "no other joint or body",
    ),
    "a body's name": (tables(*PAIR, joint=[hinge("one", name="one")]), "joint.name: found 'one'", "Rename it"),
    "a hinge nowhere": (
        tables(*PAIR, joint=[{"type": "hinge", "between": ["one"]}]),
        "joint.0.at: found nothing",
        "Add the key 'at'",
    ),
    "a point in 3D": (tables(*PAIR, joint=[hinge("one", at=[0.5] * 3)]), "joint.0.at", "2 numbers"),
    "an axis in 2D": (tables(*PAIR, joint=[hinge("one", axis=[0, 0, 1])]), "joint.0.axis", "none in 2D"),
    "no axis in 3D": (
        tables(*IN_3D, joint=[hinge("one", at=[0.5] * 3)], dimension=3),
        "joint.0.axis: found nothing",
        "Add the key 'axis'",
    ),
    "an axis of no length": (
        tables(*IN_3D, joint=[hinge("one", at=[0.5] * 3, axis=[0, 0, 0])], dimension=3),
        "joint.0.axis",
        "length above 0",
    ),
    "a spring in a rod": (
        tables(*PAIR, joint=[{"type": "rod", "between": ["one", "two"], "stiffness": 1.0}]),
        "joint.0.stiffness: found a key that nothing reads; allowed is at, between, name, type",
        "Set type = 'hinge' or 'slider', or remove `stiffness`",
    ),
    "a rest angle alone": (tables(*PAIR, joint=[hinge("one", rest_angle=1.0)]), "joint.0.rest_angle", "`stiffness`"),
    "a drive and a damper": (
        tables(*PAIR, joint=[hinge("one", drive=STROKE, damping=1.0)]),
        "joint.0.drive: a hinge whose angle is driven does not feel a `damping`",
        "Remove `drive`",
    ),
    "a drive without rows": (tables(*PAIR, joint=[hinge("one", drive={})]), "joint.0.drive", "one of them"),
    "a drive that starts elsewhere": (
        tables(*PAIR, joint=[hinge("one", drive={"piecewise": [[0.0, 0.1], [1.0, 0.1]]})]),
        "joint 'joint0'",
        "starts at the angle 0.1",
    ),
    "what is fixed to the ground": (
        tables(ball("one", 0.3, 0.5, fixed=True), PAIR[1], joint=[hinge("one")]),
        "joint 'joint0'",
        "nothing that moves freely",
    ),
    "a joint twice": (
        tables(*PAIR, joint=[hinge("one", "two"), hinge("one", "two")]),
        "joint 'joint1'",
        "over-determined",
    ),
    "nothing held": (tables(ball("it", 0.5, 0.5, free=["x", "y", "rotation"])), "body.0.free", "Leave `free` out"),
    "all held": (tables(ball("it", 0.5, 0.5, free=[])), "body.0.free: found none", "`fixed = true`"),
    "a direction of 3D": (tables(ball("it", 0.5, 0.5, free=["z"])), "body.0.free: found 'z' in 2D", "rotation"),
    "a direction twice": (tables(ball("it", 0.5, 0.5, free=["x", "x"])), "body.0.free: found 'x' twice", "once"),
    "free and fixed": (tables(ball("it", 0.5, 0.5, free=["x"], fixed=True)), "body.0.free", "Remove `free`"),
    "a velocity that is held": (
        tables(ball("it", 0.5, 0.5, free=["x"], velocity=[1.0, 2.0])),
        "body.0.velocity: found 2 along 'y'",
        "Set it to 0",
    ),
    "a spring that is held": (
        tables(ball("it", 0.5, 0.5, free=["x"], spring={"stiffness": [1.0, 3.0]})),
        "body.0.spring.stiffness: found 3 along 'y'",
        "add it to `free`",
    ),
    "a spring of what is driven": (
        tables(ball("it", 0.5, 0.5, prescribed={"velocity": [1.0, 0.0]}, spring={"stiffness": [1.0, 3.0]})),
        "body.0.spring",
        "Remove `spring`",
    ),
    "a spring of one number": (tables(ball("it", 0.5, 0.5, spring={"stiffness": [1.0]})), "body.0.spring", "2 numbers"),
    "a spring of nothing": (tables(ball("it", 0.5, 0.5, spring={})), "body.0.spring", "no stiffness and no damping"),
    "a spring that pushes": (
        tables(ball("it", 0.5, 0.5, spring={"stiffness": [-1.0, 0.0]})),
        "body.0.spring.stiffness.0",
        "greater than or equal to 0",
    ),
    "a rest of no spring": (
        tables(ball("it", 0.5, 0.5, spring={"damping": [1.0, 1.0], "rest": [0.5, 0.5]})),
        "body.0.spring.rest",
        "Remove it",
    ),
    "a spring too stiff for the step": (
        tables(ball("it", 0.5, 0.5, spring={"stiffness": [0.01 * np.pi * 601.0**2, 0.0]})),
        "time.step: found 0.001, in which the stiffest spring turns by 0.601",
        "at most 0.000832",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_with_a_remedy(case):
    data, field, remedy = REFUSED[case]
    with pytest.raises(SceneError) as raised:
        build_system(scene_from_dict(data))
    assert field in str(raised.value)
    assert remedy in str(raised.value)


def test_a_scene_of_joints_is_read_back_as_it_was():
    spring = {"stiffness": [0.0, 2.0], "angular_damping": 0.5, "rest": [0.3, 0.4]}
    data = tables(PAIR[0] | {"free": ["y", "rotation"], "spring": spring}, PAIR[1], joint=[hinge("one", "two")])
    scene = scene_from_dict(data)
    assert scene_from_dict(scene.to_dict()) == scene
    assert scene.joint[0].name == "joint0"


def test_a_scene_without_joints_says_nothing_of_them():
    """So that checkpoints of before go on."""
    written = scene_from_dict(tables(*PAIR)).to_dict()
    assert "joint" not in written
    assert not {"free", "spring"} & set(written["body"][0])


def test_rows_of_a_drive_come_from_a_file_once(tmp_path):
    (tmp_path / "angle.csv").write_text("0, 0\n1, 0.5\n2, 0\n")
    data = tables(*PAIR, joint=[hinge("one", "two", drive={"smooth": {"file": str(tmp_path / "angle.csv")}})])
    scene = scene_from_dict(data)
    (tmp_path / "angle.csv").unlink()
    assert scene.joint[0].options["drive"]["smooth"] == [[0.0, 0.0], [1.0, 0.5], [2.0, 0.0]]
    assert scene_from_dict(scene.to_dict()) == scene


def test_joined_bodies_do_not_repel_but_the_next_ones_do():
    bodies = [ball(name, x, 0.5) for name, x in (("a", 0.15), ("b", 0.38), ("c", 0.61))]
    apart = ball("d", 0.38, 0.73)
    joint = [hinge("b", "a", at=[0.265, 0.5]), hinge("b", "c", at=[0.495, 0.5])]
    scene = scene_from_dict(tables(*bodies, apart, joint=joint, contact=LAW))
    system, parts = build_system(scene), model_of(scene)
    near = initial_contacts(parts, system.pose, np.inf)
    acting = interacting(system, near)
    names = {tuple(sorted(system.surfaces[i] for i in pair)) for pair in zip(acting.body_a, acting.body_b, strict=True)}
    assert ("a", "b") not in names
    assert ("b", "c") not in names
    assert {("a", "c"), ("b", "d"), ("a", "left")} <= names


def test_bodies_that_are_joined_hit_with_the_mass_of_all():
    contact = LAW | {"impact_speed": 1.0}
    free = system_of(*PAIR, contact=contact)
    joined = system_of(*PAIR, joint=[hinge("one", "two")], contact=contact)
    np.testing.assert_allclose(joined.loads.mass, 2.0 * free.loads.mass)
    held = system_of(PAIR[0] | {"free": ["x"]}, PAIR[1], contact=contact)
    np.testing.assert_allclose(held.loads.mass, free.loads.mass)


def test_velocities_at_the_start_are_those_that_joints_allow():
    """What an impulse in the joint leaves of a velocity that only one of two equal bodies is given."""
    rod = {"type": "rod", "between": ["one", "two"]}
    system = system_of(PAIR[0] | {"velocity": [2.0, 0.0]}, PAIR[1], joint=[rod])
    np.testing.assert_allclose(system.twist.velocity, [[1.0, 0.0], [1.0, 0.0]], atol=1e-12)


@pytest.fixture(scope="module")
def swing():
    """A ball on the ground by a hinge above it, with a spring and a damper, and a body on a spring."""
    bodies = ball("bob", 0.5, 0.3, velocity=[0.4, 0.0], angular_velocity=2.0), ball("other", 0.8, 0.8, free=["y"])
    bodies[1]["spring"] = {"stiffness": [0.0, 0.3], "rest": [0.8, 0.7]}
    joint = hinge("bob", stiffness=0.02, rest_angle=0.1, damping=1e-3)
    simulation = Simulation(scene_from_dict(tables(*bodies, joint=[joint], gravity=[0.0, -1.0])))
    simulation.go()
    return simulation


def rows_of(simulation, name):
    joints = simulation.history.joints
    return {column: values[joints["joint"] == name] for column, values in joints.items()}


def test_joints_are_told_of_at_each_step(swing):
    pin, bodies = rows_of(swing, "joint0"), swing.history.bodies
    bob = {column: values[bodies["body"] == "bob"] for column, values in bodies.items()}
    assert len(pin["time"]) == swing.state.count + 1
    assert pin["gap"].max() < 1e-14
    np.testing.assert_allclose(pin["angle"], bob["angle"], atol=1e-15)
    np.testing.assert_allclose(pin["rate"], bob["w"], atol=1e-12)


def test_the_force_of_a_joint_is_what_moves_the_body_beyond_its_weight(swing):
    """m dv/dt = F + m g in the mean of each step; about the point, the torque is the spring's and the damper's."""
    pin, bodies = rows_of(swing, "joint0"), swing.history.bodies
    bob = {column: values[bodies["body"] == "bob"] for column, values in bodies.items()}
    mass, step = 0.01 * np.pi, np.diff(bob["time"])
    np.testing.assert_allclose(pin["fx"][1:], mass * np.diff(bob["vx"]) / step, rtol=1e-8)
    np.testing.assert_allclose(pin["fy"][1:], mass * (np.diff(bob["vy"]) / step + 1.0), rtol=1e-8)
    np.testing.assert_allclose(pin["t"][1:], -0.02 * (pin["angle"] - 0.1)[1:] - 1e-3 * pin["rate"][1:], rtol=1e-2)


def test_a_held_body_is_told_of_by_its_own_name(swing):
    held, bodies = rows_of(swing, "other"), swing.history.bodies
    y = bodies["y"][bodies["body"] == "other"]
    np.testing.assert_allclose(held["fy"], -0.3 * (y - 0.7), rtol=1e-12)
    assert np.isnan(held["angle"]).all()
    assert np.abs(held["gap"]).max() < 1e-15


def test_a_corner_of_a_stroke_that_a_joint_resists_is_in_the_balance():
    """A pinned mechanism throws one of its balls to and fro: it turns back at once when the ball does."""
    parts = [{key: value for key, value in one.items() if key != "position"} for one in PAIR]
    parts = [part | {"position": place} for part, place in zip(parts, ([-0.2, 0.0], [0.2, 0.0]), strict=True)]
    stroke = {"moves": ["one"], "along": [0.0, 1.0], "piecewise": [[0.0, 0.0], [0.5, 0.15], [1.0, 0.0]]}
    mechanism = {"name": "it", "type": "articulated", "component": parts, "stroke": [stroke], "position": [0.5, 0.5]}
    data = tables(joint=[hinge("it.two", at=[0.6, 0.5])], end=1.0, step=0.02) | {"mechanism": [mechanism]}
    it = Simulation(scene_from_dict(data))
    it.go(0.5)
    before = it.state.ledger.residual
    it.go(0.52)
    assert it.state.ledger.put_in > 1e-4
    assert abs(it.state.ledger.residual - before) < 0.005 * it.state.ledger.put_in


def test_joined_bodies_that_fold_until_they_touch_end_the_run_with_a_remedy():
    falling = PAIR[0] | {"fixed": True}, PAIR[1] | {"position": [0.55, 0.55]}
    data = tables(*falling, joint=[hinge("one", "two", at=[0.4, 0.5])], end=1.0, step=0.01, gravity=[0.0, -9.81])
    with pytest.raises(StepError, match="Joined bodies do not repel each other: they need a spring"):
        Simulation(scene_from_dict(data)).go()


@pytest.mark.parametrize(("fluid", "lost"), [({"backend": "dry"}, 0.0), (WATER, 0.005)])
def test_a_spring_alone_needs_no_joint(fluid, lost):
    """Half a period of a ball of mass m on a spring k, in a fluid of much less mass: x = a cos(√(k/m) t)."""
    mass, stiffness = 0.01 * np.pi, 0.01 * np.pi**3
    spring = {"stiffness": [stiffness, 0.0], "rest": [0.5, 0.5]}
    it = Simulation(scene_from_dict(tables(ball("one", 0.6, 0.5, spring=spring), end=1.0, step=0.05, **fluid)))
    it.go()
    assert stiffness / mass == pytest.approx(np.pi**2)
    assert it.history.bodies["x"][-1] == pytest.approx(0.4, abs=lost + 1e-4)
    assert it.history.joints["gap"].max() == 0.0


def test_a_joint_follows_a_body_that_is_prescribed_later():
    hand = ball("hand", 0.5, 0.8, fixed=True)
    simulation = Simulation(scene_from_dict(tables(hand, ball("bob", 0.5, 0.3), joint=[hinge("bob", "hand")])))
    simulation.go(0.02)
    simulation.prescribe("hand", velocity=[0.3, 0.0])
    simulation.go()
    pin = rows_of(simulation, "joint0")
    assert pin["gap"].max() < 1e-13
    np.testing.assert_allclose(simulation.bodies["hand"].position, [0.524, 0.8])
    assert pin["rate"][-1] < -0.1


def test_a_saved_run_goes_on_with_the_same_bits(tmp_path):
    bodies = PAIR[0], PAIR[1] | {"density": 2.0}, ball("held", 0.5, 0.2, free=["y"], spring={"stiffness": [0.0, 5.0]})
    joint = hinge("one", "two", stiffness=0.02, damping=1e-3)
    fluid = {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.1, "gravity": [0.0, -9.81]}
    data = tables(
        *bodies, joint=[joint], end=0.04, step=0.005, every=0.02, mesh={"size": 0.3, "size_body": 0.1}, **fluid
    )
    whole = rigidfluid.run(scene_from_dict(data), tmp_path / "whole")
    rigidfluid.run(scene_from_dict(data | {"time": {"end": 0.02, "step": 0.005}}), tmp_path / "resumed")
    rigidfluid.run(scene_from_dict(data), tmp_path / "resumed", resume=True)
    assert whole.summary["steps"] > 4
    for name in ("bodies.csv", "joints.csv", "energy.csv"):
        assert (tmp_path / "resumed" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    assert np.abs(whole.joints["fx"]).max() > 0.0


def test_a_report_draws_hinges(tmp_path):
    joint = hinge("one", "two", stiffness=0.02)
    rigidfluid.run(scene_from_dict(tables(*PAIR, joint=[joint], gravity=[0.0, -1.0], end=0.01)), tmp_path)
    assert {"joints.png", "joints.svg"} <= {path.name for path in report(tmp_path)}


def findings(*bodies, **keys):
    found = check(scene_from_dict(tables(*bodies, **keys))).findings
    return {one.text.split()[0]: one for one in found if one.question == "joints"}


def test_the_check_counts_what_joints_leave_free():
    found = findings(*PAIR, ball("held", 0.5, 0.2, free=["y"]), joint=[hinge("one", "two")])
    assert dict(found["joints"].found) == {"joints": 1, "velocities": 9, "held": 4, "remaining": 5}


@pytest.mark.parametrize(("stiffness", "grade"), [(100.0, "note"), (2000.0, "warning")])
def test_the_check_sets_springs_beside_the_step(stiffness, grade):
    found = findings(ball("one", 0.5, 0.5, spring={"stiffness": [stiffness, 0.0]}))["the"]
    assert found.found["frequency"] == pytest.approx(np.sqrt(stiffness / (0.01 * np.pi)))
    assert found.grade == grade
    if grade == "warning":
        assert found.enough["time_step"] == pytest.approx(0.2 / found.found["frequency"])


def test_the_check_tells_how_far_a_hinge_turns():
    """Two balls of radius 0.1 at 0.2 from the hinge touch at ±(180° - 60°)."""
    found = findings(*PAIR, joint=[hinge("one", "two")])["hinge"]
    assert found.grade == "warning"
    assert found.found["gap"] == pytest.approx(0.2)
    assert found.found["greatest_angle"] == pytest.approx(2.0 * np.pi / 3.0, abs=1e-3)
    assert found.found["least_angle"] == pytest.approx(-2.0 * np.pi / 3.0, abs=1e-3)
    for angle, grade in ((2.0, "note"), (2.2, "error")):
        drive = {"piecewise": [[0.0, 0.0], [0.05, angle], [0.1, 0.0]]}
        assert findings(*PAIR, joint=[hinge("one", "two", drive=drive)])["hinge"].grade == grade


def test_tables_of_a_scene_are_left_as_they_were_given():
    data = tables(*PAIR, joint=[hinge("one", "two", drive=STROKE)])
    before = copy.deepcopy(data)
    scene_from_dict(data)
    assert data == before
