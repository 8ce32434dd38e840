"""Steps as long as their error allows: when they grow, when they are rejected."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from falling import SCENES, falling_disk

import rigidfluid
from rigidfluid.api import scene_from_dict as scene_of
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.model.state import ErrorEstimate, State
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.error_estimate import UNSEEN
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.run.step_controller import GROWS, StepController
from rigidfluid.core.run.summary import summarise
from rigidfluid.errors import StepRejected

TOLERANCE = 1e-3
CLOCK = Clock.for_steps(0.1, 0.1 / 16, 10.0)
SCENE = {"mesh": {"size": 0.3, "size_body": 0.05}, "output": {"every": 0.064}}


@pytest.fixture(scope="module")
def run() -> Simulation:
    simulation = Simulation(falling_disk(**SCENE, time={"step": 0.032, "end": 0.256, "tolerance": TOLERANCE}))
    simulation.go()
    return simulation


@pytest.fixture
def controller() -> StepController:
    return StepController(CLOCK, TOLERANCE)


def after(run: Simulation, level: int, error: float, with_contacts: float | None = None, steps: int = 9) -> State:
    """A state at the start of a nominal step."""
    estimate = ErrorEstimate(steps, level, error, error if with_contacts is None else with_contacts, 1.0, 1.0)
    return replace(run.state, tick=32, level=level, estimate=estimate)


def test_a_step_doubles_where_its_error_is_far_below_the_tolerance(run, controller):
    assert controller.propose(after(run, 3, 0.99 * GROWS * TOLERANCE)) == 2
    assert controller.propose(after(run, 3, 1.01 * GROWS * TOLERANCE)) == 3


def test_a_step_does_not_grow_while_contacts_change_the_motion(run, controller):
    assert controller.propose(after(run, 3, 0.0, with_contacts=TOLERANCE)) == 3


def test_a_step_stays_on_the_grid_of_the_clock(run, controller):
    odd = replace(after(run, 3, 0.0), tick=34)
    assert controller.propose(odd) == 3


def test_a_step_keeps_its_size_until_its_error_is_known(run, controller):
    assert controller.propose(after(run, 3, math.inf)) == 3
    assert controller.propose(after(run, 3, math.inf, steps=0)) == 2  # the first: the level before it is a bound


def test_an_error_that_has_doubled_or_halved_changes_no_step_twice(run, controller):
    """A step that was just doubled has four times its error, and one that was just halved a quarter."""
    controller.judge(after(run, 2, 4.0 * GROWS * TOLERANCE * 1.49))
    assert controller.propose(after(run, 3, TOLERANCE / 4.0)) == 3


def test_an_error_above_the_tolerance_rejects_the_step(run, controller):
    controller.judge(after(run, 0, TOLERANCE))
    with pytest.raises(StepRejected, match=r"a local error of 0\.0011; allowed is at most time\.tolerance = 0\.001"):
        controller.judge(after(run, 0, 1.1 * TOLERANCE))


def test_what_is_not_known_or_cannot_be_shorter_is_accepted(run, controller):
    controller.judge(after(run, 0, math.inf))
    controller.judge(after(run, CLOCK.levels, 1.1 * TOLERANCE))


def test_a_falling_disk_starts_with_short_steps_and_goes_on_with_long_ones(run):
    sizes, errors = run.history.steps["size"], run.history.steps["error"]
    np.testing.assert_allclose(np.diff(run.history.energy["time"]), sizes)
    assert np.isinf(errors[:UNSEEN]).all()
    assert errors[UNSEEN:].max() <= TOLERANCE
    assert sizes[UNSEEN] <= 0.001
    assert sizes[-1] >= 0.008
    assert run.counts.rejected + np.count_nonzero(np.diff(sizes)) < 12


@pytest.mark.long
def test_a_fourth_of_the_tolerance_makes_less_than_half_of_the_error():
    def speeds(**time: float) -> float:
        simulation = Simulation(falling_disk(**SCENE, time={"step": 0.032, "end": 0.128} | time))
        simulation.go()
        return float(simulation.state.twist.velocity[0, 1])

    exact = speeds(step=0.0005)
    loose, tight = (abs(speeds(tolerance=tolerance) - exact) for tolerance in (4e-3, 1e-3))
    assert tight < 0.5 * loose
    assert loose < 4e-3 * abs(exact)


def test_without_a_tolerance_steps_are_told_and_no_error_is_estimated():
    simulation = Simulation(falling_disk(**SCENE, time={"step": 0.008, "end": 0.032}))
    simulation.go()
    assert simulation.state.estimate is None
    assert simulation.state.count == 4
    steps = simulation.history.steps
    np.testing.assert_array_equal(steps["size"], np.full(4, 0.008))
    assert np.isinf(steps["error"]).all()
    assert set(steps["unknowns"]) == {summarise(simulation, "complete")["unknowns"]}
    np.testing.assert_array_equal(steps["remeshes"], np.zeros(4))
    assert set(steps["cells"]) == {len(simulation.state.mesh.cells)}


def test_steps_and_the_summary_tell_of_the_worst_cell():
    simulation = Simulation(falling_disk(**SCENE, time={"step": 0.008, "end": 0.016}))
    worst = []
    simulation.observe(lambda now: worst.append(cell_quality(now.state.mesh.points, now.state.mesh.cells).min()))
    simulation.go()
    told = simulation.history.steps["quality"]
    assert np.all((told > 0.9 * np.array(worst)) & (told <= worst))  # bent cells are worse than straight ones
    assert summarise(simulation, "complete")["worst_quality"] == told.min()


def test_without_a_mesh_no_quality_is_told():
    simulation = Simulation(rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=2e-5"]))
    simulation.go()
    assert np.isnan(simulation.history.steps["quality"]).all()
    assert summarise(simulation, "complete")["worst_quality"] is None


def test_a_body_that_is_moved_at_once_starts_again_with_short_steps(run):
    paddle = {"name": "paddle", "type": "sphere", "radius": 0.2, "density": 1.0, "position": [1.0, 2.0], "fixed": True}
    scene = falling_disk(**SCENE, time={"step": 0.032, "end": 0.256, "tolerance": TOLERANCE})
    both = scene.to_dict() | {"body": [*scene.to_dict()["body"], paddle]}
    simulation = Simulation(scene_of(both))
    simulation.go(until=0.128)
    simulation.prescribe("paddle", velocity=[1.0, 0.0])
    before = simulation.state.tick
    simulation.step()
    assert simulation.state.tick - before == simulation.clock.ticks(6)
    assert simulation.state.estimate.is_unknown
