"""Stiff contacts that press slowly: Φ varies linearly on the bodies' path."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fluid_contacts import SCENES
from linked_bodies import masses, placed, split

from rigidfluid.core.case.load import load_scene
from rigidfluid.core.contact.path.contact_load import ContactLoad
from rigidfluid.core.contact.path.substep_path import SubstepPath
from rigidfluid.core.coupling import navier_stokes_scheme
from rigidfluid.core.coupling.navier_stokes_scheme import RESOLVED, NavierStokesScheme
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.model.types import Wrench
from rigidfluid.core.run.run import run

STEP = 0.1
ANY: Any = SimpleNamespace()


def varying(
    monkeypatch: pytest.MonkeyPatch, now: list[float], before: list[float], substep: float | None, far: int = 0
) -> list[bool]:
    """Whether Φ varies for each of some bodies that are pressed so ``now``, and in the mean of the step ``before``.

    The last ``far`` of them are near nothing. Without a ``substep`` none may be planned.
    """
    count = len(now)

    def wrench(force: list[float]) -> Wrench:
        return Wrench(np.outer(force, [0.6, 0.8]), np.zeros((count, 1)))

    motions = SingleBodies(
        *masses(count, 2), np.zeros(count, dtype=bool), placed(count, 2), split(np.zeros((count, 3)), 2)
    )
    joints = SimpleNamespace(linked=np.zeros(count, dtype=bool))
    system: Any = SimpleNamespace(motions=motions, law=object(), joints=joints)
    bodies = np.arange(count - far)
    near: Any = SimpleNamespace(body_a=bodies, body_b=np.full(len(bodies), count))
    state: Any = SimpleNamespace(motions=SimpleNamespace(contact=wrench(before)), contacts=ANY, springs=None)
    load = ContactLoad(wrench(now), None, 0.0, 0.0)
    monkeypatch.setattr(navier_stokes_scheme, "contact_load", lambda *_: load)
    plan = None if substep is None else SimpleNamespace(substep=substep)
    monkeypatch.setattr(SubstepPath, "planned", lambda *_: plan)
    found = NavierStokesScheme(system)._varying(state, ANY, near, STEP)
    assert np.all(found == found[:, :1])
    return [bool(each) for each in found[:, 0]]


def test_the_load_varies_for_bodies_that_are_pressed_slowly(monkeypatch):
    now, before = [1.0, 1.0, 1.0, 0.0, 0.0], [0.92, 1.08, 0.85, 0.0, 1.0]
    assert varying(monkeypatch, now, before, STEP / 32) == [True, True, False, False, False]


def test_the_load_varies_for_all_where_the_step_resolves_its_contacts(monkeypatch):
    assert varying(monkeypatch, [0.0, 1.0], [0.0, 0.0], STEP / RESOLVED) == [True, True]


def test_nothing_is_planned_where_all_bodies_near_others_are_pressed_slowly(monkeypatch):
    assert varying(monkeypatch, [1.0, 1.0, 0.0], [0.92, 1.08, 0.0], None, far=1)[:2] == [True, True]


@pytest.mark.long
@pytest.mark.nightly
def test_disks_that_a_flow_presses_together_lose_little_at_their_contact(tmp_path: Path):
    """In the throat of `stenosis`; with a load that is constant in a step it is 2.2 % of the energy at hand."""
    scene = load_scene(SCENES / "stenosis.toml", ["time.end=0.0057", "output.every=0.0057"])
    energy = run(scene, tmp_path).summary["energy"]
    assert energy["largest_loss"] < 6e-3
    assert energy["largest_creation"] < 3e-3
