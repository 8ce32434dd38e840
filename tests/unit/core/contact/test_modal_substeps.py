"""Compiled substeps of balls that a reduced model moves, against the same substeps one by one."""

from types import SimpleNamespace

import numpy as np
import pytest
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.pairs.near_pairs import NearPairs
from rigidfluid.core.contact.path import substep_path
from rigidfluid.core.contact.path.look_ahead import look_ahead
from rigidfluid.core.contact.path.modal_substeps import modal_substeps
from rigidfluid.core.contact.path.substep_path import SubstepPath
from rigidfluid.core.coupling.coupled_dynamics import CoupledDynamics
from rigidfluid.core.model.reduced_model import Coupling, Evaluation, reduced_model
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import StepRejected

LAWS = {
    "centre": {"law": "centre", "epsilon": 4e-6, "epsilon_wall": 2e-6},
    "normal": {"law": "normal", "epsilon": 4e-6},
    "contact": {"law": "contact", "epsilon": 1e-8},
}
SIZE, SIDE = 0.1, 6


def gas(dimension, side=2, fixed=False, **contact):
    """Balls of different sizes on a lattice."""
    random = np.random.default_rng(7)
    places = np.stack(np.meshgrid(*[np.arange(side)] * dimension), axis=-1).reshape(-1, dimension) + 0.5
    bodies = [
        {
            "type": "sphere",
            "radius": random.uniform(0.42, 0.46),
            "density": 2.0,
            "position": place,
            "velocity": random.normal(size=dimension).tolist(),
        }
        for place in places.tolist()
    ]
    if fixed:
        bodies[0] = {key: bodies[0][key] for key in ("type", "radius", "position", "density")} | {"fixed": True}
    domain = {"lower": [0.0] * dimension, "upper": [float(side)] * dimension}
    fluid = {"backend": "dry", "gravity": [0.0] * dimension}
    tables = dry_tables(*bodies, fluid=fluid, domain=domain, end=10.0, step=SIZE)
    tables["contact"] = {"range": 0.05} | contact
    return Simulation(scene_from_dict(tables), None, False)


def dynamics(run, turning=False, size=SIZE):
    """All bodies but the first in a model with masses, resistances and a growing load at random; it falls and spins."""
    state, d = run.state, run.state.pose.position.shape[1]
    count, width = len(state.pose.position), d + (1 if d == 2 else 3)
    random = np.random.default_rng(3)
    numbers = np.arange(count * width).reshape(count, width)[1:, : width if turning else d].ravel()
    inside = len(numbers)
    root = np.eye(inside) + 0.2 * random.normal(size=(inside, inside)) / np.sqrt(inside)
    inviscid = root @ root.T
    friction = 20.0 * np.eye(inside) + 0.1 * inviscid
    viscous = np.linalg.inv(np.linalg.inv(inviscid) + friction)
    model = reduced_model(numbers, inviscid, viscous, 1.0, Evaluation(*np.ones((2, inside))), False)
    load = random.normal(size=inside)
    coupling = Coupling(model, load, -load, np.zeros(inside))
    rate, angular = (
        random.normal(size=(count, width)),
        np.broadcast_to(np.eye(width - d), (count, width - d, width - d)),
    )
    found = CoupledDynamics(
        state.pose, state.motions.twist, rate, 0.5 * np.broadcast_to(np.eye(d), (count, d, d)), angular, coupling
    )
    found.vary_load(size, np.ones((count, width), dtype=bool))
    return found


def followed(run, monkeypatch, size=SIZE):
    """Path and dynamics of the bodies over a step, in compiled substeps and one by one."""
    found = []
    for maker in (modal_substeps, lambda *_: None):
        monkeypatch.setattr(substep_path, "modal_substeps", maker)
        bodies = dynamics(run, size=size)
        sight = look_ahead(run.system, bodies, size)
        path = SubstepPath(run.system, run.system.law, bodies, size).advance(sight, sight.contacts_at(bodies.pose))
        found.append(SimpleNamespace(path=path, bodies=bodies))
    return found


@pytest.mark.parametrize("substeps", [100, None])
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("law", LAWS)
def test_they_are_those_one_by_one(law, dimension, substeps, monkeypatch):
    contact = LAWS[law] | ({"substeps": substeps} if substeps else {})
    run = gas(dimension, **contact)
    assert modal_substeps(run.system, run.system.law, dynamics(run)) is not None
    found, slow = followed(run, monkeypatch)
    assert found.path.substeps == slow.path.substeps > 10
    assert np.any(slow.path.impulse.force[0])
    pairs = [
        (one.pose, one.twist, one.friction_loss, one.max_acceleration(SIZE)) for one in (found.bodies, slow.bodies)
    ]
    for one, other in zip(*pairs, strict=True):
        for name in getattr(one, "__match_args__", ()):
            np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-9, atol=1e-11)
        if not hasattr(one, "__match_args__"):
            np.testing.assert_allclose(one, other, rtol=1e-8)
    np.testing.assert_allclose(found.path.impulse.force, slow.path.impulse.force, rtol=1e-8, atol=1e-10)


def test_balls_that_leave_their_neighbours_find_others(monkeypatch):
    made, keep = [], NearPairs.keep
    monkeypatch.setattr(NearPairs, "keep", lambda near, listed: (made.append(listed), keep(near, listed)))
    found, slow = followed(gas(2, SIDE, **LAWS["centre"] | {"substeps": 500}), monkeypatch, 1.0)
    assert len({id(listed) for listed in made if np.isfinite(listed.reach)}) > 2
    np.testing.assert_allclose(found.bodies.pose.position, slow.bodies.pose.position, rtol=0, atol=1e-10)


def test_overlaps_are_refused():
    run = gas(2, **LAWS["contact"] | {"epsilon": 1.0, "substeps": 10})
    bodies = dynamics(run)
    bodies.apply_impulse(1e3 * np.ones((4, 3)))
    sight = look_ahead(run.system, bodies, SIZE)
    with pytest.raises(StepRejected, match="a gap of -"):
        SubstepPath(run.system, run.system.law, bodies, SIZE).advance(sight, sight.contacts_at(bodies.pose))


def test_other_bodies_are_followed_one_by_one():
    """Those that a model turns, those in motion of their own, and those under a law with dampers."""
    run = gas(2, **LAWS["normal"])
    assert modal_substeps(run.system, run.system.law, dynamics(run, turning=True)) is None
    for other in (
        gas(2, fixed=True, **LAWS["normal"]),
        gas(2, **LAWS["normal"] | {"restitution": 0.9}),
        gas(2, **LAWS["normal"] | {"detector": "brute_force"}),
    ):
        assert modal_substeps(other.system, other.system.law, dynamics(other)) is None
