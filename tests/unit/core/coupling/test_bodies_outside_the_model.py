"""Bodies in a fluid whose impulse responses were not evaluated: they go on with what pulled them, contacts apart."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scenes import wet_tables
from scipy.spatial.transform import Rotation

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps
from rigidfluid.core.contact.path.look_ahead import near_contacts
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.no_mesh import NoMesh
from rigidfluid.core.model.energy import Ledger
from rigidfluid.core.model.reduced_model import Coupling, Evaluation, ReducedModel
from rigidfluid.core.model.state import MotionState, Past, State, unloaded
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Twist, Wrench

TURN, STEP, NONE = [0.3, -0.5, 0.7], 1e-3, np.zeros(0)
BODY: dict[int, dict[str, Any]] = {
    2: {"semi_axes": [0.1, 0.05], "angle": TURN[2], "velocity": [0.2, 0.1], "angular_velocity": 0.5},
    3: {
        **{
            "semi_axes": [0.15, 0.1, 0.05],
            "orientation": Rotation.from_rotvec(TURN).as_quat(scalar_first=True).tolist(),
        },
        **{"velocity": [0.2, 0.1, -0.4], "angular_velocity": [0.0, 0.0, 0.0]},
    },
}


def moving(dimension: int, gravity: float = 0.0) -> System:
    """An ellipse or ellipsoid aslant, far from all walls."""
    return build_system(
        scene_from_dict(
            wet_tables(
                {"type": "ellipsoid", "density": 3.0, "position": [0.5] * dimension} | BODY[dimension],
                step=STEP,
                fluid={"density": 2.0, "gravity": [gravity] + [0.0] * (dimension - 1)},
                contact={"law": "normal", "range": 0.02, "epsilon": 1e-6},
                mesh={"size_body": 0.05},
            )
        )
    )


def accelerations(system: System, force: FloatArray, torque: FloatArray) -> tuple[FloatArray, FloatArray]:
    """By force and torque: the added mass and the inertia turn with the body, and there is no added inertia."""
    d = system.dimension
    turn = (
        Rotation.from_rotvec(TURN).as_matrix() if d == 3 else Rotation.from_rotvec([0, 0, TURN[2]]).as_matrix()[:2, :2]
    )
    linear = np.linalg.solve(system.mass[0] * np.eye(d) + turn @ system.added_mass[0] @ turn.T, force)
    about = turn if d == 3 else np.eye(1)
    return linear, np.linalg.solve(about @ system.inertia[0] @ about.T, torque)


def state_after(system: System, before: Twist, contact_wrench: Wrench) -> State:
    mesh = NoMesh(system).first_mesh()
    contacts, gaps = detect_contacts_and_gaps(system, system.pose, mesh)
    none = Wrench(np.zeros_like(before.velocity), np.zeros_like(before.angular_velocity))
    return State(
        tick=1,
        count=1,
        level=0,
        pose=system.pose,
        twist=system.twist,
        past=Past(system.pose, before, STEP),
        mesh=mesh,
        reference=NoMesh(system).first_reference(mesh, gaps),
        fluid={},
        coupling=None,
        contacts=contacts,
        gaps=gaps,
        hydrodynamic_wrench=none,
        contact_wrench=contact_wrench,
        motions=MotionState(system.pose, system.twist, contact_wrench, none),
        link=unloaded(system.pose),
        ledger=Ledger(0.0, 0.0, 0.0),
    )


def test_the_added_mass_of_an_ellipse_is_the_text_books() -> None:
    """πρb² along a and πρa² along b."""
    np.testing.assert_allclose(moving(2).added_mass[0], np.pi * 2.0 * np.diag([0.05**2, 0.1**2]))


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_contacts_gave_in_the_latest_step_does_not_go_on(dimension: int) -> None:
    """A twist that they alone have changed is kept."""
    system, random = moving(dimension), np.random.default_rng(1)
    force, torque = random.normal(size=dimension), 0.02 * random.normal(size=1 if dimension == 2 else 3)
    linear, angular = accelerations(system, force, torque)
    before = Twist(system.twist.velocity - STEP * linear, system.twist.angular_velocity - STEP * angular)
    state = state_after(system, before, Wrench(force[None, :], torque[None, :]))
    empty = ReducedModel(np.zeros(0, dtype=np.int64), np.zeros((0, 0)), NONE, Evaluation(NONE, NONE), False)
    end = scheme_of(system).follow(state, 0.0, STEP, Coupling(empty, NONE, NONE, NONE))
    for found, kept, given in (
        (end.twist.velocity, system.twist.velocity, linear),
        (end.twist.angular_velocity, system.twist.angular_velocity, angular),
    ):
        np.testing.assert_allclose(found, kept, rtol=0, atol=1e-6 * STEP * np.abs(given).max())


def test_contacts_that_weight_can_close_in_a_step_are_near() -> None:
    """From rest, by twice the size of the step times what weight can make of the speed in it."""
    system = moving(2, gravity=-1000.0)
    at_rest = Twist(np.zeros((1, 2)), np.zeros((1, 1)))
    state = state_after(system, at_rest, Wrench(np.zeros((1, 2)), np.zeros((1, 1))))
    state = replace(state, twist=at_rest, motions=replace(state.motions, twist=at_rest), past=None)
    left = state.contacts.body_b == 1
    pull = abs(accelerations(system, system.weight[0], np.zeros(1))[0])
    needed = np.sqrt((state.contacts.gap[left][0] - 0.02) / (2.0 * np.linalg.norm(pull)))
    assert len(near_contacts(system, state, 0.0, 0.99 * needed)) == 0
    assert near_contacts(system, state, 0.0, 1.01 * needed).body_b.tolist() == [1, 2]  # left and right alike
