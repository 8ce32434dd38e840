"""What convects is given the bodies' velocity on the mesh, where contacts turn them around."""

from dataclasses import replace

import fluid_contacts as scenes
import numpy as np
import pytest

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.reduced_model import Coupling, Evaluation, ReducedModel
from rigidfluid.core.model.state import MotionState, Past, unloaded
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.run.simulation import Simulation

STEP, SPEED, MASS = 1e-3, 7.0, 0.14


def path_to(simulation: Simulation, moved: float) -> BodyStep:
    """A disk's way that ends so far above its start, with a coupling that knows its velocity in x and y."""
    state, count = simulation.state, np.array([0, 1])
    pose = Pose(state.pose.position + [[0.0, moved]], state.pose.orientation)
    zero = np.zeros(2)
    model = ReducedModel(count, np.eye(2) / np.sqrt(MASS), zero, Evaluation(zero, zero), False)
    moved_state = MotionState(pose, state.twist, nothing(pose), nothing(pose))
    coupling = Coupling(model, zero, zero, zero)
    return BodyStep(pose, state.twist, moved_state, nothing(pose), 0.0, 0.0, 1, unloaded(pose), coupling=coupling)


def turned(moved: float, coupled: bool = True, scene=scenes.dropped, fallen: bool = False) -> FloatArray:
    """For a disk that falls at first, or has ``fallen`` evenly for as long a step."""
    simulation = Simulation(scene(STEP), None, False)
    falls = Twist(np.array([[0.0, -SPEED]]), np.zeros((1, 1)))
    motions = replace(simulation.state.motions, twist=falls)
    start = Pose(motions.pose.position + [[0.0, SPEED * STEP]], motions.pose.orientation)
    past = Past(start, falls, STEP) if fallen else None
    simulation.state = state = replace(simulation.state, twist=falls, motions=motions, past=past)
    path = path_to(simulation, moved)
    path = path if coupled else replace(path, coupling=None)
    step = step_to(simulation.system, state, StepEnd(STEP, STEP, path.pose, path.impulse))
    return scheme_of(simulation.system).prepare(step, state, path).turning


def test_impulses_make_up_for_what_was_extrapolated():
    """From -7 to what the mesh does, +5, by the mass that the model knows."""
    np.testing.assert_allclose(turned(5.0 * STEP), [[0.0, MASS * (SPEED + 5.0), 0.0]], rtol=1e-12)


def test_a_second_step_differences_the_poses_as_it_does_those_of_the_mesh():
    """BDF2 of the places 7, 0 and 5, in units of the step: 1.5 * 5 + 0.5 * 7."""
    np.testing.assert_allclose(turned(5.0 * STEP, fallen=True), [[0.0, MASS * (SPEED + 11.0), 0.0]], rtol=1e-12)
    assert not turned(-SPEED * STEP, fallen=True).any()


@pytest.mark.parametrize(
    ("moved", "coupled", "scene"),
    [
        (-SPEED * STEP, True, scenes.dropped),
        (5.0 * STEP, False, scenes.dropped),
        (5.0 * STEP, True, scenes.stokes_pressed),
    ],
    ids=["as extrapolated", "no contacts", "no inertia"],
)
def test_else_nothing_is_turned(moved, coupled, scene):
    assert not turned(moved, coupled, scene).any()
