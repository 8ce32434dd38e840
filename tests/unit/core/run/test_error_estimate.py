"""The estimate of a step's error: exact on motions that are known, blind to what contacts explain."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from falling import falling_disk

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.mechanics.time_scheme import extrapolation_weights
from rigidfluid.core.model.state import ErrorEstimate, Past, State
from rigidfluid.core.model.types import Twist, Wrench
from rigidfluid.core.run.error_estimate import estimate_error
from rigidfluid.core.run.simulation import Simulation

SPEED, ENERGY = 50.0, 3.0


@pytest.fixture(scope="module")
def run() -> Simulation:
    """Two disks in a fluid that stays at rest here, and a third that is held."""
    tables = falling_disk(mesh={"size": 0.4, "size_body": 0.1}, time={"step": 0.01, "end": 0.02}).to_dict()
    second = tables["body"][0] | {"name": "second", "density": 2.0, "position": [1.0, 2.0]}
    held = tables["body"][0] | {"name": "held", "position": [1.0, 3.0], "fixed": True}
    return Simulation(scene_from_dict(tables | {"body": [tables["body"][0], second, held]}))


def at(run: Simulation, time: float, step: float, previous: float, force: float = 0.0, jump: float = 0.0) -> State:
    """A state of bodies that turn and move as parabolas in time, but for a ``jump`` of the second."""

    def twist(then: float) -> Twist:
        return Twist(
            np.array([[1.0 + then, then**2], [0.0, 2.0 * then + jump * (then >= time)], [0.0, 9.0 * then**2]]),
            np.array([[0.0], [5.0 * then**2], [0.0]]),
        )

    pushed = Wrench(np.array([[0.0, 0.0], [0.0, force], [0.0, 0.0]]), np.zeros((3, 1)))
    return replace(
        run.state,
        twist=twist(time),
        motions=replace(run.state.motions, twist=twist(time), contact=pushed),
        past=Past(run.state.pose, twist(time - step), previous),
        contact_wrench=pushed,
        estimate=ErrorEstimate(7, 3, 0.0, 0.0, SPEED, ENERGY),
        reference=replace(run.state.reference, tick=-1),
    )


def estimated(run: Simulation, step: float, previous: float, **after: float) -> ErrorEstimate:
    """For a step until time 1, from what ``at`` makes of the step before."""
    state, candidate = at(run, 1.0 - step, previous, previous), at(run, 1.0, step, step, **after)
    return estimate_error(run.system, 1.0, state, candidate)


@pytest.mark.parametrize(("step", "previous"), [(0.1, 0.1), (0.1, 0.05), (0.05, 0.1)])
def test_the_error_of_a_motion_of_second_order_is_exact(run, step, previous):
    """Adams–Bashforth 2 misses (2r + 3)/(12 r) Δt² ü, with ü = 2 along y and 10 of the turning, √(I/m) = R/√2."""
    ratio = step / previous
    missed = (2.0 * ratio + 3.0) / (12.0 * ratio) * step**2
    fastest = max(2.0, 10.0 * 0.125 / math.sqrt(2.0))
    assert estimated(run, step, previous).error == pytest.approx(missed * fastest / SPEED, rel=1e-10)


def test_what_an_impact_changes_is_no_error_and_stays_visible(run):
    smooth, mass = estimated(run, 0.1, 0.1), run.system.mass[1]
    hit = estimated(run, 0.1, 0.1, jump=30.0, force=30.0 * mass / 0.1)
    assert hit.error == pytest.approx(smooth.error)
    assert hit.with_contacts == pytest.approx(5.0 / 12.0 * 30.0 / SPEED, rel=1e-3)
    assert estimated(run, 0.1, 0.1, jump=30.0).error == pytest.approx(hit.with_contacts)


def test_a_contact_that_pushes_on_as_before_explains_no_jump(run):
    """Of the body that it pushes on, with a force that could make twice the jump."""
    force = 60.0 * run.system.mass[1] / 0.1
    before, after = at(run, 0.9, 0.1, 0.1, force=force), at(run, 1.0, 0.1, 0.1, force=force, jump=30.0)
    found = estimate_error(run.system, 1.0, before, after)
    assert found.error == pytest.approx(estimated(run, 0.1, 0.1, jump=30.0).error)


def test_what_impacts_may_do_to_the_fluid_is_no_error_of_it_either(run, monkeypatch):
    """They give their energy to the bodies' own masses at most."""
    mass, jump, smooth = run.system.mass[1], 30.0, 1e-2
    known = 0.5 * mass * jump**2
    monkeypatch.setattr(run.system.backend, "prediction_error", lambda *_: (known**0.5 + smooth**0.5) ** 2)
    hit = estimated(run, 0.1, 0.1, jump=jump, force=jump * mass / 0.1)
    assert hit.error == pytest.approx(5.0 / 12.0 * math.sqrt(smooth / ENERGY))


