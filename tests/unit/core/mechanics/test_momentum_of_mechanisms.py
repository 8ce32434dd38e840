"""Chains of three ellipsoids that wag, without a fluid: their drives give energy, and no momentum."""

import numpy as np
import pytest
from scenes import dry_tables

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.mechanics.rigid import lab_inertia, moment
from rigidfluid.core.output.energy_account import energy_account

pytestmark = pytest.mark.long


def chain(name, dimension, position, **keys):
    """A tail and a head turn on hinges, about different axes in 3D, and the head moves to and fro besides."""
    beside = [0.0] * (dimension - 1)
    parts = [
        {"name": part, "type": "ellipsoid", "semi_axes": [0.05, 0.03, 0.04][:dimension], "density": density}
        | {"position": [x, *beside]}
        for part, x, density in (("tail", -0.13, 1.0), ("body", 0.0, 2.0), ("head", 0.13, 3.0))
    ]
    tail, head = [[0.0, 0.0], [0.25, 0.5], [0.75, -0.5], [1.0, 0.0]], [[0.0, 0.3], [0.5, -0.4], [1.0, 0.3]]
    axes = [{}, {}] if dimension == 2 else [{"axis": [0.0, 0.6, 0.8]}, {"axis": [0.0, 0.0, 1.0]}]
    strokes = [
        {"moves": ["tail"], "about": [-0.065, *beside], "smooth": tail} | axes[0],
        {"moves": ["head"], "about": [0.065, *beside], "smooth": head} | axes[1],
        {"moves": ["head"], "along": [1.0, *beside], "smooth": [[0.0, 0.0], [0.3, 0.04], [1.0, 0.0]]},
    ]
    table = {"name": name, "type": "articulated", "position": position, "component": parts, "stroke": strokes}
    return table | keys


def simulation(*chains, end, step, **contact):
    law = {"law": "normal", "range": 0.01, "epsilon": 1e-6}
    return Simulation(
        scene_from_dict(
            dry_tables(end=end, step=step, mechanism=list(chains), contact=law | contact if contact else {})
        )
    )


def momenta(it):
    """Σ m v and Σ (x × m v + I ω) of all components, (d+k,)."""
    mass, pose, twist = it.system.mass, it.state.pose, it.state.twist
    inertia = lab_inertia(it.system.inertia, pose.orientation)
    spin = np.einsum("nij,nj->ni", inertia, twist.angular_velocity)
    spin += mass[:, None] * moment(pose.position, twist.velocity)
    return np.concatenate([mass @ twist.velocity, spin.sum(axis=0)])


def alone(dimension, end, step):
    turning = 3.0 if dimension == 2 else [2.0, -1.0, 3.0]
    place = {"position": [0.4] * dimension, "velocity": [0.02, 0.01, 0.01][:dimension]}
    return simulation(chain("it", dimension, angular_velocity=turning, **place), end=end, step=step)


def two(dimension, stepping, end, step):
    """They hit each other off their centres."""
    turned = (
        {"angle": 2.0} if dimension == 2 else {"orientation": [np.cos(1.0), 0.0, *np.sin(1.0) * np.array([0.6, 0.8])]}
    )
    left = chain("a", dimension, [0.32, 0.5, 0.5][:dimension], velocity=[0.5, 0.02, 0.02][:dimension])
    right = chain("b", dimension, [0.68, 0.55, 0.5][:dimension], velocity=[-0.4, 0.0, 0.0][:dimension], **turned)
    return simulation(left, right, end=end, step=step, stepping=stepping)


def at_a_wall(dimension, stepping, end, step):
    """Its head hits the right wall."""
    speed = [0.6, 0.1, 0.05][:dimension]
    return simulation(
        chain("a", dimension, [0.75, 0.5, 0.5][:dimension], velocity=speed), end=end, step=step, stepping=stepping
    )


def gone(it):
    """Runs it; how momenta have changed over their scale, whether there were contacts, and the energy account."""
    before, touched = momenta(it), []
    scale = np.abs(it.system.mass @ np.abs(it.state.twist.velocity)).max()
    it.observe(lambda now: touched.append(any(body.contact_force.any() for body in now.bodies.values())))
    it.go()
    return (momenta(it) - before) / scale, sum(touched), energy_account(it.history.energy)


@pytest.mark.parametrize(("dimension", "steps"), [(2, 300), (3, 80)])
def test_alone_it_keeps_momentum_and_angular_momentum(dimension, steps):
    it = alone(dimension, end=0.6, step=0.6 / steps)
    changed, _, _ = gone(it)
    assert np.abs(changed).max() < 1e-11
    ledger = it.state.ledger
    assert abs(ledger.control) > 0.01 * ledger.kinetic
    assert abs(ledger.residual) < (2e-4 if dimension == 3 else 2e-5) * ledger.kinetic


@pytest.mark.parametrize(
    ("dimension", "stepping", "end", "step"),
    [(2, "substeps", 0.24, 2e-3), (2, "implicit", 0.24, 2e-3), (3, "implicit", 0.3, 4e-3)],
)
def test_two_that_hit_each_other_keep_their_sum(dimension, stepping, end, step):
    changed, touched, account = gone(two(dimension, stepping, end, step))
    assert touched
    assert np.abs(changed).max() < 1e-11
    assert max(account.created, account.lost) < 1e-3


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_a_wall_without_friction_takes_momentum_across_itself_alone(stepping):
    changed, touched, account = gone(at_a_wall(2, stepping, 0.2, 2e-3))
    assert touched
    assert changed[0] < -0.5
    assert abs(changed[1]) < 1e-11
    assert max(account.created, account.lost) < 1e-3


@pytest.mark.validation
@pytest.mark.parametrize(("dimension", "end"), [(2, 10.0), (3, 1.6)])
def test_over_thousands_of_steps(dimension, end):
    changed, _, account = gone(alone(dimension, end=end, step=1e-3))
    assert np.abs(changed).max() < 1e-9
    assert max(account.created, account.lost) < 1e-3
