"""Parts that lie are named where what they give enters, in a run and in a check, whatever the stepping."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from dry_scenes import ball
from lying_parts import Lie, constraint_lies, lies, wet_lies
from scenes import dry_tables, wet_tables

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import RigidfluidError
from rigidfluid.registry import BODY, DETECTOR, DOMAIN, FLUID_BACKEND, FORCE_LAW, JOINT, MECHANISM, SIZE_FIELD, Registry

DRY, WET = [*lies(), *constraint_lies()], list(wet_lies())
HONEST = Registry.load()
IN_STEPS = {"advance", "unknowns", "memory", "initial"}
"""What a check does not ask."""
APPROACHING = ball([0.3, 0.5], [1.0, 0.0], name="first"), ball([0.54, 0.5], [-1.0, 0.0], name="second")


def tables(lie: Lie) -> dict[str, Any]:
    """The table that names the part that lies."""
    name = lie.part.name
    return {
        FORCE_LAW: {"contact": {"law": name, "range": 0.05}},
        DETECTOR: {
            "contact": {"law": "centre", "range": 0.05, "epsilon": 1e-4, "epsilon_wall": 1e-4, "detector": name}
        },
        BODY: {"body": [APPROACHING[0] | {"type": name}, APPROACHING[1]]},
        DOMAIN: {"domain": {"type": name, "lower": [0.0, 0.0], "upper": [1.0, 1.0]}},
        MECHANISM: {"mechanism": [{"name": "whole", "type": name, "position": [0.5, 0.8]}]},
        JOINT: {"joint": [{"type": name, "between": ["first", "second"], "at": [0.42, 0.5]}]},
        FLUID_BACKEND: {"fluid": {"backend": name}},
        SIZE_FIELD: {"mesh": {"field": [{"type": name}]}},
    }[lie.kind]


def dry(lie: Lie, stepping: str) -> Scene:
    contact = {"law": "centre", "range": 0.05, "epsilon": 1e-4, "epsilon_wall": 1e-4}
    given = {"contact": contact} | tables(lie)
    return scene_from_dict(
        dry_tables(*APPROACHING, end=0.03, **given | {"contact": given["contact"] | {"stepping": stepping}})
    )


@pytest.fixture(autouse=True)
def installed(monkeypatch: pytest.MonkeyPatch) -> None:
    registry = Registry((*HONEST.entries, *(lie.entry for lie in (*DRY, *WET))), ())
    monkeypatch.setattr(Registry, "load", lambda: registry)


def title(lie: Lie) -> str:
    return f"{lie.kind.title}: {lie.part.name}"


def test_there_are_many() -> None:
    assert len(DRY) >= 350
    assert len({title(lie) for lie in (*DRY, *WET)}) == len(DRY) + len(WET)


@pytest.mark.parametrize("lie", DRY, ids=title)
def test_a_lie_is_named(lie: Lie) -> None:
    for stepping in ("substeps", "implicit") if lie.kind in (FORCE_LAW, DETECTOR) else ("substeps",):
        with pytest.raises(RigidfluidError) as told:
            rigidfluid.run(dry(lie, stepping))
        assert lie.told in str(told.value)
    if lie.key in IN_STEPS:
        check(dry(lie, "substeps"))
        return
    with pytest.raises(RigidfluidError) as told:
        check(dry(lie, "substeps"))
    assert lie.told in str(told.value)


@pytest.mark.parametrize("lie", WET, ids=title)
def test_a_lie_in_a_fluid_is_named(lie: Lie, tmp_path: Path) -> None:
    at_rest = ball([0.5, 0.5], [0.0, 0.0], fixed=True)
    del at_rest["velocity"]
    given = wet_tables(at_rest, end=0.01, output={"probes": [[0.2, 0.2]]}, **tables(lie))
    with pytest.raises(RigidfluidError) as told:
        rigidfluid.run(scene_from_dict(given), tmp_path)
    assert lie.told in str(told.value)
