"""Compiled substeps of balls with springs along their surfaces against the same substeps one by one."""

import numpy as np
import pytest
from gases import assert_same, both_ways, gas

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.laws.ball_law import ball_law
from rigidfluid.core.contact.laws.friction import Friction, Rubbing
from rigidfluid.core.contact.pairs.near_pairs import NearPairs
from rigidfluid.core.contact.path import substep_path
from rigidfluid.core.contact.path.spring_substeps import spring_substeps
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.mechanics.coulomb import TurningFriction
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run.run import run
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import PluginError, StepRejected
from rigidfluid.forces.normal import NormalLaw

DASHPOT = {"law": "spring-dashpot", "stiffness": 8e3, "restitution": 0.8, "friction": 0.3, "tangential_stiffness": 2e3}
TURNING = {"rolling_friction": 0.1, "twisting_friction": 0.05}
AUTO = {"epsilon": "auto", "impact_speed": 2.0, "friction": 0.3}
LAWS = {
    "dashpot": DASHPOT | TURNING,
    "unbounded": DASHPOT | {"bounded_dashpot": False, "tangential_damping": 2.0},
    "rolling": {"law": "contact", "epsilon": 1e-8, "friction": 0.3, "rolling_friction": 0.1},
    "auto": {"law": "normal", "restitution": 0.5} | AUTO | TURNING,
    "centre": {"law": "centre", "restitution": 1.0, "tangential_stiffness": 500.0} | AUTO,
    "barrier": {"law": "barrier", "restitution": 0.2, "tangential_damping": 0.5} | AUTO,
}


def assert_same_springs(runs):
    """Displacements of all pairs are the same but for rounding, which leaves some springs exactly relaxed."""
    stretched = []
    for state, _ in runs:
        springs, dense = state.springs, {}
        for row in range(len(springs)):
            force = springs.stiffness[row] * np.append(springs.displacement[row], springs.turning[row])
            dense[int(springs.body_a[row]), int(springs.body_b[row])] = np.append(force, springs.normal[row])
        stretched.append(dense)
    one, other = stretched
    none = np.zeros_like(next(iter(one.values())))
    for pair in one.keys() | other.keys():
        found, expected = one.get(pair, none), other.get(pair, none)
        if pair in one and pair in other:
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)
        else:
            assert np.abs(found - expected)[: -len(state.pose.position[0])].max() < 1e-12
    assert max(np.abs(force).max() for force in other.values()) > 0.1


def assert_same_energies(runs):
    """Stored and lost energies are the same but for rounding."""
    ledgers = [state.ledger for state, _ in runs]
    for name in ("kinetic", "contact", "gravity", "contact_loss", "residual"):
        found, expected = (getattr(ledger, name) for ledger in ledgers)
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert ledgers[0].contact_loss > 1e-3


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("law", LAWS)
def test_they_are_those_one_by_one(law, dimension, monkeypatch):
    runs = both_ways(gas(LAWS[law], dimension, 3, 60), monkeypatch, 3, "spring_substeps")
    assert_same(runs)
    assert_same_springs(runs)
    assert_same_energies(runs)


def test_substeps_are_planned_alike(monkeypatch):
    soft = DASHPOT | {"stiffness": 300.0, "tangential_stiffness": 80.0}
    runs = both_ways(gas(soft, 2, 3, None), monkeypatch, 3, "spring_substeps")
    assert_same(runs)
    assert_same_energies(runs)


def lists_made(monkeypatch):
    """The list that is made of each pair list that is kept."""
    made, keep = [], NearPairs.keep
    monkeypatch.setattr(NearPairs, "keep", lambda near, listed: (made.append(listed), keep(near, listed)))
    return made


@pytest.mark.parametrize("law", ["dashpot", "auto"])
def test_balls_that_leave_their_neighbours_find_others(law, monkeypatch):
    """In one step they fly through several lists, each with parameters of its own."""
    made = lists_made(monkeypatch)
    contact = {key: value for key, value in LAWS[law].items() if key != "twisting_friction"}
    runs = both_ways(gas(contact, 2, 6, 300, step=0.3), monkeypatch, 1, "spring_substeps")
    assert len({id(listed) for listed in made if np.isfinite(listed.reach)}) > 2
    assert_same(runs)
    assert_same_energies(runs)


