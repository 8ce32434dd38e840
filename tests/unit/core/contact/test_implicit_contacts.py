"""One implicit step through contacts: energy at any stiffness, order, several contacts, dampers, what it refuses."""

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from facet_shapes import CUBE, TRIANGLES, binary_stl
from scipy.integrate import quad
from touching import contact

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.laws.repulsion import RepulsionOptions
from rigidfluid.core.contact.pairs.tracked_pairs import TrackedPairs
from rigidfluid.core.contact.path import implicit_contacts
from rigidfluid.core.contact.path.contact_newton import discrete_gradient
from rigidfluid.core.mechanics.wrenches import contact_wrench
from rigidfluid.core.model.types import Pose, Wrench
from rigidfluid.errors import SceneError, StepError, StepRejected
from rigidfluid.forces.barrier import BarrierLaw
from rigidfluid.forces.centre import CentreLaw
from rigidfluid.forces.normal import NormalLaw

RANGE = 0.02
MASS = np.pi * 0.1**2


def implicit(contact, *bodies, end, step, **gravity):
    return dry_scene({"range": RANGE, "stepping": "implicit"} | contact, *bodies, end=end, step=step, **gravity)


def spring(stiffness, **keys):
    return {"law": "spring-dashpot", "stiffness": stiffness} | keys


def test_forces_beyond_all_proportion_are_refused_by_name():
    """The matrix of one contact is singular by rounding."""
    law = {"law": "centre", "range": 0.5, "epsilon": 1e-29}
    scene = implicit(law, ball([0.5, 0.3], [0.0, 0.0]), end=0.1, step=0.01, gravity=[0.0, -1.0])
    with pytest.raises(StepError, match=r"the implicit contact step at time 0: found forces whose change"):
        rigidfluid.run(scene)


@pytest.mark.parametrize("law", [CentreLaw, NormalLaw, BarrierLaw])
@pytest.mark.parametrize("end", [1e-3, 0.0099, 0.01 + 1e-8, 0.01, 0.019, 0.5])
def test_the_discrete_gradient_is_the_mean_force(law, end):
    start = contact(0.01, radius_a=0.1, radius_b=0.1)
    made = law(RepulsionOptions(epsilon=1e-6), RANGE)

    def force(gap):
        return float(np.sum(made.force(contact(gap, radius_a=0.1, radius_b=0.1)) * start.normal))

    mean = force(0.01) if end == 0.01 else quad(force, 0.01, min(end, RANGE), epsrel=1e-11)[0] / (end - 0.01)
    found, slope = discrete_gradient(made, start, np.array([end]))
    assert found[0] == pytest.approx(mean, rel=1e-7)
    change = 1e-4 * end
    around = [discrete_gradient(made, start, np.array([end + sign * change]))[0][0] for sign in (-1, 1)]
    assert slope[0] == pytest.approx((around[0] - around[1]) / (2 * change), rel=1e-3)


@pytest.mark.parametrize(("turn", "step"), [(0.1, 2e-4), (1.0, 2e-3), (10.0, 0.01), (100.0, 0.01), (1000.0, 0.01)])
def test_a_wall_gives_all_speed_back_at_any_stiffness(turn, step):
    """``turn`` is ω Δt."""
    disk = ball([0.5, 0.5], [0.0, -3.0])
    history = rigidfluid.run(implicit(spring(MASS * (turn / step) ** 2), disk, end=0.26, step=step))
    assert history.bodies["vy"][-1] == pytest.approx(3.0, rel=1e-10)
    assert history.summary["rejected_steps"] == 0
    assert history.bodies["gap"].min() > 0.0


@pytest.mark.parametrize("law", ["centre", "normal", "barrier"])
@pytest.mark.parametrize("epsilon", [1e-6, 1e-9, 1e-13])
def test_so_do_all_laws(law, epsilon):
    disk = ball([0.5, 0.5], [0.0, -3.0])
    bodies = rigidfluid.run(implicit({"law": law, "epsilon": epsilon}, disk, end=0.3, step=0.05)).bodies
    assert bodies["vy"][-1] == pytest.approx(3.0, rel=1e-9)
    assert bodies["gap"].min() > 0.0


def test_second_order_where_steps_resolve_the_contact():
    disk = ball([0.5, 0.16], [0.5, -1.0])
    scenes = [implicit({"law": "normal", "epsilon": 2e-5}, disk, end=0.1, step=0.004 / 2**k) for k in range(5)]
    heights = [rigidfluid.run(scene).bodies["y"][-1] for scene in scenes]
    differences = np.abs(np.diff(heights))
    assert np.all(np.log2(differences[:-1] / differences[1:])[1:] > 1.8)


