"""Whole runs with slip on curved walls and pressure on the ends: energy, resumed runs, and who takes them."""

from __future__ import annotations

from pathlib import Path

import pytest
from models import with_backend
from throat import SLIPPERY, throat

from rigidfluid.backends.dolfinx.backend import Dolfinx
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.run.run import run
from rigidfluid.errors import SceneError


@pytest.mark.long
def test_a_disk_goes_through_a_slippery_throat_and_the_energy_balance_closes() -> None:
    """Of second order in the step; and walls without slip hold the fluid back."""
    coarse, fine = (run(throat(SLIPPERY, step=step)) for step in (0.04, 0.02))
    assert coarse.bodies["x"][-1] > 0.0
    assert coarse.summary["remeshes"] > 1
    left = [abs(each.energy["residual"][-1]) / each.energy["boundary"][-1] for each in (coarse, fine)]
    assert left[1] < 5e-4
    assert left[0] > 3.0 * left[1]
    held = run(throat(SLIPPERY[1:]))
    assert held.bodies["x"][-1] < coarse.bodies["x"][-1] - 0.03


def test_a_run_with_slip_on_curved_walls_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    run(throat(SLIPPERY), tmp_path / "whole")
    run(throat(SLIPPERY, end=0.4), tmp_path / "parts")
    run(throat(SLIPPERY), tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_backend_without_oblique_faces_refuses_them_by_name() -> None:
    with pytest.raises(SceneError, match=r"boundary.0.type: found 'slip' on 'bottom_bump', .* backend 'dolfinx'"):
        with_backend(model_of(throat(SLIPPERY)), Dolfinx)
    with_backend(model_of(throat(SLIPPERY[1:])), Dolfinx)
