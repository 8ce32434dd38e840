"""Two dipoles fixed in their bodies: forces, oscillation, energy and momentum, contacts, a fluid, and wrong tables."""

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from ended_runs import run_to_end

from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.pose_law import PairPoses
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run.run import run
from rigidfluid.errors import SceneError
from rigidfluid.forces.dipole import DipoleLaw, DipoleOptions

STRENGTH, RADIUS, DISTANCE = 1e-6, 0.1, 0.3
MASS, INERTIA = {2: np.pi * RADIUS**2, 3: 4.0 / 3.0 * np.pi * RADIUS**3}, {2: 0.5, 3: 0.4}


def dipole(dimension, **keys):
    moments = [[1.0, *[0.0] * (dimension - 1)]] * 2
    return {"law": "dipole", "range": 2.0, "names": ["a", "b"], "strength": STRENGTH, "moments": moments} | keys


def two_balls(dimension, *laws, end, step=5e-3, a=(), b=(), distance=DISTANCE):
    """Ball b, and ball a at a ``distance`` along x."""
    left, right = ([0.5 + sign * 0.5 * distance, *[0.5] * (dimension - 1)] for sign in (-1.0, 1.0))
    bodies = [ball(right, [], name="a", **dict(a)), ball(left, [], name="b", **dict(b))]
    for body in bodies:
        del body["velocity"]
    data = dry_scene({}, *bodies, end=end, step=step).to_dict()
    return scene_from_dict(data | {"contact": {}, "interaction": list(laws)})


def tilted(dimension, angle):
    """Moments along x, that of a in its body turned by an angle."""
    turned = [np.cos(angle), np.sin(angle), *[0.0] * (dimension - 2)]
    return [turned, [1.0, *[0.0] * (dimension - 1)]]


@pytest.mark.parametrize(
    ("moments", "force"),
    [([[1, 0], [1, 0]], [-6.0, 0.0]), ([[0, 1], [0, 1]], [3.0, 0.0]), ([[0, 1], [1, 0]], [0.0, 3.0])],
    ids=["head to tail", "side by side", "crossed"],
)
def test_forces_of_known_arrangements(moments, force):
    """-6 k m²/r⁴ head to tail, 3 k m²/r⁴ side by side, and across the line of centres if crossed."""
    law, r = DipoleLaw(DipoleOptions(strength=STRENGTH, moments=moments), 2.0), 0.4
    pairs = PairPoses(np.array([[r, 0.0]]), np.eye(2)[None], np.eye(2)[None])
    np.testing.assert_allclose(law.pair_force(pairs)[0], STRENGTH / r**4 * np.array(force), atol=1e-18)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_tilted_dipole_swings_with_its_period(dimension):
    """Beside a fixed one, in its place: I θ'' = -2 k m² sin θ/r³."""
    frequency = np.sqrt(2.0 * STRENGTH / (DISTANCE**3 * INERTIA[dimension] * MASS[dimension] * RADIUS**2))
    period, angle = 2.0 * np.pi / frequency, 0.02
    place = {"free": ["rotation"] if dimension == 2 else ["rx", "ry", "rz"]}
    law = dipole(dimension, moments=tilted(dimension, angle))
    half, whole = (
        run_to_end(two_balls(dimension, law, end=time, step=period / 200, a=place, b={"fixed": True}))
        for time in (0.5 * period, period)
    )
    angles = [
        2.0 * np.arcsin(s.pose.orientation[0, -1]) if dimension == 3 else s.pose.orientation[0, 0]
        for s in (half, whole)
    ]
    assert angles[0] == pytest.approx(-2.0 * angle, rel=1e-3)
    assert angles[1] == pytest.approx(0.0, abs=1e-3 * angle)


@pytest.mark.parametrize("dimension", [2, 3])
def test_free_dipoles_keep_energy_momentum_and_angular_momentum(dimension):
    """While they attract each other and turn, in steps of which half as long ones err by a quarter."""
    law, spin = dipole(dimension, moments=tilted(dimension, 0.8)), [0.3] if dimension == 2 else [0.1, 0.2, -0.3]
    errors = []
    for step in (1e-2, 5e-3):
        state = run_to_end(
            two_balls(
                dimension,
                law,
                end={2: 0.8, 3: 0.4}[dimension],
                step=step,
                a={"angular_velocity": spin if dimension == 3 else 0.3},
            )
        )
        ledger, twist, mass = state.ledger, state.twist, MASS[dimension]
        errors.append(abs(ledger.residual))
        assert state.count == round({2: 0.8, 3: 0.4}[dimension] / step)
        assert abs(ledger.contact - ledger.initial) > 0.1 * abs(ledger.initial)
        np.testing.assert_allclose(mass * twist.velocity.sum(axis=0), 0.0, atol=1e-17)
        inertia = INERTIA[dimension] * mass * RADIUS**2
        turning = moment(state.pose.position - 0.5, mass * twist.velocity) + inertia * twist.angular_velocity
        np.testing.assert_allclose(turning.sum(axis=0), inertia * np.array(spin), atol=1e-14 * inertia)
    assert errors[1] < 1e-5 * abs(ledger.initial)
    assert errors[1] < 0.3 * errors[0]


