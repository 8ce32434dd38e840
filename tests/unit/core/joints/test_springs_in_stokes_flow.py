"""Springs of bodies with next to no mass in a fluid without inertia: they relax against its resistance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.output.history import History
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import SceneError

STIFFNESS, REST = 2.0, 0.02


def chain(joint: dict[str, Any], step: float, model: str = "stokes") -> Scene:
    """Two disks in a row, joined by a hinge half-way between them."""
    disk = {"type": "sphere", "radius": 0.2, "density": 1e-6}
    hinge = {"name": "knee", "type": "hinge", "between": ["one", "two"], "at": [1.0, 1.0]}
    return scene_from_dict(
        {
            "scene": {"name": "chain", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 1.0, "model": model},
            "domain": {"lower": [0.0, 0.0], "upper": [2.0, 2.0]},
            "body": [disk | {"name": "one", "position": [0.7, 1.0]}, disk | {"name": "two", "position": [1.3, 1.0]}],
            "joint": [hinge | joint],
            "contact": {},
            "mesh": {"size": 0.3, "size_body": 0.1},
            "time": {"end": 0.3, "step": step},
            "output": {"every": 1.0},
        }
    )


def bent(step: float) -> History:
    return rigidfluid.run(chain({"stiffness": STIFFNESS, "rest_angle": REST}, step))


def resistance(history: History) -> float:
    """Of the hinge, from the rate at which its spring relaxes."""
    joint = history.table("joints")
    time, left = np.asarray(joint["time"]), REST - np.asarray(joint["angle"])
    first, last = np.searchsorted(time, [0.1, 0.3 - 1e-9])
    return float(STIFFNESS * (time[last] - time[first]) / np.log(left[first] / left[last]))


def test_a_chain_without_mass_relaxes_at_the_rate_of_its_own_resistance_to_second_order() -> None:
    """Its resistance is the torque of a drive over its rate; springs of these masses alone turn by 30 in a step."""
    drive = {"piecewise": [[0.0, 0.0], [1.0, REST], [2.0, 0.0]]}
    driven = rigidfluid.run(chain({"drive": drive}, 0.02)).table("joints")
    exact = driven["t"][-1] / driven["rate"][-1]
    coarse, fine = (abs(resistance(bent(step)) / exact - 1.0) for step in (0.02, 0.01))
    assert coarse < 0.015
    assert fine < 0.3 * coarse


def test_a_spring_too_stiff_for_the_resistance_is_refused_and_the_step_named_is_taken() -> None:
    stiff = {"stiffness": 100.0 * STIFFNESS}
    with pytest.raises(SceneError, match="stiffest spring") as refused:
        build_system(chain(stiff, 0.02))
    allowed = float(str(refused.value.allowed).split()[2].strip(","))
    assert allowed == pytest.approx(0.5 * 4.0 * np.pi * 0.04 / (2.0 * 100.0 * STIFFNESS), rel=0.01)
    assert build_system(chain(stiff, 0.99 * allowed)).joints.linked.any()


def test_in_a_fluid_with_inertia_the_masses_count() -> None:
    with pytest.raises(SceneError, match="stiffest spring"):
        build_system(chain({"stiffness": STIFFNESS}, 0.02, model="navier-stokes"))
