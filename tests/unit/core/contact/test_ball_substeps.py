"""Compiled substeps of balls against the same substeps one by one."""

import numpy as np
import pytest
from gases import assert_same, both_ways, gas

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


@pytest.mark.parametrize("substeps", [40, None])
@pytest.mark.parametrize(("dimension", "side"), [(2, 3), (3, 4)])
@pytest.mark.parametrize("law", LAWS)
def test_they_are_those_one_by_one(law, dimension, side, substeps, monkeypatch):
    assert_same(both_ways(gas(LAWS[law], dimension, side, substeps), monkeypatch, 3))


def test_balls_that_leave_their_neighbours_find_others(monkeypatch):
    """In one step they fly through several lists."""
    made, keep = [], NearPairs.keep
    monkeypatch.setattr(NearPairs, "keep", lambda near, listed: (made.append(listed), keep(near, listed)))
    runs = both_ways(gas(LAWS["dashpot"], 2, 6, 500, step=0.4), monkeypatch, 1)
    assert len({id(listed) for listed in made if np.isfinite(listed.reach)}) > 2
    assert_same(runs)


def test_overlaps_are_refused(monkeypatch):
    scene = gas(LAWS["contact"], 2, 3, 40, epsilon=1.0)
    for maker in (substep_path.ball_substeps, lambda *_: None):
        monkeypatch.setattr(substep_path, "ball_substeps", maker)
        run = Simulation(scene, None, False)
        with pytest.raises(StepRejected, match="a gap of -"):
            scheme_of(run.system).follow(run.state, run.time, 0.5, None)


def test_a_force_that_is_no_number_is_refused_as_that_of_the_law(monkeypatch):
    monkeypatch.setattr(NormalLaw, "pair_formula", lambda law: PairFormula(no_number, np.zeros(1)))
    run = Simulation(gas(LAWS["normal"], 2, 2, 40), None, False)
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
    run = Simulation(gas(LAWS[law], 2, 2, 40, **contact), None, False)
    dynamics = scheme_of(run.system).bodies_now(run.state, 0.0)
    assert ball_substeps(run.system, run.system.law, dynamics) is None


def test_a_subclass_gives_a_formula_of_its_own_or_none():
    class Softer(NormalLaw):
        def unit_force(self, contacts):
            return 0.5 * super().unit_force(contacts)

    options = NormalLaw.Options(epsilon=1.0)
    assert own_formula(NormalLaw(options, 0.1)) is not None
    assert own_formula(Softer(options, 0.1)) is None
