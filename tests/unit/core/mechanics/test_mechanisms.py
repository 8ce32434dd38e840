"""Several bodies that move as one, without a fluid and in it."""

import json
from pathlib import Path

import mechanism_parts
import numpy as np
import pytest
from mechanism_parts import Dumbbell, Ellipse, Hammer, PairOptions, Stroke

import rigidfluid
from rigidfluid.checks.report import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mechanics.component_dynamics import ComponentDynamics
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.motions import body_accelerations
from rigidfluid.core.mechanics.rigid import lab_inertia, turned
from rigidfluid.core.mechanics.time_scheme import derivative_weights
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.types import Wrench
from rigidfluid.core.output.energy_account import energy_account
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import PluginError, SceneError
from rigidfluid.testing import MechanismContract

LAW = {"law": "centre", "range": 0.005, "epsilon": 1e-8}


@pytest.fixture(autouse=True)
def parts(install):
    code = Path(mechanism_parts.__file__).read_text(encoding="utf-8")
    install(code, name="mechanisms", module="installed_mechanisms")


class TestMechanisms(MechanismContract):
    @pytest.fixture(params=[(kind, d) for kind in (Dumbbell, Hammer, Ellipse, Stroke) for d in (2, 3)], ids=str)
    def mechanism(self, request):
        kind, dimension = request.param
        return kind(PairOptions(radius=0.1, length=0.6, density=2.0, ratio=1.5, stroke=0.1), dimension)


def pair(kind="dumbbell", dimension=2, **keys):
    table = {"name": "it", "type": kind, "radius": 0.05, "length": 0.3, "density": 1.0, "position": [0.5] * dimension}
    return table | keys


def scene(*mechanisms, body=(), contact=None, end=0.1, step=1e-3, every=None, upper=None, size_body=0.03, **fluid):
    dimension = len((*mechanisms, *body)[0]["position"])
    return scene_from_dict(
        {
            "scene": {"name": "mechanism", "dimension": dimension},
            "fluid": {"backend": "dry"} | fluid,
            "domain": {"lower": [0.0] * dimension, "upper": upper or [1.0] * dimension},
            "body": list(body),
            "mechanism": list(mechanisms),
            "contact": contact or {},
            "mesh": {"size": 0.2, "size_body": size_body},
            "time": {"end": end, "step": step},
            "output": {"every": every or end},
        }
    )


def wet(*mechanisms, model="navier-stokes", viscosity=0.1, **keys):
    fluid = {"backend": "scikit-fem", "model": model, "density": 1.0, "viscosity": viscosity}
    return scene(*mechanisms, **fluid | keys)


def run(given, until=np.inf):
    simulation = Simulation(given)
    simulation.go(until)
    return simulation


def apart(simulation):
    """Distances of the components of a pair, exact where it is rigid."""
    position = simulation.state.pose.position
    return float(np.linalg.norm(position[1] - position[0]))


def assert_evaluated(simulation):
    """Poses are those of the motions at this very time, and no sum of substeps."""
    evaluated = simulation.system.motions.poses(simulation.state.motions.pose, simulation.time)
    np.testing.assert_array_equal(simulation.state.pose.position, evaluated.position)
    np.testing.assert_array_equal(simulation.state.pose.orientation, evaluated.orientation)


def angular_momentum(simulation):
    """About the centre of mass, of the last motion."""
    system, free = simulation.system, simulation.state.motions
    inertia = lab_inertia(system.motions.inertia(simulation.time), free.pose.orientation)[-1]
    spin = turned(free.pose.orientation, system.motions.spin(simulation.time))[-1]
    return inertia @ free.twist.angular_velocity[-1] + spin


