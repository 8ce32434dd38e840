"""A step of several implicit ones: what each of them does adds up."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.path.implicit_path import _refuse_unseen
from rigidfluid.core.contact.path.look_ahead import foreseen
from rigidfluid.core.contact.path.substep_path import spring_parts
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import StepRejected

MASS = np.pi * 0.1**2


def simulation(*bodies: dict[str, Any], step: float, end: float, **contact: Any) -> Simulation:
    """With another body, far away on a spring that turns by .49 in a step, which has three parts for that."""
    law = contact or {"law": "normal", "epsilon": 1e-6}
    pulled = ball([0.85, 0.85], [0.0, 0.0], spring={"stiffness": 2 * [MASS * (0.49 / step) ** 2]})
    tables = dry_tables(*bodies, pulled, contact={"range": 0.02, "stepping": "implicit"} | law, end=end, step=step)
    return Simulation(scene_from_dict(tables))


def test_dampers_take_what_they_do_in_all_parts_of_a_step_and_contacts_give_all_their_impulse() -> None:
    """The ball comes to the wall, rubs on it, and goes from it, in one step."""
    given = {"law": "spring-dashpot", "stiffness": 300.0, "restitution": 0.5, "friction": 0.3}
    run = simulation(ball([0.15, 0.4], [-1.0, 0.0], angular_velocity=9.0), step=0.1, end=0.1, **given)
    assert spring_parts(run.system, 0.1) == 3
    run.go()
    state, inertia = run.state, 0.5 * MASS * 0.1**2
    (speed, along), spin = state.twist.velocity[0], state.twist.angular_velocity[0, 0]
    assert 0.0 < speed < 0.99
    assert spin < 8.9
    assert state.count == 1
    lost = 0.5 * MASS * (1.0 - speed**2 - along**2) + 0.5 * inertia * (9.0**2 - spin**2)
    assert state.ledger.contact_loss == pytest.approx(lost, rel=1e-6)
    assert 0.1 * state.contact_wrench.torque[0, 0] == pytest.approx(inertia * (spin - 9.0))
    assert 0.1 * state.contact_wrench.force[0, 0] == pytest.approx(MASS * (1.0 + speed))
    assert 0.1 * state.motions.contact.force[0, 0] == pytest.approx(MASS * (1.0 + speed))


def test_who_pushes_works_in_all_parts_of_a_step_at_the_speed_that_it_has_there() -> None:
    """A piston that is ever faster pushes a ball, which spins besides, along."""
    piston = ball([0.2, 0.4], [0.0, 0.0], prescribed={"amplitude": [0.1, 0.0], "frequency": 1.5})
    del piston["velocity"]
    run = simulation(piston, ball([0.415, 0.4], [0.0, 0.0], angular_velocity=3.0), step=0.05, end=0.15)
    start = run.state.ledger.kinetic + run.state.ledger.contact
    run.go()
    ledger = run.state.ledger
    assert ledger.control > 1e-3
    assert ledger.control == pytest.approx(ledger.kinetic + ledger.contact - start, rel=1e-6)


def test_contacts_with_much_energy_that_nobody_has_followed_reject_the_step() -> None:
    def missing(energy: float) -> Any:
        return SimpleNamespace(missed=lambda law, end: energy)

    for energy in (-2.0, 2.0):
        with pytest.raises(StepRejected, match="came or went"):
            _refuse_unseen(None, missing(energy), None, 1.0)  # type: ignore[arg-type]
    _refuse_unseen(None, missing(0.9), None, 1.0)  # type: ignore[arg-type]


def test_what_a_body_pushed_off_from_rest_may_meet_is_foreseen() -> None:
    """By the energy that its contact stores, at which it would come as far as the next one in the step."""
    first, second = ball([0.2, 0.4], [0.0, 0.0]), ball([0.41, 0.4], [0.0, 0.0])
    third = ball([0.41 + 0.2 + 0.05, 0.4], [0.0, 0.0])
    run = simulation(first, second, third, step=0.1, end=0.1)
    law, dynamics = run.system.law, scheme_of(run.system).bodies_now(run.state, 0.0)
    assert law is not None
    speed = np.sqrt(2.0 * 0.01**3 / (3.0 * 1e-6) / MASS)
    size = 0.035 / speed
    pairs = foreseen(run.system, law, dynamics, size, 0.0).start
    assert (1, 2) in set(zip(pairs.body_a.tolist(), pairs.body_b.tolist(), strict=True))
    quick = foreseen(run.system, law, dynamics, 0.1 * size, 0.0).start
    assert (1, 2) not in set(zip(quick.body_a.tolist(), quick.body_b.tolist(), strict=True))