def test_a_run_that_is_resumed_goes_on_with_the_same_bits(monkeypatch, tmp_path):
    """Though the list of pairs is not the same."""
    made = lists_made(monkeypatch)
    scene = gas(LAWS["auto"], 3, 4, 60)

    def until(end):
        return scene_from_dict(scene.to_dict() | {"time": {"end": end, "step": 0.05}, "output": {"every": 0.05}})

    run(until(0.8), tmp_path / "whole")
    lists = len(made)
    run(until(0.4), tmp_path / "resumed")
    run(until(0.8), tmp_path / "resumed", resume=True)
    assert len(made) > 2 * lists - 1 > 2
    whole, resumed = (read_checkpoint(tmp_path / name / "state.h5").state for name in ("whole", "resumed"))
    assert len(whole.springs) > 5
    for record in ("pose", "twist", "springs"):
        for name in getattr(whole, record).__slots__:
            np.testing.assert_array_equal(
                getattr(getattr(whole, record), name), getattr(getattr(resumed, record), name)
            )
    assert whole.ledger == resumed.ledger


def test_overlaps_are_refused(monkeypatch):
    simulation = Simulation(gas(LAWS["rolling"], 2, 3, 40, epsilon=1.0), None, False)
    for maker in (spring_substeps, lambda *_: None):
        monkeypatch.setattr(substep_path, "spring_substeps", maker)
        with pytest.raises(StepRejected, match="a gap of -"):
            scheme_of(simulation.system).follow(simulation.state, simulation.time, 0.5, None)


def substeps_of(scene):
    """Compiled substeps of a scene's system, None where it has none."""
    simulation = Simulation(scene, None, False)
    dynamics = scheme_of(simulation.system).bodies_now(simulation.state, 0.0)
    return spring_substeps(simulation.system, simulation.system.law, dynamics)


@pytest.mark.parametrize(
    ("law", "contact"),
    [
        ("dashpot", {"detector": "brute_force"}),
        ("auto", {"friction": None, "rolling_friction": None, "twisting_friction": None}),
    ],
    ids=["detector", "no springs"],
)
def test_other_contacts_are_followed_otherwise(law, contact):
    assert substeps_of(gas(LAWS[law], 3, 2, 40)) is not None
    assert substeps_of(gas(LAWS[law], 3, 2, 40, **contact)) is None


def test_a_law_around_another_by_someone_else_is_asked_itself():
    law = Simulation(gas(LAWS["auto"], 3, 2, 40), None, False).system.law

    class Weaker(type(law)):
        def damping(self, contacts, motion):
            return 0.5 * super().damping(contacts, motion)

    assert ball_law(law) is not None
    weaker = Weaker.__new__(Weaker)
    vars(weaker).update(vars(law))
    assert ball_law(weaker) is None


def rubbing(law):
    """A law with friction around it."""
    return Friction(law, Rubbing(0.3, 100.0, 1.0, 0.02, TurningFriction(0.0, 0.0)))


def test_dampers_of_the_law_itself_are_no_dashpots_of_springs():
    class Damped(NormalLaw):
        def pair_formula(self):
            return super().pair_formula()

    law = Damped(NormalLaw.Options(epsilon=1e-3), 0.05)
    assert ball_law(rubbing(law)) is not None
    law.dissipative = True
    assert ball_law(rubbing(law)) is None


def test_parameters_of_other_contacts_are_refused():
    class Odd(NormalLaw):
        def pair_formula(self):
            return super().pair_formula()._replace(each=lambda contacts: np.ones((len(contacts) + 1, 3)))

    known = ball_law(rubbing(Odd(NormalLaw.Options(epsilon=1e-3), 0.05)))
    contacts = Simulation(gas(LAWS["auto"], 2, 2, 40), None, False).state.contacts
    with pytest.raises(PluginError, match=r"formula .*parameters of shape \(\d+, 3\)"):
        known.parameters(contacts)