def ellipsoid_like(system, table):
    """An ellipsoid of the mass and the inertia of the first mechanism, that starts as it does."""
    mass, inertia = system.motions.mass[0], system.motions.inertia(0.0)[0]
    if len(inertia) == 1:
        squares = np.full(2, 2.0 * inertia[0, 0] / mass)
    else:
        moments = 5.0 * np.diag(inertia) / mass
        squares = 0.5 * moments.sum() - moments
    axes, d = np.sqrt(squares), len(table["position"])
    volume = np.pi * np.prod(axes) * (1.0 if d == 2 else 4.0 / 3.0)
    kept = {key: table[key] for key in ("position", "velocity", "angular_velocity")}
    return {"type": "ellipsoid", "semi_axes": axes.tolist(), "density": mass / volume} | kept


@pytest.mark.parametrize(("dimension", "spin"), [(2, 9.0), (3, [7.0, 3.0, -2.0])])
def test_one_that_is_thrown_moves_as_a_rigid_body_of_its_mass_and_inertia(dimension, spin):
    table = pair(dimension=dimension, velocity=[1.0, 0.5, 0.0][:dimension], angular_velocity=spin)
    gravity = [0.0, -3.0, 0.0][:dimension]
    it = run(scene(table, gravity=gravity, upper=[3.0] * dimension))
    other = scene(body=[ellipsoid_like(it.system, table)], gravity=gravity, upper=[3.0] * dimension)
    like = run(other)
    whole, body = it.bodies["it"], like.bodies["body0"]
    for quantity in ("position", "orientation", "velocity", "angular_velocity"):
        np.testing.assert_allclose(getattr(whole, quantity), getattr(body, quantity), rtol=1e-12, atol=1e-12)
    assert it.state.ledger.kinetic == pytest.approx(like.state.ledger.kinetic, rel=1e-12)


@pytest.mark.parametrize("kind", ["dumbbell", "hammer"])
def test_free_rotation_keeps_energy_angular_momentum_and_shape(kind):
    it = Simulation(scene(pair(kind, 3, ratio=3.0, angular_velocity=[7.0, 3.0, -2.0]), end=0.5, step=1e-2))
    energy, momentum = it.state.ledger.kinetic, angular_momentum(it)
    it.go()
    assert it.state.ledger.kinetic == pytest.approx(energy, rel=1e-11)
    np.testing.assert_allclose(angular_momentum(it), momentum, rtol=1e-12, atol=1e-12 * np.abs(momentum).max())
    assert apart(it) == pytest.approx(0.3, rel=1e-15, abs=1e-15)
    assert not np.allclose(it.bodies["it"].angular_velocity, [7.0, 3.0, -2.0], rtol=0.05)


def after_impact(it, lever):
    """Velocity along the floor's normal and spin after an elastic impact of a pair that did not turn, at speed 3."""
    mass, inertia = it.system.motions.mass[0], it.system.motions.inertia(0.0)[0, 0, 0]
    impulse = 6.0 / (1.0 / mass + lever**2 / inertia)
    return -3.0 + impulse / mass, lever * impulse / inertia


@pytest.mark.parametrize(("stepping", "error"), [("substeps", 3e-5), ("implicit", 1e-9)])
@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_one_ball_that_bounces_turns_the_whole(stepping, error, ratio):
    table = pair(ratio=ratio, angle=0.3, position=[0.5, 0.3], velocity=[0.0, -3.0])
    it = Simulation(scene(table, contact=LAW | {"epsilon": 1e-9, "stepping": stepping}, step=2e-4))
    energy = it.state.ledger.kinetic
    lever = float(it.state.pose.position[0, 0] - it.bodies["it"].position[0])
    it.go(0.08)
    velocity, spin = after_impact(it, lever)
    assert it.bodies["it"].velocity[1] == pytest.approx(velocity, abs=0.02)
    assert it.bodies["it"].angular_velocity[0] == pytest.approx(spin, rel=2e-3)
    assert it.state.ledger.kinetic == pytest.approx(energy, rel=error)
    assert apart(it) == pytest.approx(0.3, rel=1e-15)


