"""Stiff contacts that press slowly: Φ varies linearly on the bodies' path."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fluid_contacts as scenes
import numpy as np
import pytest
from fluid_contacts import Stepping
from linked_bodies import masses, placed, split

from rigidfluid.core.contact.contact_load import ContactLoad
from rigidfluid.core.contact.substep_path import SubstepPath
from rigidfluid.core.coupling import navier_stokes_scheme
from rigidfluid.core.coupling.navier_stokes_scheme import RESOLVED, NavierStokesScheme
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.model.types import Wrench
from rigidfluid.core.run.run import run

STEP = 0.1
ANY: Any = SimpleNamespace()


def varying(monkeypatch: pytest.MonkeyPatch, now: list[float], before: list[float], substep: float) -> list[bool]:
    """Whether Φ varies for each of some bodies that are pressed so ``now``, and in the mean of the step ``before``."""
    count = len(now)

    def wrench(force: list[float]) -> Wrench:
        return Wrench(np.outer(force, [0.6, 0.8]), np.zeros((count, 1)))

    motions = SingleBodies(
        *masses(count, 2), np.zeros(count, dtype=bool), placed(count, 2), split(np.zeros((count, 3)), 2)
    )
    system: Any = SimpleNamespace(motions=motions, law=object())
    state: Any = SimpleNamespace(motions=SimpleNamespace(contact=wrench(before)), contacts=ANY)
    load = ContactLoad(wrench(now), None, 0.0, 0.0)
    monkeypatch.setattr(navier_stokes_scheme, "contact_load", lambda *_: load)
    monkeypatch.setattr(SubstepPath, "planned", lambda *_: SimpleNamespace(substep=substep))
    found = NavierStokesScheme(system)._varying(state, ANY, ANY, STEP)
    assert np.all(found == found[:, :1])
    return [bool(each) for each in found[:, 0]]


def test_the_load_varies_for_bodies_that_are_pressed_slowly(monkeypatch):
    now, before = [1.0, 1.0, 1.0, 0.0, 0.0], [0.8, 1.2, 0.7, 0.0, 1.0]
    assert varying(monkeypatch, now, before, STEP / 32) == [True, True, False, False, False]


def test_the_load_varies_for_all_where_the_step_resolves_its_contacts(monkeypatch):
    assert varying(monkeypatch, [0.0, 1.0], [0.0, 0.0], STEP / RESOLVED) == [True, True]


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_a_disk_let_down_on_a_stiff_floor_loses_next_to_nothing_on_its_path(tmp_path: Path, stepping: Stepping):
    """With a constant load the path takes 1.6e-4, and contacts lose 4e-4 more."""
    energy = run(scenes.let_down(0.005, stepping), tmp_path).energy
    lost = np.diff(energy["residual_contacts"])
    assert energy["contact"][-1] > 0.012
    assert energy["path_friction"][-1] < 8e-5
    assert lost[lost > 0.0].sum() < 1.2e-4