@pytest.mark.parametrize("epsilon", [1e-6, 1e-10])
@pytest.mark.parametrize("step", [0.05, 0.001])
def test_two_that_meet_off_centre_keep_momentum_energy_and_do_not_spin(step, epsilon):
    left, right = ball([0.3, 0.5], [2.0, 0.0]), ball([0.6, 0.58], [-1.0, 0.0], density=3.0)
    bodies = rigidfluid.run(implicit({"law": "centre", "epsilon": epsilon}, left, right, end=0.15, step=step)).bodies
    mass = np.array([1.0, 3.0])
    for column, total in (("vx", -1.0), ("vy", 0.0)):
        np.testing.assert_allclose(bodies[column].reshape(-1, 2) @ mass, total, atol=1e-12)
    kinetic = (bodies["vx"][-2:] ** 2 + bodies["vy"][-2:] ** 2) @ mass
    assert kinetic == pytest.approx(4.0 + 3.0, rel=1e-8)
    assert abs(bodies["vy"][-2]) > 0.5
    np.testing.assert_allclose(bodies["w"], 0.0, atol=1e-12)


@pytest.mark.parametrize("most_dense", [0, 200])
@pytest.mark.parametrize("step", [0.01, 0.001])
def test_a_stack_keeps_its_energy(monkeypatch, step, most_dense):
    """Every contact responds to the others; with sparse matrices and with full ones."""
    monkeypatch.setattr(implicit_contacts, "MOST_DENSE", most_dense)
    stack = [ball([0.5 + 0.01 * k, 0.125 + 0.225 * k], [0.0, 0.0], density=1.0 + 10.0 * k) for k in range(4)]
    scene = implicit({"law": "barrier", "epsilon": 1e-7}, *stack, end=0.4, step=step, gravity=[0.0, -5.0])
    history = rigidfluid.run(scene)
    assert history.summary["rejected_steps"] == 0
    assert history.bodies["gap"].min() > 0.0
    assert history.bodies["gap"].min() < RANGE
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-7


def tilted(step, epsilon=1e-9):
    disk = {"type": "ellipsoid", "semi_axes": [0.1, 0.05], "angle": 0.6, "density": 1.0, "position": [0.5, 0.3]}
    scene = implicit({"law": "normal", "epsilon": epsilon}, disk, end=0.45, step=step, gravity=[0.0, -10.0])
    history = rigidfluid.run(scene)
    assert np.abs(history.bodies["w"]).max() > 5.0
    return abs(history.summary["energy"]["relative_residual"])


@pytest.mark.parametrize("step", [0.01, 0.001])
def test_a_tilted_ellipse_keeps_its_energy_where_steps_do_not_resolve_the_contact(step):
    assert tilted(step) < 1e-6


@pytest.mark.long
def test_a_torque_of_the_wrong_sign_would_be_seen(monkeypatch):
    def flipped(*arguments):
        wrench = contact_wrench(*arguments)
        return Wrench(wrench.force, -wrench.torque)

    monkeypatch.setattr(implicit_contacts, "contact_wrench", flipped)
    try:
        residual = tilted(0.001)
    except StepError:
        return
    assert residual > 0.01


def test_an_ellipsoid_that_turns_about_any_axis_keeps_its_energy():
    body = {"type": "ellipsoid", "semi_axes": [0.1, 0.06, 0.04], "density": 1.0, "position": [0.5, 0.5, 0.15]}
    body |= {"angular_velocity": [3.0, 1.0, 2.0]}
    law = {"law": "normal", "epsilon": 1e-6}
    history = rigidfluid.run(implicit(law, body, end=0.3, step=4e-3, gravity=[0.0, 0.0, -5.0]))
    assert np.ptp(history.bodies["wy"]) > 3.0
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-7


@pytest.mark.parametrize("restitution", [0.7, 0.2])
def test_a_dashpot_takes_what_the_restitution_says_where_steps_resolve_it(restitution):
    """ω Δt is .02."""
    disk = ball([0.5, 0.15], [0.0, -3.0])
    history = rigidfluid.run(implicit(spring(1e4, restitution=restitution), disk, end=0.04, step=4e-5))
    assert history.bodies["vy"][-1] == pytest.approx(restitution * 3.0, rel=0.02)
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-9
    assert history.summary["energy"]["contact_loss"] > 0.0