@pytest.mark.long
def test_a_bounce_in_three_dimensions_keeps_energy_and_turns_as_in_two():
    flat = pair(position=[0.5, 0.3], velocity=[0.0, -3.0], angle=0.3)
    turn = [np.cos(0.15), 0.0, 0.0, np.sin(0.15)]
    solid = pair(dimension=3, position=[0.5, 0.3, 0.5], velocity=[0.0, -3.0, 0.0], orientation=turn)
    it = Simulation(scene(solid, contact=LAW | {"epsilon": 1e-10}, step=2e-4))
    energy = it.state.ledger.kinetic
    it.go(0.095)
    assert it.state.ledger.kinetic == pytest.approx(energy, rel=1e-5)
    lever = -0.15 * np.cos(0.3)
    inertia, mass = it.system.motions.inertia(0.0)[0, 2, 2], it.system.motions.mass[0]
    impulse = 6.0 / (1.0 / mass + lever**2 / inertia)
    np.testing.assert_allclose(it.bodies["it"].angular_velocity, [0.0, 0.0, lever * impulse / inertia], atol=0.05)
    assert np.sign(it.bodies["it"].angular_velocity[2]) == np.sign(run_bounce(flat))


def run_bounce(table):
    return run(scene(table, contact=LAW | {"epsilon": 1e-9}, step=2e-4), 0.095).bodies["it"].angular_velocity[0]


@pytest.mark.long
def test_two_of_them_collide_and_keep_momentum_and_energy():
    left = pair("hammer", name="a", position=[0.3, 0.5], angle=1.4, velocity=[2.0, 0.0])
    right = pair("dumbbell", name="b", position=[0.7, 0.6], angle=1.7, velocity=[-1.0, 0.0], density=2.0)
    ball = {"type": "sphere", "radius": 0.05, "density": 3.0, "position": [0.5, 0.9], "velocity": [0.0, -3.0]}
    law = {"law": "normal", "range": 0.01, "epsilon": 1e-7}
    it = Simulation(scene(left, right, body=[ball], contact=law, end=0.15, step=2e-4))

    def momenta():
        mass, inertia = it.system.mass, it.system.inertia
        pose, twist = it.state.pose, it.state.twist
        linear = mass @ twist.velocity
        arm = pose.position
        angular = mass @ (arm[:, 0] * twist.velocity[:, 1] - arm[:, 1] * twist.velocity[:, 0])
        return np.append(linear, angular + inertia[:, 0, 0] @ twist.angular_velocity[:, 0])

    before, energy = momenta(), it.state.ledger.kinetic
    pushed = []
    it.observe(lambda now: pushed.append(np.abs(now.bodies["b"].contact_force).max() > 0.0))
    it.go()
    assert any(pushed)
    np.testing.assert_allclose(momenta(), before, atol=1e-12)
    assert it.state.ledger.kinetic + it.state.ledger.contact == pytest.approx(energy, rel=1e-4)


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_contacts_are_told_of_masses_is_what_kicks_do(dimension):
    other = pair(name="other", dimension=dimension, position=[0.5, 0.2, 0.5][:dimension])
    system = build_system(scene(pair("hammer", dimension, ratio=3.0), other))
    mechanisms = system.motions
    inert = mechanisms.mass, mechanisms.inertia(0.0), np.zeros((2, dimension)), mechanisms.prescribed, None
    motions = DryDynamics(mechanisms.pose, mechanisms.twist, *inert)
    bodies = ComponentDynamics(motions, mechanisms, 0.0)
    force = np.random.default_rng(1).normal(size=(4, dimension))
    force /= np.linalg.norm(force, axis=1, keepdims=True)
    wrench = Wrench(force, np.random.default_rng(2).normal(size=system.twist.angular_velocity.shape))
    inverse, alone = bodies.inverse_masses(1.0), Wrench(np.zeros_like(force), np.zeros_like(wrench.torque))
    alone.force[1] = force[1]
    lightness = bodies.inverse_mass_along(np.array([1]), force[1:2])[0], force[1] @ bodies.inverse_mass[1] @ force[1]
    one = bodies.copied()
    one.kick(alone, 0.1)
    np.testing.assert_allclose(lightness, 10.0 * force[1] @ one.twist.velocity[1])
    bodies.kick(wrench, 0.1)
    np.testing.assert_allclose(flat(bodies.twist).ravel(), 0.1 * inverse @ flat(wrench).ravel())
    pushed = 0.1 * np.array([force[:2].sum(axis=0), force[2:].sum(axis=0)])
    np.testing.assert_allclose(bodies.motions(None).contact.force, pushed)


