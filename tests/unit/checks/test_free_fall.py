"""The warning of bodies that fall with a fluid that nothing holds."""

from __future__ import annotations

from typing import Any

import pytest

from rigidfluid import scene_from_dict
from rigidfluid.checks.report import check

ALL: list[dict[str, Any]] = [{"on": "all", "type": "periodic"}]
DISK = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.5, 0.5]}
POST = DISK | {"name": "post", "position": [0.2, 0.2], "fixed": True}


def warnings(boundary: list[dict[str, Any]], *more: dict[str, Any], **fluid: Any) -> list[str]:
    tables = {
        "scene": {"name": "falls", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.1, "gravity": [0.0, -1.0]} | fluid,
        "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        "boundary": boundary,
        "body": [DISK, *more],
        "mesh": {"size": 0.2, "size_body": 0.05},
        "time": {"end": 0.1, "step": 0.01},
        "output": {"every": 0.1},
    }
    return [one.remedy for one in check(scene_from_dict(tables)).findings if one.question == "free-fall"]


def test_a_fluid_that_nothing_holds_is_told_with_the_axis() -> None:
    assert ["Hold the flux across y" in remedy for remedy in warnings(ALL)] == [True]
    assert ["Hold the flux across x" in remedy for remedy in warnings(ALL, gravity=[1.0, 0.1])] == [True]


def test_a_flux_held_along_the_walls_of_nothing_does_not_help() -> None:
    assert warnings([*ALL, {"on": "left", "type": "periodic", "flux": 0.0}])


@pytest.mark.parametrize(
    ("boundary", "bodies", "fluid"),
    [
        ([*ALL, {"on": "bottom", "type": "periodic", "flux": 0.0}], (), {}),
        ([*ALL, {"on": "bottom", "type": "periodic", "pressure_drop": 0.03}], (), {}),
        (ALL, (POST,), {}),
        (ALL, (), {"gravity": [0.0, 0.0]}),
        (ALL, (), {"force": [0.0, 0.1]}),
        ([{"on": side, "type": "periodic"} for side in ("left", "right")], (), {}),
    ],
    ids=["flux", "drop", "post", "no weight", "force", "walls"],
)
def test_what_is_held_or_weighs_nothing_is_not(
    boundary: list[dict[str, Any]], bodies: tuple[dict[str, Any], ...], fluid: dict[str, Any]
) -> None:
    assert warnings(boundary, *bodies, **fluid) == []
