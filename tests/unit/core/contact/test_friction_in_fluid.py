"""Springs along surfaces in a fluid: a disk that must not turn, on a slope that friction holds, and in an impact."""

from functools import cache

import numpy as np
import pytest
from ended_runs import run_to_end

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run.run import run

FRICTION, GRAVITY, RADIUS, RANGE, STIFFNESS = 0.5, 10.0, 0.125, 0.02, 200.0
SPRING = {"tangential_stiffness": 150.0}


def disk_on_slope(end, step=4e-3, output=None, mesh=None, **keys):
    """Gravity is inclined; in the beginning the disk presses with its weight, and nothing holds it yet."""
    angle = np.arctan(0.9 * FRICTION)
    weight = 3.0 * np.pi * RADIUS**2 * GRAVITY * np.cos(angle)
    place = [0.4, RADIUS + RANGE - weight / STIFFNESS]
    return scene_from_dict(
        {
            "scene": {"name": "wet_slope", "dimension": 2},
            "fluid": {
                "density": 1.0,
                "viscosity": 0.05,
                "gravity": [GRAVITY * np.sin(angle), -GRAVITY * np.cos(angle)],
            },
            "domain": {"lower": [0.0, 0.0], "upper": [1.2, 0.6]},
            "body": [{"type": "sphere", "radius": RADIUS, "density": 4.0, "position": place, "free": ["x", "y"]}],
            "contact": {
                **{"law": "spring-dashpot", "range": RANGE, "stiffness": STIFFNESS, "restitution": 0.3},
                **{"friction": FRICTION, **keys},
            },
            "mesh": {"size": 0.15, "size_body": 0.05, "refinements": 1} | (mesh or {}),
            "time": {"end": end, "step": step},
            "output": {"every": output or end},
        }
    )


@cache
def held(step, stiffness=SPRING["tangential_stiffness"], stepping="substeps"):
    return run_to_end(disk_on_slope(0.1, step, tangential_stiffness=stiffness, stepping=stepping))


@pytest.mark.long
@pytest.mark.parametrize("step", [4e-3, pytest.param(1e-3, marks=pytest.mark.nightly)])
def test_a_disk_that_hits_obliquely_loses_by_friction_and_film_and_makes_no_energy(step):
    """Film, roughness, restitution and friction act in one impact. Of the change of speed across the wall the film
    takes a part, which does not press the surfaces together; μ times the rest is lost along the wall."""
    data = disk_on_slope(0.05, step).to_dict()
    data["fluid"] |= {"gravity": [0.0, 0.0], "viscosity": 1e-3}
    data["body"][0] |= {"position": [0.4, RADIUS + 1.5 * RANGE], "velocity": [2.0, -2.0]}
    normal = {"law": "normal", "range": RANGE, "epsilon": "auto", "restitution": 0.8, "roughness": 1e-4}
    ended = {}
    for friction in (0.0, 0.2):
        data["contact"] = normal | {"friction": friction}
        state = run_to_end(scene_from_dict(data))
        assert abs(state.ledger.residual) < 5e-3 * state.ledger.initial
        ended[friction] = state.twist.velocity[0]
    change = ended[0.2] - ended[0.0]
    assert ended[0.2][1] > 0.5
    assert 0.7 < -change[0] / (0.2 * (2.0 + ended[0.2][1])) < 1.0


@pytest.mark.parametrize("step", [4e-3, pytest.param(2e-3, marks=pytest.mark.long)])
def test_no_energy_is_made(step):
    ledger = held(step).ledger
    assert abs(ledger.residual) < 5e-3 * abs(ledger.gravity)
    assert ledger.contact > 0.0


def test_the_spring_is_stretched_as_far_as_the_disk_has_moved_whatever_the_step():
    """A spring that provisional passes of a step stretched too would be longer, and by more in shorter steps."""
    start = 0.4
    for step in (4e-3, 2e-3):
        state = held(step)
        assert state.springs.displacement[0, 0] == pytest.approx(state.pose.position[0, 0] - start, rel=0.02)
    coarse, fine = (held(step).springs.displacement[0, 0] for step in (4e-3, 2e-3))
    assert coarse == pytest.approx(fine, rel=0.02)


def test_it_is_resumed_after_new_meshes_with_the_same_bits(tmp_path):
    def scene(end):
        return disk_on_slope(end, output=0.02, mesh={"remesh_every": 0.008}, **SPRING)

    steps = run(scene(0.04), tmp_path / "whole").steps
    assert steps["remeshes"][-1] >= 4
    run(scene(0.02), tmp_path / "resumed")
    run(scene(0.04), tmp_path / "resumed", resume=True)
    whole, resumed = (read_checkpoint(tmp_path / name / "state.h5").state for name in ("whole", "resumed"))
    for name in whole.springs.__slots__:
        np.testing.assert_array_equal(getattr(whole.springs, name), getattr(resumed.springs, name))
    np.testing.assert_array_equal(whole.pose.position, resumed.pose.position)
    assert whole.ledger == resumed.ledger


@pytest.mark.long
@pytest.mark.nightly
def test_implicit_steps_hold_it_alike():
    state, resolved = held(4e-3, stepping="implicit"), held(4e-3)
    assert abs(state.ledger.residual) < 5e-3 * abs(state.ledger.gravity)
    np.testing.assert_allclose(state.springs.displacement, resolved.springs.displacement, rtol=5e-3)
    assert state.ledger.contact_loss == pytest.approx(resolved.ledger.contact_loss, rel=5e-3)