def test_components_do_not_repel_each_other():
    it = run(scene(pair(length=0.102, angular_velocity=3.0), contact=LAW | {"range": 0.05}))
    assert len(it.state.contacts.gap) == 0 or it.state.contacts.gap.min() > 0.05
    assert it.bodies["it"].angular_velocity[0] == pytest.approx(3.0, rel=1e-12)
    assert it.bodies["it.left"].gap == pytest.approx(0.002)


def test_buoyancy_turns_what_is_heavy_at_one_end():
    table = pair(ratio=4.0, angle=0.0)
    it = run(scene(table, density=1.5, gravity=[0.0, -9.81], end=0.2, step=1e-3))
    lever = it.system.motions.kinematics(it.system.motions.pose, 0.0).arm[:, 0]
    torque = lever @ it.system.weight[:, 1]
    expected = torque / it.system.motions.inertia(0.0)[0, 0, 0]
    early = run(scene(table, density=1.5, gravity=[0.0, -9.81], end=0.01, step=1e-3))
    assert early.bodies["it"].angular_velocity[0] == pytest.approx(0.01 * expected, rel=1e-3)
    assert it.bodies["it"].angular_velocity[0] < -1.0
    assert abs(it.state.ledger.relative_residual) < 1e-4


@pytest.mark.long
def test_relative_motion_keeps_the_angular_momentum_and_the_ledger_has_its_work():
    errors, ends = [], []
    for steps in (50, 100, 200):
        table = pair("stroke", 3, stroke=0.1, ratio=3.0, angular_velocity=[7.0, 3.0, -2.0])
        it = Simulation(scene(table, end=0.5, step=0.5 / steps))
        before = angular_momentum(it)
        it.go()
        np.testing.assert_allclose(angular_momentum(it), before, atol=1e-12 * np.abs(before).max())
        errors.append(abs(it.state.ledger.relative_residual))
        ends.append(it.bodies["it"].orientation)
    assert abs(it.state.ledger.control) > 100.0 * errors[-1] * it.state.ledger.kinetic
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]
    assert np.linalg.norm(ends[2] - ends[1]) < 0.3 * np.linalg.norm(ends[1] - ends[0])


@pytest.mark.long
@pytest.mark.parametrize("stepping", [pytest.param("substeps", marks=pytest.mark.nightly), "implicit"])
def test_one_that_pushes_itself_off_the_walls_takes_the_energy_from_its_drive(stepping):
    table = pair("stroke", length=0.7, stroke=0.2, position=[0.52, 0.5], angle=0.1)
    law = {"law": "normal", "range": 0.01, "epsilon": 1e-6, "stepping": stepping}
    it = Simulation(scene(table, contact=law, step=1e-3, end=0.5))
    it.observe(assert_evaluated)
    it.go()
    account = energy_account(it.history.energy)
    assert it.history.bodies["cfx"].any()
    assert it.state.ledger.kinetic > 1e-3
    assert account.created < 0.01
    assert account.lost < 0.01


