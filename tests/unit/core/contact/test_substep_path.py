"""Bodies through contacts without a fluid: what the closed forms say, stiff laws, long steps, dampers."""

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.path import contact_load
from rigidfluid.core.contact.path.substep_path import SubstepPath
from rigidfluid.core.mechanics.wrenches import contact_wrench
from rigidfluid.core.model.types import Wrench
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import StepError

RADIUS, RANGE, SPEED = 0.1, 0.02, 3.0
MASS = np.pi * RADIUS**2
DISK = {"type": "sphere", "radius": RADIUS, "density": 1.0, "position": [0.5, 0.5], "velocity": [0.0, -SPEED]}


def dry(*bodies, step, end, gravity=0.0, **contact):
    return scene_from_dict(
        {
            "scene": {"name": "dry", "dimension": 2},
            "fluid": {"backend": "dry", "gravity": [0.0, -gravity]},
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
            "body": [DISK | body for body in bodies],
            "contact": {"law": "centre", "range": RANGE, "epsilon": 1e-6} | contact,
            "time": {"step": step, "end": end},
            "output": {"every": end},
        }
    )


def energy(bodies, mass, inertia, gravity=0.0):
    moving = 0.5 * mass * (bodies["vx"] ** 2 + bodies["vy"] ** 2) + 0.5 * inertia * bodies["w"] ** 2
    return moving + mass * gravity * bodies["y"]


def test_a_wall_gives_all_speed_back():
    bodies = rigidfluid.run(dry({}, step=0.02, end=0.26, substeps=1000)).bodies
    assert bodies["vy"][-1] == pytest.approx(SPEED, rel=1e-6)


@pytest.mark.long
def test_a_shallow_contact_lasts_as_long_as_the_formula_says():
    """T_c = 2.80436 w_m/v₀ with w_m = (3 ε m v₀²/[2 (R + range)])^(1/3), R = 2r at a wall."""
    speed, epsilon = 0.01, 1e-5
    deepest = (3 * epsilon * MASS * speed**2 / (2 * (2 * RADIUS + RANGE))) ** (1 / 3)
    assert deepest < 0.05 * RANGE
    start = {"position": [0.5, RADIUS + RANGE], "velocity": [0.0, -speed]}
    time = 2.80436 * deepest / speed
    bodies = rigidfluid.run(dry(start, step=time / 2000, end=1.2 * time, epsilon=epsilon, substeps=1)).bodies
    inside = bodies["gap"] < RANGE
    assert np.count_nonzero(inside) * time / 2000 == pytest.approx(time, rel=0.002)
    assert RANGE - bodies["gap"].min() == pytest.approx(deepest, rel=0.01)


def test_what_a_body_pushed_off_from_rest_meets_in_the_same_step_is_seen():
    """It has no speed at the start, and a wall and a held ball to meet in all steps."""
    pressed = {"position": [0.5, RADIUS + 0.2 * RANGE], "velocity": [0.0, 0.0]}
    held = {"position": [0.5, 3.0 * RADIUS + 4.0 * RANGE], "velocity": None, "prescribed": {"velocity": [0.0, 0.0]}}
    held = {key: value for key, value in (DISK | held).items() if value is not None}
    scene = dry(pressed, step=0.1, end=0.4).to_dict()
    history = rigidfluid.run(scene_from_dict(scene | {"body": [scene["body"][0], held]}))
    assert history.summary["rejected_steps"] == 0
    assert history.summary["energy"]["created"] < 1e-3
    assert history.summary["energy"]["lost"] < 1e-3


def test_the_fastest_that_is_stopped():
    """½ m v² = U(0) = range³ (4R + range)/(12 ε), R = 2r."""
    epsilon = 1e-5
    limit = np.sqrt(2 * RANGE**3 * (8 * RADIUS + RANGE) / (12 * epsilon) / MASS)
    slower = dry({"velocity": [0.0, -0.999 * limit]}, step=0.01, end=0.35, epsilon=epsilon, substeps=400)
    assert rigidfluid.run(slower).bodies["vy"][-1] == pytest.approx(0.999 * limit, rel=1e-4)
    remedy = r"body body0.*Strengthen the contact force, or widen its range. What was computed until then is kept.$"
    with pytest.raises(StepError, match=remedy):
        rigidfluid.run(dry({"velocity": [0.0, -1.001 * limit]}, step=0.01, end=0.35, epsilon=epsilon, substeps=400))


