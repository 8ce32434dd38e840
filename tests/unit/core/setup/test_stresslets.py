"""Stresslets of bodies: against the stress on walls, against the moment of a pressure that is known, and in files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from falling import SCENES

import rigidfluid
from rigidfluid.api import FluidBackend, model_of
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History
from rigidfluid.errors import SceneError


def sheared(*overrides: str) -> History:
    return rigidfluid.run(rigidfluid.load_scene(SCENES / "sheared_cell.toml", overrides))


def excess(history: History, volume: float) -> tuple[float, float]:
    """Viscosity of the cell less that of the fluid, 1, by the stresslet and by the power of the walls."""
    energy = history.energy
    power = (energy["boundary"][-1] - energy["boundary"][0]) / (energy["time"][-1] - energy["time"][0])
    return history.stresslets["sxy"][-1] / volume, power / volume - 1.0


def test_the_stresslet_is_what_walls_feel_of_a_disk() -> None:
    """The stress of the walls is that of the fluid and the stresslet over the volume: exact for a free body."""
    by_stresslet, by_walls = excess(sheared(), 17.7245**2)
    assert by_stresslet == pytest.approx(by_walls, rel=1e-6)
    assert by_stresslet == pytest.approx(0.02, rel=0.02)


@pytest.mark.long
def test_so_it_is_of_a_sphere() -> None:
    cell = ["scene.dimension=3", f"domain.lower={[0.0] * 3}", f"domain.upper={[8.0] * 3}"]
    walls = ["boundary.1.velocity=[-4.0, 0.0, 0.0]", "boundary.2.velocity=[4.0, 0.0, 0.0]"]
    history = sheared(*cell, *walls, f"body.0.position={[4.0] * 3}", "mesh.size=1.2", "mesh.size_body=0.4")
    by_stresslet, by_walls = excess(history, 8.0**3)
    assert by_stresslet == pytest.approx(by_walls, rel=1e-6)
    assert by_stresslet == pytest.approx(2.5 * 4.0 / 3.0 * np.pi / 8.0**3, rel=0.03)


def scene(**tables: Any) -> rigidfluid.Scene:
    """A closed box 2 by 1 with a fixed disk beside its middle, under a uniform force on the fluid."""
    common: dict[str, Any] = {
        "scene": {"name": "pressed", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.5, "force": [0.3, 0.0]},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
        "body": [{"type": "sphere", "radius": 0.2, "density": 1.0, "position": [0.7, 0.5], "fixed": True}],
        "mesh": {"size": 0.2, "size_body": 0.05},
        "time": {"end": 0.2, "step": 0.05},
        "output": {"every": 0.1, "stresslets": True},
    }
    return scene_from_dict(common | tables)


def test_a_hydrostatic_pressure_has_the_moment_of_its_value_at_the_centre() -> None:
    """p = f (x - x̄) with zero mean over the fluid: S = -p(c) V I."""
    found, disk = rigidfluid.run(scene()).stresslets, np.pi * 0.2**2
    middle = (2.0 * 1.0 - disk * 0.7) / (2.0 - disk)
    wanted = -0.3 * (0.7 - middle) * disk
    for name in ("sxx", "syy"):
        assert found[name][-1] == pytest.approx(wanted, rel=1e-3)
    assert abs(found["sxy"][-1]) < 1e-6


def test_rows_are_resumed_to_the_last_bit(tmp_path: Path) -> None:
    rigidfluid.run(scene(), tmp_path / "whole")
    rigidfluid.run(scene(time={"end": 0.1, "step": 0.05}), tmp_path / "parts")
    rigidfluid.run(scene(), tmp_path / "parts", resume=True)
    whole, parts = ((tmp_path / name / "stresslets.csv").read_bytes() for name in ("whole", "parts"))
    assert whole == parts
    assert whole.count(b"\n") == 5


def test_a_run_that_does_not_want_them_has_none() -> None:
    assert len(rigidfluid.run(scene(output={"every": 0.2})).stresslets["sxy"]) == 0


def test_a_backend_without_them_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "stresslets", FluidBackend.stresslets)
    with pytest.raises(SceneError, match=r"output.stresslets: found true with backend 'scikit-fem'"):
        model_of(scene())