def test_a_saved_run_goes_on_with_the_same_bits(tmp_path):
    given = wet(pair("stroke", stroke=0.05, angle=0.4), end=0.04, step=0.005, every=0.02, gravity=[0.0, -9.81])
    whole = rigidfluid.run(given, tmp_path / "whole")
    rigidfluid.run(scene_from_dict(given.to_dict() | {"time": {"end": 0.02, "step": 0.005}}), tmp_path / "resumed")
    rigidfluid.run(given, tmp_path / "resumed", resume=True)
    assert whole.summary["steps"] > 4
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "resumed" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_table_has_rows_of_components_and_of_the_whole():
    ball = {"name": "ball", "type": "sphere", "radius": 0.05, "density": 1.0, "position": [0.5, 0.8]}
    history = rigidfluid.run(wet(pair(density=3.0), body=[ball], gravity=[0.0, -9.81], end=0.02, step=0.005))
    table = history.bodies
    assert table["body"][:4].tolist() == ["ball", "it.left", "it.right", "it"]
    rows = {
        name: {key: table[key][table["body"] == name] for key in ("x", "fy", "t", "gap")} for name in set(table["body"])
    }
    left, right, whole = rows["it.left"], rows["it.right"], rows["it"]
    np.testing.assert_allclose(whole["x"], 0.5 * (left["x"] + right["x"]))
    np.testing.assert_allclose(whole["fy"], left["fy"] + right["fy"])
    np.testing.assert_array_equal(whole["gap"], np.minimum(left["gap"], right["gap"]))
    assert left["fy"][-1] > 0.0
    assert json.loads(json.dumps(history.summary))["scene"]["mechanism"][0]["type"] == "dumbbell"


def test_a_mechanism_of_one_component_is_that_body():
    shape = {
        "type": "ellipsoid",
        "semi_axes": [0.8 * 0.1, 1.6 * 0.1],
        "density": 3.0,
        "position": [0.4, 0.55],
        "angle": 0.3,
    }
    keys = {"gravity": [0.0, -9.81], "end": 0.06, "step": 0.005}
    body = rigidfluid.run(wet(body=[shape], **keys)).bodies
    table = pair("lone", radius=0.1, density=2.0, ratio=1.5, position=[0.4, 0.55], angle=0.3)
    component = rigidfluid.run(wet(table, **keys)).bodies
    mine = component["body"] == "it.right"
    for column in ("x", "y", "angle", "vx", "vy", "w", "fx", "fy", "t"):
        np.testing.assert_allclose(component[column][mine], body[column], rtol=0, atol=1e-8, err_msg=column)
    assert abs(body["w"][-1]) > 1e-3


def test_one_that_falls_in_a_fluid_keeps_its_shape_and_the_balance_of_energy():
    table = pair("hammer", radius=0.1, length=0.8, density=1.3, ratio=1.5, position=[1.0, 2.0], angle=0.3)
    it = run(wet(table, gravity=[0.0, -981.0], end=0.15, step=0.005, upper=[2.0, 3.0], size_body=0.04))
    assert apart(it) == pytest.approx(0.8, rel=1e-14)
    assert it.bodies["it"].velocity[1] < -3.0
    assert abs(it.bodies["it"].angular_velocity[0]) > 0.1
    account = energy_account(it.history.energy)
    assert account.created < 1e-6
    assert account.lost < 0.01


def remaining_wrench(it, twists, weight):
    """Of the whole: what its BDF2 momentum lacks of fluid and weight, over the fluid's wrench, after equal steps."""
    d0, d1, d2 = derivative_weights(it.state.past_step, it.state.past_step)
    system, free = it.system, it.state.motions
    rate = d0 * twists[-1] + d1 * twists[-2] + d2 * twists[-3]
    by_fluid = np.append(free.hydrodynamic.force[0], free.hydrodynamic.torque[0])
    return np.abs(rate - weight - by_fluid).max() / np.abs(by_fluid).max(), system


@pytest.mark.parametrize("model", ["stokes", "navier-stokes"])
def test_newton_and_euler_hold_for_the_whole_with_a_stroke(model):
    """Force- and torque-free but for the fluid: the momentum of all components changes by Gᵀ of its wrench alone."""
    table = pair("stroke", radius=0.1, length=0.5, stroke=0.1, ratio=2.0, position=[1.0, 0.7], angle=0.3)
    it = Simulation(wet(table, model=model, end=0.5, step=0.02, upper=[2.0, 1.4], viscosity=1.0, size_body=0.05))
    momenta = []

    def remember(now):
        mass = now.system.motions.mass[0]
        momenta.append(np.append(mass * now.bodies["it"].velocity, angular_momentum(now)))

    it.observe(remember)
    it.go(0.4)
    lacking, _ = remaining_wrench(it, momenta, 0.0)
    assert lacking < 1e-6
    it.go()
    ledger = it.state.ledger
    assert ledger.control > 0.9 * ledger.dissipation > 0.0
    assert abs(ledger.relative_residual) < 0.03
    assert abs(apart(it) - 0.5) < 1e-12
    assert_evaluated(it)