def tilted(gravity):
    """Energies of a tilted ellipse that falls on the floor, where it is out of contact."""
    scene = dry({}, step=1e-3, end=0.45, gravity=gravity, law="normal", epsilon=1e-6, substeps=20)
    data = scene.to_dict()
    shape = {"type": "ellipsoid", "semi_axes": [0.1, 0.05], "angle": 0.6, "density": 1.0, "position": [0.5, 0.3]}
    bodies = rigidfluid.run(scene_from_dict(data | {"body": [shape]})).bodies
    mass = np.pi * 0.1 * 0.05
    free = bodies["gap"] > RANGE
    spins = bodies["w"][free]
    return energy(bodies, mass, mass * (0.1**2 + 0.05**2) / 4, gravity)[free], spins


@pytest.mark.long
def test_a_tilted_ellipse_keeps_its_energy():
    energies, spins = tilted(10.0)
    assert np.abs(spins).max() > 5.0
    np.testing.assert_allclose(energies, energies[0], rtol=1e-5)


@pytest.mark.long
def test_a_torque_of_the_wrong_sign_would_be_seen(monkeypatch):
    def flipped(*arguments):
        wrench = contact_wrench(*arguments)
        return Wrench(wrench.force, -wrench.torque)

    monkeypatch.setattr(contact_load, "contact_wrench", flipped)
    try:
        energies, _ = tilted(10.0)
    except StepError:
        return
    assert np.abs(energies / energies[0] - 1.0).max() > 0.1


@pytest.mark.parametrize("law", ["centre", "normal", "barrier"])
@pytest.mark.parametrize("epsilon", [1e-6, 1e-8, 1e-11, 1e-13])
def test_a_long_step_is_divided_as_the_contact_needs(law, epsilon):
    """In one step the disk flies through the range many times over; nothing is tied to √(m/k)."""
    scene = dry({}, step=0.05, end=0.3, law=law, epsilon=epsilon)
    history = rigidfluid.run(scene)
    assert history.summary["rejected_steps"] == 0
    assert history.bodies["vy"][-1] == pytest.approx(SPEED, rel=2e-3)


PAIR = (
    {"position": [0.375, 0.5], "velocity": [2.0, 0.0]},
    {"position": [0.625, 0.58], "velocity": [-1.0, 0.0], "density": 3.0},
)
AT_A_WALL = ({"position": [0.5, 0.15], "velocity": [0.5, -SPEED]},)


@pytest.mark.parametrize("bodies", [PAIR, AT_A_WALL], ids=["pair", "wall"])
@pytest.mark.parametrize(("law", "epsilon"), [("centre", 1e-6), ("normal", 1e-5), ("barrier", 1e-3)])
def test_a_blow_keeps_its_energy_however_many_steps_it_lasts(law, epsilon, bodies):
    """Each step plans its substeps again; they must not change within the blow, or it costs a thousandth."""
    lasted = []
    for step in 0.003 / np.sqrt(2.0) ** np.arange(8):
        history = rigidfluid.run(dry(*bodies, step=step, end=0.06, law=law, epsilon=epsilon))
        lasted.append(np.count_nonzero(history.energy["contact"]))
        assert abs(history.summary["energy"]["relative_residual"]) < 5e-5
    assert min(lasted) <= 5
    assert max(lasted) >= 30


@pytest.mark.parametrize("part", [0.5, 1.0, 2.0])
def test_an_ellipse_does_so_as_well(part):
    shape = {"type": "ellipsoid", "semi_axes": [0.1, 0.05], "angle": 0.6, "density": 1.0}
    shape |= {"position": [0.5, 0.11], "velocity": [0.0, -2.0], "angular_velocity": [3.0]}
    scene = dry({}, step=7.5e-4 * part, end=0.06, law="normal", epsilon=1e-6).to_dict()
    history = rigidfluid.run(scene_from_dict(scene | {"body": [shape]}))
    assert np.count_nonzero(history.energy["contact"]) >= 5
    assert abs(history.summary["energy"]["relative_residual"]) < 1.5e-5