@pytest.mark.parametrize("step", [0.02, 0.002, 2e-4])
def test_friction_only_takes_energy(step):
    disk = ball([0.3, 0.2], [2.0, -1.0])
    contact_ = spring(1e4, restitution=0.7, friction=0.5)
    history = rigidfluid.run(implicit(contact_, disk, end=0.2, step=step, gravity=[0.0, -3.0]))
    loss = history.energy["contact_loss"]
    assert np.all(np.diff(loss) >= 0.0)
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-9


def test_a_driven_body_pushes_and_takes_no_push():
    piston = ball([0.3, 0.5], [0.0, 0.0], prescribed={"velocity": [1.0, 0.0]})
    del piston["velocity"]
    pushed = ball([0.55, 0.5], [0.0, 0.0])
    history = rigidfluid.run(implicit({"law": "centre", "epsilon": 1e-7}, piston, pushed, end=0.12, step=0.01))
    np.testing.assert_allclose(history.bodies["vx"][-2:], [1.0, 2.0], rtol=1e-9)
    assert history.summary["energy"]["control"] == pytest.approx(0.5 * MASS * 4.0, rel=1e-9)


@pytest.mark.parametrize("stepping", [{"stepping": "implicit"}, {"stepping": "substeps"}])
def test_what_turns_a_paddle_works_against_its_contacts(stepping):
    """All that the ball has in the end came by the drive, which turns and does not move."""
    paddle = {"type": "ellipsoid", "semi_axes": [0.15, 0.04], "prescribed": {"angular_velocity": 20.0}}
    paddle |= {"position": [0.4, 0.5], "density": 1.0}
    struck = ball([0.5, 0.66], [0.0, 0.0])
    history = rigidfluid.run(
        implicit({"law": "normal", "epsilon": 1e-6} | stepping, paddle, struck, end=0.05, step=1e-3)
    )
    energy = history.energy
    assert energy["kinetic"][-1] > 1e-3
    assert energy["control"][-1] == pytest.approx(energy["kinetic"][-1] + energy["contact"][-1], rel=1e-3)


def test_a_pair_that_was_not_foreseen_rejects_the_step():
    pair = [ball([x, 0.5], [0.0, 0.0]) for x in (0.25, 0.75)]
    system = build_system(implicit(spring(1e4), *pair, end=0.1, step=0.01))
    contacts = TrackedPairs(system, system.pose, reach=0.16)
    assert contacts.start.gap == pytest.approx([0.15, 0.15])

    def right_at(x):
        return Pose(np.array([[0.25, 0.5], [x, 0.5]]), system.pose.orientation)

    assert contacts.extrapolate(right_at(0.5)).gap == pytest.approx([0.15, 0.4])
    with pytest.raises(StepRejected, match=r"body body0.*contact with body1"):
        contacts.extrapolate(right_at(0.46))


def test_edges_that_begin_to_pass_within_a_step_are_foreseen_with_their_pair(tmp_path):
    """A small cube slides over the edge of a large one; the edges' contacts of sign -1 are not there before."""
    file = str(binary_stl(tmp_path / "cube.stl", CUBE - 0.5, TRIANGLES))
    large, small = ({"type": "stl", "file": file, "scale": scale, "density": 1.0} for scale in (1.0, 0.4))
    large, small = large | {"position": [1.0, 1.0, 0.51]}, small | {"position": [1.29, 1.0, 1.225]}
    law = {"law": "normal", "range": RANGE, "epsilon": 1e-6}
    system = build_system(dry_scene(law, large, small, end=0.1, step=0.01, upper=[2.0] * 3))
    contacts = TrackedPairs(system, system.pose, reach=0.03)
    assert np.all(contacts.start.sign > 0.0)
    over = system.pose.position + np.array([[0.0] * 3, [0.02, 0.0, 0.0]])
    there = contacts.extrapolate(Pose(over, system.pose.orientation))
    np.testing.assert_array_equal(there.body_b, contacts.start.body_b)


def test_a_law_that_is_too_weak_is_said_to_be():
    disk = ball([0.5, 0.5], [0.0, -3.0])
    with pytest.raises(StepError, match="Strengthen the contact force"):
        rigidfluid.run(implicit({"law": "centre", "epsilon": 1e-4}, disk, end=0.3, step=0.01))


def test_substeps_have_no_place_beside_it():
    data = implicit(spring(1e4), ball([0.5, 0.5], [0.0, 0.0]), end=0.1, step=0.01).to_dict()
    data["contact"]["substeps"] = 4
    with pytest.raises(SceneError, match=r"contact\.substeps"):
        scene_from_dict(data)
