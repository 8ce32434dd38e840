"""A force on the fluid alone: what it drives, what it holds up, and its work."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History
from rigidfluid.errors import SceneError

VISCOSITY, FORCE = 0.5, 0.3
PERIODIC = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]


def scene(**tables: Any) -> rigidfluid.Scene:
    """A box 2 by 1 with a fixed disk, if no other body is given."""
    common: dict[str, Any] = {
        "scene": {"name": "forced", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": VISCOSITY, "force": [FORCE, 0.0]},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
        "body": [{"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.7, 0.5], "fixed": True}],
        "mesh": {"size": 0.2, "size_body": 0.05},
        "time": {"end": 0.2, "step": 0.05},
        "output": {"every": 0.2},
    }
    fluid = common["fluid"] | tables.pop("fluid", {})
    return scene_from_dict(common | tables | {"fluid": fluid})


def test_a_uniform_force_in_a_closed_box_lifts_a_body_and_moves_nothing() -> None:
    """Archimedes: p = f·x, and -∮ p n = -f V on the body."""
    history = rigidfluid.run(scene())
    assert history.bodies["fx"][-1] == pytest.approx(-FORCE * np.pi * 0.1**2, rel=5e-4)
    assert abs(history.bodies["fy"][-1]) < 1e-4 * abs(history.bodies["fx"][-1])
    assert history.energy["kinetic"].max() < 1e-12


def steady(**fluid: Any) -> History:
    """A periodic channel round the disk in the flow that stays."""
    return rigidfluid.run(scene(fluid=fluid | {"initial": "steady"}, boundary=PERIODIC))


def test_a_force_drives_a_channel_as_a_drop_of_pressure_does() -> None:
    forced = steady()
    dropped = rigidfluid.run(
        scene(
            fluid={"force": [0.0, 0.0], "initial": "steady"},
            boundary=[PERIODIC[0] | {"pressure_drop": 2.0 * FORCE}, PERIODIC[1]],
        )
    )
    buoyancy = FORCE * np.pi * 0.1**2  # of the force, that the drop of pressure has none of
    assert forced.energy["kinetic"][-1] == pytest.approx(dropped.energy["kinetic"][-1], rel=2e-5)
    assert forced.bodies["fx"][-1] + buoyancy == pytest.approx(dropped.bodies["fx"][-1], rel=1e-4)


def test_the_work_of_the_force_is_what_a_steady_flow_dissipates() -> None:
    energy = steady().energy
    assert energy["dissipation"][-1] > 0.0
    assert energy["body_force"][-1] == pytest.approx(energy["dissipation"][-1], rel=1e-6)
    assert abs(energy["residual"]).max() < 1e-6 * energy["dissipation"][-1]


def test_a_flow_that_a_swinging_force_drives_keeps_its_balance() -> None:
    """Second order: what the balance leaves falls to a quarter at half the step."""
    left = []
    for step in (0.02, 0.01):
        time = {"end": 0.4, "step": step}
        energy = rigidfluid.run(scene(fluid={"force": ["sin(5*t)", 0.0]}, boundary=PERIODIC, time=time)).energy
        left.append(abs(energy["residual"][-1]) / energy["body_force"].max())
    assert left[1] < 0.35 * left[0]
    assert left[0] < 0.02


@pytest.mark.parametrize(
    ("fluid", "message"),
    [
        ({"force": [1.0]}, r"fluid.force: found \[1.0\], 1 of them; allowed is 2 numbers"),
        ({"force": ["x", "u"]}, r"fluid.force.1: found an unknown name"),
        ({"force": [1.0, 0.0], "backend": "dry"}, r"fluid.force: found \[1.0, 0.0\] with backend 'dry'"),
    ],
    ids=["short", "formula", "dry"],
)
def test_a_force_that_cannot_be_is_refused(fluid: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        scene(fluid=fluid)