def test_what_flies_apart_needs_ever_fewer_substeps(monkeypatch):
    """The barrier is far stiffer where they start than further out; substeps for that all the way: half a million."""
    counts = []

    def counted(*arguments):
        path = follow(*arguments)
        counts.append(path.substeps)
        return path

    follow = SubstepPath.advance
    monkeypatch.setattr(SubstepPath, "advance", counted)
    pair = [{"position": [x, 0.5], "velocity": [0.0, 0.0]} for x in (0.4 - 5e-8, 0.6 + 5e-8)]
    history = rigidfluid.run(dry(*pair, step=0.01, end=0.02, law="barrier", epsilon=1e-2))
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-4
    assert sum(counts) < 10_000


def test_two_that_meet_swap_their_speeds():
    left = {"position": [0.3, 0.5], "velocity": [2.0, 0.0]}
    right = {"position": [0.6, 0.5], "velocity": [0.0, 0.0]}
    bodies = rigidfluid.run(dry(left, right, step=0.02, end=0.12, substeps=500)).bodies
    np.testing.assert_allclose(bodies["vx"][-2:], [0.0, 2.0], atol=1e-5)


def test_one_far_heavier_is_hardly_moved():
    light = {"position": [0.3, 0.5], "velocity": [2.0, 0.0], "density": 1e-4}
    heavy = {"position": [0.6, 0.5], "velocity": [0.0, 0.0], "density": 1e4}
    bodies = rigidfluid.run(dry(light, heavy, step=0.02, end=0.1, epsilon=1e-9)).bodies
    np.testing.assert_allclose(bodies["vx"][-2:], [-2.0, 4e-8], rtol=2e-3)


@pytest.mark.parametrize("restitution", [1.0, 0.7, 0.2])
def test_a_dashpot_takes_what_the_restitution_says(restitution):
    law = {"law": "spring-dashpot", "stiffness": 1e4, "restitution": restitution}
    scene = dry({}, step=0.02, end=0.26)
    contact = {"range": RANGE, "substeps": 1000} | law
    history = rigidfluid.run(scene_from_dict(scene.to_dict() | {"contact": contact}))
    assert history.bodies["vy"][-1] == pytest.approx(restitution * SPEED, rel=5e-3)
    lost = 0.5 * MASS * SPEED**2 * (1.0 - restitution**2)
    assert history.summary["energy"]["contact_loss"] == pytest.approx(lost, rel=0.02, abs=1e-12)
    assert abs(history.summary["energy"]["relative_residual"]) < 5e-3


def test_a_driven_body_pushes_and_takes_no_push():
    piston = {"position": [0.3, 0.5], "velocity": None, "prescribed": {"velocity": [1.0, 0.0]}}
    ball = {"position": [0.55, 0.5], "velocity": [0.0, 0.0]}
    data = dry({}, step=0.01, end=0.12, epsilon=1e-7).to_dict()
    bodies = [{key: value for key, value in (DISK | body).items() if value is not None} for body in (piston, ball)]
    history = rigidfluid.run(scene_from_dict(data | {"body": bodies}))
    np.testing.assert_allclose(history.bodies["vx"][-2:], [1.0, 2.0], rtol=1e-3)
    np.testing.assert_allclose(history.bodies["x"][::2], 0.3 + history.bodies["time"][::2], atol=1e-12)
    assert history.summary["energy"]["control"] == pytest.approx(0.5 * MASS * 4.0, rel=2e-3)


def test_a_contact_that_no_step_can_follow_is_refused_at_once(monkeypatch):
    """Not after a hundred thousand substeps of each of all shorter steps."""
    asked, detect = [], SphereDetector.detect
    monkeypatch.setattr(SphereDetector, "detect", lambda *given: asked.append(given) or detect(*given))
    scene = dry({}, step=0.01, end=0.1, gravity=10.0, range=0.5, epsilon=1e-25, epsilon_wall=1e-25)
    with pytest.raises(StepError, match=r"body body0 at time 0: found a contact that needs substeps of"):
        rigidfluid.run(scene)
    assert len(asked) < 100


def test_bodies_too_fast_for_contacts_to_be_foreseen_are_refused_at_once():
    """Not after a hundred thousand looks ahead in each halving of the step."""
    with pytest.raises(StepError, match=r"body body0 .* a speed with which contacts can be foreseen for .*") as error:
        rigidfluid.run(dry({}, step=1e-3, end=1.0, gravity=1e30))
    assert "units" in error.value.remedy
