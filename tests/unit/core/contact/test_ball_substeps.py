"""Compiled substeps of balls against the same substeps one by one."""

import numpy as np
import pytest
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.pairs.near_pairs import NearPairs
from rigidfluid.core.contact.path import substep_path
from rigidfluid.core.contact.path.ball_substeps import ball_substeps
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.model.pair_formula import PairFormula, own_formula
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import StepRejected
from rigidfluid.forces.normal import NormalLaw

LAWS = {
    "centre": {"law": "centre", "epsilon": 4e-6, "epsilon_wall": 2e-6},
    "normal": {"law": "normal", "epsilon": 4e-6},
    "contact": {"law": "contact", "epsilon": 1e-8},
    "dashpot": {"law": "spring-dashpot", "stiffness": 8e3, "restitution": 0.8, "friction": 0.3},
    "damped": {"law": "spring-dashpot", "stiffness": 8e3, "damping": 1.0, "friction": 0.1, "tangential_damping": 0.5},
}


def no_number(parameters, gap, radius_a, radius_b, mass, opening, sliding):
    return 0.0, np.nan, 0.0, 0.0


def gas(law, dimension, side, substeps, step=0.05, **contact):
    """Balls of different sizes on a lattice, which fly and spin at random."""
    random = np.random.default_rng(7)
    places = np.stack(np.meshgrid(*[np.arange(side)] * dimension), axis=-1).reshape(-1, dimension) + 0.5
    bodies = [
        {
            "type": "sphere",
            "radius": random.uniform(0.35, 0.46),
            "density": random.uniform(1.0, 3.0),
            "position": place,
            "velocity": (0.5 * random.normal(size=dimension)).tolist(),
            "angular_velocity": random.normal(size=dimension).tolist() if dimension == 3 else float(random.normal()),
        }
        for place in places.tolist()
    ]
    fluid = {"backend": "dry", "gravity": [0.0] * (dimension - 1) + [-3.0]}
    domain = {"lower": [0.0] * dimension, "upper": [float(side)] * dimension}
    tables = dry_tables(*bodies, fluid=fluid, domain=domain, end=10.0, step=step)
    tables["contact"] = LAWS[law] | {"range": 0.05} | contact | ({"substeps": substeps} if substeps else {})
    return scene_from_dict(tables)


def both_ways(scene, monkeypatch, steps):
    """The run after some steps in compiled substeps, and one by one."""
    runs = []
    for maker in (substep_path.ball_substeps, lambda *_: None):
        monkeypatch.setattr(substep_path, "ball_substeps", maker)
        run = Simulation(scene, None, False)
        paths = []
        for _ in range(steps):
            paths.append(scheme_of(run.system).follow(run.state, run.time, run.clock.size(0), None))
            run.step()
        runs.append((run.state, paths[-1]))
    return runs


FIELDS = [
    *(("pose", field) for field in ("position", "orientation")),
    *(("twist", field) for field in ("velocity", "angular_velocity")),
    *(("impulse", field) for field in ("force", "torque")),
]


def assert_same(runs):
    """Poses, twists, impulses and energies are the same but for rounding."""
    (state, path), (expected, slow) = runs
    assert path.substeps == slow.substeps > 1
    assert np.any(slow.impulse.force)
    pairs = [(getattr(getattr(path, one), two), getattr(getattr(slow, one), two)) for one, two in FIELDS]
    for found, other in [*pairs, (path.dissipated, slow.dissipated), (path.actuator_work, slow.actuator_work)]:
        np.testing.assert_allclose(found, other, rtol=0, atol=1e-11 * np.abs(other).max() + 1e-12)
    np.testing.assert_allclose(state.pose.position, expected.pose.position, rtol=0, atol=1e-11)


@pytest.mark.parametrize("substeps", [40, None])
@pytest.mark.parametrize(("dimension", "side"), [(2, 3), (3, 4)])
@pytest.mark.parametrize("law", LAWS)
def test_they_are_those_one_by_one(law, dimension, side, substeps, monkeypatch):
    assert_same(both_ways(gas(law, dimension, side, substeps), monkeypatch, 3))


def test_balls_that_leave_their_neighbours_find_others(monkeypatch):
    """In one step they fly through several lists."""
    made, keep = [], NearPairs.keep
    monkeypatch.setattr(NearPairs, "keep", lambda near, listed: (made.append(listed), keep(near, listed)))
    runs = both_ways(gas("dashpot", 2, 6, 500, step=0.4), monkeypatch, 1)
    assert len({id(listed) for listed in made if np.isfinite(listed.reach)}) > 2
    assert_same(runs)


def test_overlaps_are_refused(monkeypatch):
    scene = gas("contact", 2, 3, 40, epsilon=1.0)
    for maker in (substep_path.ball_substeps, lambda *_: None):
        monkeypatch.setattr(substep_path, "ball_substeps", maker)
        run = Simulation(scene, None, False)
        with pytest.raises(StepRejected, match="a gap of -"):
            scheme_of(run.system).follow(run.state, run.time, 0.5, None)


def test_a_force_that_is_no_number_is_refused_as_that_of_the_law(monkeypatch):
    monkeypatch.setattr(NormalLaw, "pair_formula", lambda law: PairFormula(no_number, np.zeros(1)))
    run = Simulation(gas("normal", 2, 2, 40), None, False)
    with pytest.raises(StepRejected, match=r"forces by a law's formula of nan.*`contact\.law`"):
        scheme_of(run.system).follow(run.state, run.time, 0.5, None)


@pytest.mark.parametrize(
    ("law", "contact"),
    [
        ("dashpot", {"detector": "brute_force"}),
        ("dashpot", {"tangential_stiffness": 1e3}),
        ("normal", {"epsilon": "auto", "impact_speed": 1.0}),
        ("normal", {"restitution": 0.9}),
    ],
    ids=["detector", "memory", "auto", "restitution"],
)
def test_other_contacts_are_followed_one_by_one(law, contact):
    run = Simulation(gas(law, 2, 2, 40, **contact), None, False)
    dynamics = scheme_of(run.system).bodies_now(run.state, 0.0)
    assert ball_substeps(run.system, run.system.law, dynamics) is None


def test_a_subclass_gives_a_formula_of_its_own_or_none():
    class Softer(NormalLaw):
        def unit_force(self, contacts):
            return 0.5 * super().unit_force(contacts)

    options = NormalLaw.Options(epsilon=1.0)
    assert own_formula(NormalLaw(options, 0.1)) is not None
    assert own_formula(Softer(options, 0.1)) is None
