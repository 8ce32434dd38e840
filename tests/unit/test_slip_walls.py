"""Whole runs with slip on curved walls and pressure on the ends: energy, resumed runs, and who takes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from rigidfluid.backends.dolfinx.backend import Dolfinx
from rigidfluid.core.run.run import run
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.load import scene_from_dict
from rigidfluid.core.setup.parts import known_parts
from rigidfluid.core.setup.scene_checks import check_fluid
from rigidfluid.errors import SceneError

SLIPPERY = [
    {"on": "all", "type": "slip"},
    {"on": "left", "type": "pressure", "pressure": 10.0},
    {"on": "right", "type": "pressure", "pressure": 0.0},
]


def throat(boundary: list[dict[str, Any]], end: float = 1.2, step: float = 0.04) -> Scene:
    """A disk that pressure takes through the throat of a channel with round bumps."""
    return scene_from_dict(
        {
            "scene": {"name": "throat", "dimension": 2},
            "domain": {"type": "stenosis", "length": 6.0, "width": 3.0, "radius": 0.8},
            "fluid": {"density": 1.0, "viscosity": 0.1},
            "body": [{"type": "sphere", "radius": 0.3, "density": 1.5, "position": [-1.2, 0.1]}],
            "contact": {},
            "boundary": boundary,
            "mesh": {"size": 0.4, "size_body": 0.12},
            "time": {"end": end, "step": step},
            "output": {"every": 0.4},
        }
    )


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
    scene = throat(SLIPPERY)
    with pytest.raises(SceneError, match=r"boundary.0.type: found 'slip' on 'bottom_bump', .* backend 'dolfinx'"):
        check_fluid(scene, Dolfinx, known_parts(scene).domain)
    check_fluid(throat(SLIPPERY[1:]), Dolfinx, known_parts(scene).domain)