def test_a_reciprocal_stroke_without_inertia_leads_nowhere():
    table = pair("stroke", radius=0.1, length=0.5, stroke=0.1, density=1e-3, position=[1.0, 0.7], ratio=1.0)
    it = Simulation(wet(table, model="stokes", end=1.0, step=0.02, upper=[2.0, 1.4], viscosity=1.0, size_body=0.05))
    way = []
    it.observe(lambda now: way.append(now.bodies["it.left"].position - [0.75, 0.7]))
    it.go()
    assert np.abs(way).max() > 0.03
    assert np.abs(it.bodies["it"].position - [1.0, 0.7]).max() < 2e-3


@pytest.mark.long
@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_a_contact_in_the_fluid_turns_the_whole(stepping):
    table = pair(radius=0.1, length=0.8, density=3.0, position=[1.0, 0.5], angle=0.4)
    contact = {"law": "centre", "range": 0.02, "epsilon": 1e-5, "stepping": stepping}
    keys = {"end": 0.06, "step": 0.004, "upper": [2.0, 1.2], "size_body": 0.04, "gravity": [0.0, -981.0]}
    it, known = Simulation(wet(table, contact=contact, **keys)), set()
    it.observe(lambda now: known.update(now.state.coupling.model.velocities.tolist() if now.state.coupling else []))
    it.go()
    assert known == {0, 1, 2}
    bodies = it.history.bodies
    spin, pushed = bodies["w"][bodies["body"] == "it"], bodies["cfy"][bodies["body"] == "it.left"]
    assert pushed.max() > 5.0
    assert spin.min() < 2.5 * spin[int(np.argmax(pushed > 0.0)) - 1] < 0.0
    assert apart(it) == pytest.approx(0.8, rel=1e-14)
    account = energy_account(it.history.energy)
    assert account.created < 0.02
    assert account.lost < 0.1


@pytest.mark.long
def test_three_dimensions_in_a_fluid():
    table = pair("hammer", 3, radius=0.1, length=0.4, density=2.0, ratio=1.5, angular_velocity=[1.0, 0.5, 2.0])
    it = run(wet(table, gravity=[0.0, 0.0, -9.81], end=0.02, step=0.01, size_body=0.08))
    assert apart(it) == pytest.approx(0.4, rel=1e-14)
    assert it.bodies["it"].velocity[2] < -0.05
    assert it.bodies["it"].force[2] > 0.0


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"type": "dumbell"}, PluginError, r"mechanism.0.type.*Did you mean 'dumbbell'"),
        ({"raduis": 1.0}, SceneError, r"mechanism.0.raduis.*Did you mean 'radius'"),
        ({"radius": -1.0}, SceneError, r"mechanism.0.radius.*greater than 0"),
        ({"velocity": [0.5]}, SceneError, r"mechanism.0.velocity.*2 numbers"),
        ({"orientation": [1.0, 0.0, 0.0, 0.0]}, SceneError, r"mechanism.0.orientation.*no quaternion in 2D"),
        ({"fixed": True}, SceneError, r"mechanism.0.fixed.*nothing reads"),
        ({"name": "left"}, SceneError, r"mechanism.name.*'left'"),
    ],
)
def test_what_a_table_may_not_say_is_refused(change, error, message):
    with pytest.raises(error, match=message):
        scene(pair() | change)


