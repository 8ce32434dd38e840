"""Bodies in a fluid whose answers nobody asked for: they go on with what pulled them, contacts apart."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.contact_path import follow
from rigidfluid.core.contact.proximity import detect_contacts_and_gaps
from rigidfluid.core.model.energy import Ledger
from rigidfluid.core.model.reduced_model import Asked, Coupling, ReducedModel
from rigidfluid.core.model.state import Past, State
from rigidfluid.core.model.types import Twist, Wrench
from rigidfluid.core.setup.build import build_system
from rigidfluid.core.setup.load import scene_from_dict

LONG, SHORT, ANGLE, DENSITY, STEP = 0.1, 0.05, 0.6, 2.0, 1e-3
FORCE, TORQUE = np.array([0.3, -0.7]), 0.02
NONE = np.zeros(0)
ELLIPSE = {
    **{"type": "ellipsoid", "semi_axes": [LONG, SHORT], "density": 3.0, "position": [0.5, 0.5], "angle": ANGLE},
    **{"velocity": [0.2, 0.1], "angular_velocity": 0.5},
}
SCENE = {
    "scene": {"name": "outside", "dimension": 2},
    "fluid": {"density": DENSITY, "viscosity": 0.1},
    "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
    "body": [ELLIPSE],
    "contact": {"law": "normal", "range": 0.02, "epsilon": 1e-6},
    "mesh": {"size": 0.2, "size_body": 0.05},
    "time": {"end": 1.0, "step": STEP},
    "output": {"every": 1.0},
}


def given_by_contacts() -> tuple[np.ndarray, float]:
    """What the wrench makes of an ellipse: added masses πρb² along a and πρa² along b, no added inertia."""
    turn = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
    mass = 3.0 * np.pi * LONG * SHORT
    matrix = mass * np.eye(2) + turn @ np.diag(np.pi * DENSITY * np.array([SHORT, LONG]) ** 2) @ turn.T
    return np.linalg.solve(matrix, FORCE), TORQUE / (0.25 * mass * (LONG**2 + SHORT**2))


def test_what_contacts_gave_in_the_latest_step_does_not_go_on() -> None:
    """A twist that they alone have changed is kept."""
    system = build_system(scene_from_dict(SCENE))
    contacts, gaps = detect_contacts_and_gaps(system, system.pose, None)
    linear, angular = given_by_contacts()
    before = Twist(system.twist.velocity - STEP * linear, system.twist.angular_velocity - STEP * angular)
    still = Wrench(np.zeros((1, 2)), np.zeros((1, 1)))
    state = State(
        tick=1,
        count=1,
        level=0,
        pose=system.pose,
        twist=system.twist,
        past=Past(system.pose, before, STEP),
        mesh=None,
        reference=None,
        fluid={},
        coupling=None,
        contacts=contacts,
        gaps=gaps,
        hydrodynamic_wrench=still,
        contact_wrench=Wrench(FORCE[None, :], np.full((1, 1), TORQUE)),
        ledger=Ledger(0.0, 0.0, 0.0),
    )
    empty = ReducedModel(np.zeros(0, dtype=np.int64), np.zeros((0, 0)), NONE, Asked(NONE, NONE), False)
    end = follow(system, state, 0.0, STEP, Coupling(empty, NONE, NONE, NONE))
    for found, kept, given in (
        (end.twist.velocity, system.twist.velocity, linear),
        (end.twist.angular_velocity, system.twist.angular_velocity, angular),
    ):
        np.testing.assert_allclose(found, kept, rtol=0, atol=1e-6 * STEP * np.abs(given).max())