def test_dipoles_that_attract_bounce_off_a_contact_that_repels_and_come_back():
    law, shell = dipole(2), {"law": "normal", "range": 0.02, "epsilon": 2e-4}
    history = run(two_balls(2, law, shell, end=1.3, step=5e-3, distance=0.24))
    distance = history.bodies["x"][::2] - history.bodies["x"][1::2]
    assert 0.2 < distance.min() < 0.22
    assert distance[len(distance) // 4 :].max() == pytest.approx(0.24, abs=2e-4)
    assert np.abs(history.energy["residual"]).max() < 1e-4 * abs(history.energy["contact"][0])


def test_a_third_body_feels_nothing():
    scene = two_balls(2, dipole(2), end=0.1)
    data = scene.to_dict()
    data["body"] = [*data["body"], ball([0.5, 0.8], [0.0, 0.0], name="c")]
    state = run_to_end(scene_from_dict(data))
    assert not state.twist.velocity[2].any()
    assert state.twist.velocity[:2].any()


def test_implicit_steps_of_contacts_leave_the_force_in_place():
    shell = {"law": "normal", "range": 0.02, "epsilon": 2e-4}
    scene = two_balls(2, dipole(2), shell, end=1.0, step=5e-3, distance=0.24)
    implicit = scene_from_dict(scene.to_dict() | {"contact": {"stepping": "implicit"}})
    one, other = run_to_end(scene), run_to_end(implicit)
    np.testing.assert_allclose(one.pose.position, other.pose.position, atol=1e-4)
    assert abs(other.ledger.residual) < 1e-4 * abs(other.ledger.initial)


def test_a_run_resumed_goes_on_with_the_same_bits(tmp_path):
    def scene(end):
        law = dipole(2, moments=tilted(2, 0.8))
        return scene_from_dict(two_balls(2, law, end=end).to_dict() | {"output": {"every": 0.1}})

    run(scene(0.2), tmp_path / "whole")
    run(scene(0.1), tmp_path / "resumed")
    run(scene(0.2), tmp_path / "resumed", resume=True)
    whole, resumed = (read_checkpoint(tmp_path / name / "state.h5").state for name in ("whole", "resumed"))
    np.testing.assert_array_equal(whole.pose.position, resumed.pose.position)
    np.testing.assert_array_equal(whole.pose.orientation, resumed.pose.orientation)
    assert whole.ledger == resumed.ledger


def test_a_check_goes_through():
    report = check(two_balls(2, dipole(2), end=0.1))
    assert not [finding for finding in report.findings if finding.grade == "error"]


@pytest.mark.parametrize(
    ("keys", "subject"),
    [
        ({"names": ["a"]}, "interaction.0.names"),
        ({"names": None}, "interaction.0.names"),
        ({"names": ["a", "c"]}, "interaction.0.names.1"),
        ({"names": ["a", "bottom"]}, "interaction.0.names.1"),
        ({"names": ["a", "a"]}, "interaction.0.names"),
        ({"moments": [[1.0, 0.0], [1.0, 0.0, 0.0]]}, "interaction.0.moments.1"),
        ({"moments": [[0.0, 0.0], [1.0, 0.0]]}, "interaction.0.moments.0"),
        ({"strength": 0.0}, "interaction.0.strength"),
        ({"friction": 0.3}, "interaction.0.friction"),
        ({"between": "walls"}, "interaction.0.between"),
        ({"epsilon": 1.0}, "interaction.0.epsilon"),
    ],
)
def test_tables_that_make_no_dipoles_are_refused(keys, subject):
    with pytest.raises(SceneError) as caught:
        build_system(two_balls(2, dipole(2, **keys), end=0.1))
    assert caught.value.subject == subject


def test_it_is_refused_for_all_contacts():
    data = two_balls(2, end=0.1).to_dict()
    law = dipole(2)
    del law["names"]
    with pytest.raises(SceneError, match="the names of two bodies") as caught:
        build_system(scene_from_dict(data | {"contact": law}))
    assert caught.value.subject == "contact.names"


def test_steps_that_do_not_resolve_it_are_refused():
    with pytest.raises(SceneError, match="weaken the spring or long-range force"):
        build_system(two_balls(2, dipole(2, strength=1.0), end=0.1, step=0.05))