def test_components_are_looked_at_as_bodies_before_a_run():
    found = check(wet(pair(density=2.0), contact=LAW, gravity=[0.0, -9.81]))
    assert [(body.name, body.type) for body in found.bodies] == [("it.left", "sphere"), ("it.right", "sphere")]
    parts = next(feature for feature in found.features if "repel each other" in feature.name)
    assert parts.on


def test_what_meets_a_wall_is_as_heavy_as_the_whole():
    one, other = (build_system(scene(pair(ratio=ratio), contact=LAW, gravity=[0.0, -9.81])) for ratio in (1.0, 3.0))
    np.testing.assert_allclose(one.loads.mass, one.motions.mass[0])
    np.testing.assert_allclose(other.loads.weight, 2.0 * one.loads.weight)
    assert one.rotational_factor.min() > 0.0


def test_names_of_components_are_taken():
    ball = {"name": "it.left", "type": "sphere", "radius": 0.05, "density": 1.0, "position": [0.5, 0.9]}
    with pytest.raises(SceneError, match=r"mechanism.name.*'it.left'"):
        scene(pair(), body=[ball])


def test_two_of_one_name_are_refused():
    one = pair(position=[0.5, 0.3])
    with pytest.raises(SceneError, match=r"mechanism\.1\.name: found .it.; .* no other body"):
        scene(one, one | {"position": [0.5, 0.7]})


def test_components_that_overlap_are_refused_by_the_name_of_the_mechanism():
    with pytest.raises(SceneError, match=r"mechanism 'it'.*overlaps body 'it.right'"):
        build_system(scene(pair(length=0.09)))


def test_a_scene_without_anything_that_moves_is_refused():
    tables = scene(pair()).to_dict()
    del tables["mechanism"]
    with pytest.raises(SceneError, match=r"body.*a body or a mechanism"):
        scene_from_dict(tables)


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (
            ("np.zeros((2, self.dimension))", "np.zeros((2, 4))"),
            r"'odd', placement: found position .* of shape \(2, 4\); allowed is .* of shape \(2, 3\)",
        ),
        (('"left", "right"', '"left", "left"'), r"\.0.*a name of its own"),
        (
            ("ratio * self.options.density", "-1.0"),
            "'odd', components: found density of 'left' -1.0; allowed is a number above 0",
        ),
        (
            ("[1.0, 0.0, 0.0, 0.0]", "[1.1, 0.0, 0.0, 0.0]"),
            "'odd', placement: found quaternions .*; allowed is quaternions of length 1",
        ),
        (("    driven = True\n", ""), "'odd_stroke', rate: found a rate of what is not driven"),
    ],
)
def test_what_a_mechanism_may_not_say_is_its_authors_error(install, fault, message):
    code = Path(mechanism_parts.__file__).read_text(encoding="utf-8").replace('"dumbbell"', '"odd"')
    code = code.replace('"stroke"', '"odd_stroke"').replace(
        "return [Dumbbell, Hammer, Ellipse, Stroke]", "return [Dumbbell, Stroke]"
    )
    install(code.replace(*fault), name="odd", module="odd_mechanism")
    with pytest.raises(PluginError, match=rf"mechanism ?{message}"):
        scene(pair("odd_stroke" if "driven" in fault[0] else "odd", 3, stroke=0.1))


def test_a_drive_that_only_starts_is_foreseen_in_a_fluid():
    """A pair at the turning point of its stroke, just beyond the range: its speed is none, its acceleration is not."""
    table = pair("stroke", radius=0.05, length=0.4, stroke=0.1, position=[0.5, 0.5])
    it = Simulation(wet(table, contact=LAW | {"law": "normal"}, end=1.0, step=0.01))
    quarter, size = 0.25, 0.01
    rates = body_accelerations(it.system, it.state, quarter, size)
    centripetal = -0.1 * (2.0 * np.pi) ** 2
    share = it.system.mass[0] / it.system.mass.sum()
    assert rates[1, 0] - rates[0, 0] == pytest.approx(centripetal, rel=0.01)
    assert rates[1, 0] == pytest.approx(share * centripetal, rel=0.01)
