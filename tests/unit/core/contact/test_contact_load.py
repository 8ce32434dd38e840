"""What contacts give bodies, what they take, and who pays: power of all forces at one moment."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.path.contact_load import contact_load, damping_loss
from rigidfluid.core.contact.path.look_ahead import look_ahead
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.mechanics.wrenches import power
from rigidfluid.core.run.simulation import Simulation

BALL = {"type": "sphere", "radius": 0.1, "density": 1.0}
BODIES: list[dict[str, Any]] = [
    BALL | {"position": [0.5, 0.105], "velocity": [0.3, -0.2], "angular_velocity": 4.0},
    BALL | {"position": [0.705, 0.11], "prescribed": {"velocity": [-0.4, 0.1], "angular_velocity": -2.0}},
]
LAW = {"law": "spring-dashpot", "range": 0.02, "stiffness": 400.0, "damping": 1.5, "friction": 0.7}
BELT = {"on": "bottom", "type": "wall", "velocity": [0.6, 0.0]}


FILM = {"law": "lubrication", "range": 0.02, "viscosity": 0.3, "cutoff": 1e-3, "sliding": True}
DRUM = {"on": "drum", "type": "wall", "angular_velocity": 7.0, "centre": [0.4, 0.285]}
ROUND = {"name": "drum", "type": "sphere", "radius": 0.1, "position": [0.4, 0.285]}
CHANNEL = {"type": "channel", "lower": [0.0, 0.0], "upper": [1.0, 1.0], "obstacle": [ROUND]}


@pytest.mark.parametrize("law", [LAW, FILM], ids=["springs", "film"])
@pytest.mark.parametrize("boundary", [[], [BELT], [BELT, DRUM]], ids=["still", "belt", "belt and drum"])
def test_drives_and_belts_give_what_bodies_gain_dampers_take_and_springs_store(
    boundary: list[dict[str, Any]], law: dict[str, Any]
) -> None:
    domain = {"domain": CHANNEL} if DRUM in boundary else {}
    scene = scene_from_dict(dry_tables(*BODIES, contact=law, boundary=boundary, **domain))
    system, run = build_system(scene), Simulation(scene)
    assert system.law is not None
    dynamics = scheme_of(system).bodies_now(run.state, 0.0)
    contacts = look_ahead(system, dynamics, 1e-3).contacts_at(dynamics.pose)
    assert np.sum(contacts.gap < 0.02) >= 3 + (DRUM in boundary)
    load = contact_load(system, system.law, contacts, dynamics)
    assert load.damping is not None
    assert (load.damping.couple is not None) == (law is FILM)
    gained = power(load.wrench, dynamics.twist)[0]
    step = 1e-6
    before = system.law.energy(contacts).sum()
    dynamics.drift(step)
    moved = look_ahead(system, dynamics, 1e-3).contacts_at(dynamics.pose)
    stored = (system.law.energy(moved).sum() - before) / step
    assert load.loss > 0.0
    assert load.actuator_work == pytest.approx(gained + load.loss + stored, rel=1e-3)
    again = scheme_of(system).bodies_now(run.state, 0.0)
    assert damping_loss(system, contacts, again, load.damping) == pytest.approx(load.loss)