def test_the_scales_are_the_greatest_so_far(run):
    fast = estimated(run, 0.1, 0.1, jump=98.0)
    assert fast.speed == pytest.approx(math.hypot(100.0, 5.0 * 0.125 / math.sqrt(2.0)))
    assert fast.energy == ENERGY
    candidate = at(run, 1.0, 0.1, 0.1)
    candidate = replace(candidate, ledger=replace(candidate.ledger, kinetic=2.0 * ENERGY))
    assert estimate_error(run.system, 1.0, at(run, 0.9, 0.1, 0.1), candidate).energy == 2.0 * ENERGY


def test_nothing_is_known_of_the_first_three_steps(run):
    state, candidate = at(run, 0.9, 0.1, 0.1), at(run, 1.0, 0.1, 0.1)
    found = []
    for _ in range(4):
        estimate = found[-1] if found else None
        found.append(estimate_error(run.system, 1.0, replace(state, estimate=estimate), candidate))
    assert [one.is_unknown for one in found] == [True, True, True, False]
    assert found[0].speed == pytest.approx(float(run.system.loads.speed[:2].max()))


def test_the_level_is_that_of_the_latest_step_without_an_impact(run):
    state, candidate = at(run, 0.9, 0.1, 0.1), replace(at(run, 1.0, 0.1, 0.1), tick=99, level=5)
    assert estimate_error(run.system, 1.0, state, candidate).level == 5
    assert estimate_error(run.system, 1.0, state, replace(candidate, impact=99)).level == 3


def test_a_new_mesh_leaves_the_estimate_of_the_step_before(run):
    state = replace(at(run, 0.9, 0.1, 0.1), reference=run.state.reference)
    state = replace(state, estimate=ErrorEstimate(7, 3, 0.25, 0.5, SPEED, ENERGY))
    found = estimate_error(run.system, 1.0, state, at(run, 1.0, 0.1, 0.1))
    assert (found.steps, found.error, found.with_contacts) == (8, 0.25, 0.5)


def test_the_fluid_counts_by_its_kinetic_energy():
    """Where no body is free, over the greatest energy so far."""
    scene = falling_disk(
        mesh={"size": 0.3, "size_body": 0.1},
        time={"step": 0.01, "end": 0.2, "tolerance": 0.1},
        body={"prescribed": {"velocity": [0.0, -1.0]}},
    )
    simulation = Simulation(scene)
    simulation.go(until=0.1)
    state = simulation.state
    simulation.step()
    new, backend = simulation.state, simulation.system.backend
    weights = extrapolation_weights(new.past.step, state.past.step)
    surprise = (
        new.fluid["velocity"] - weights[0] * state.fluid["velocity"] - weights[1] * state.fluid["velocity_previous"]
    )
    rest = {name: np.zeros_like(values) for name, values in state.fluid.items()}
    moving = rest | {"velocity": surprise}
    energy = backend.prediction_error(rest, moving, new.mesh, weights)
    assert new.estimate.error == pytest.approx(5.0 / 12.0 * math.sqrt(energy / new.estimate.energy))
    whole = backend.prediction_error(rest, rest | {"velocity": new.fluid["velocity"]}, new.mesh, weights)
    assert whole == pytest.approx(new.ledger.kinetic)
