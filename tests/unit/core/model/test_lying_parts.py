"""Parts that lie are named where what they give enters, in a run and in a check, whatever the stepping."""

from __future__ import annotations

from typing import Any

import pytest
from dry_scenes import ball
from lying_parts import Lie, lies
from scenes import dry_tables

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.errors import RigidfluidError
from rigidfluid.registry import BODY, DETECTOR, DOMAIN, FLUID_BACKEND, FORCE_LAW, JOINT, MECHANISM, Registry

LIES = list(lies())
HONEST = Registry.load()
IN_STEPS = {"advance", "unknowns", "memory", "initial", "edge_length"}
"""What a check does not ask, and so may not refuse."""


def scene(lie: Lie | None, stepping: str) -> Any:
    kind, name = (lie.kind, lie.part.name) if lie else (None, "")
    bodies = [ball([0.3, 0.5], [1.0, 0.0], name="first"), ball([0.54, 0.5], [-1.0, 0.0], name="second")]
    contact: dict[str, Any] = {"law": "centre", "range": 0.05, "epsilon": 1e-4, "epsilon_wall": 1e-4}
    more: dict[str, Any] = {}
    if kind is FORCE_LAW:
        contact = {"law": name, "range": 0.05}
    if kind is DETECTOR:
        contact["detector"] = name
    if kind is BODY:
        bodies[0]["type"] = name
    if kind is DOMAIN:
        more["domain"] = {"type": name, "lower": [0.0, 0.0], "upper": [1.0, 1.0]}
    if kind is MECHANISM:
        more["mechanism"] = [{"name": "whole", "type": name, "position": [0.5, 0.8]}]
    if kind is JOINT:
        more["joint"] = [{"type": name, "between": ["first", "second"], "at": [0.42, 0.5]}]
    if kind is FLUID_BACKEND:
        more["fluid"] = {"backend": name}
    return scene_from_dict(dry_tables(*bodies, end=0.03, contact={**contact, "stepping": stepping}, **more))


@pytest.fixture(autouse=True)
def installed(monkeypatch: pytest.MonkeyPatch) -> None:
    registry = Registry((*HONEST.entries, *(lie.entry for lie in LIES)), ())
    monkeypatch.setattr(Registry, "load", lambda: registry)


def named(lie: Lie) -> str:
    return f"{lie.kind.title}: {lie.part.name}"


def test_there_are_many() -> None:
    assert len(LIES) >= 150
    assert len({named(lie) for lie in LIES}) == len(LIES)


@pytest.mark.parametrize("lie", LIES, ids=named)
def test_a_lie_is_named(lie: Lie) -> None:
    for stepping in ("substeps", "implicit") if lie.kind in (FORCE_LAW, DETECTOR) else ("substeps",):
        with pytest.raises(RigidfluidError, match=lie.part.name) as told:
            rigidfluid.run(scene(lie, stepping))
        assert lie.kind.title in str(told.value)
    if lie.key not in IN_STEPS:
        with pytest.raises(RigidfluidError, match=lie.part.name):
            check(scene(lie, "substeps"))
    else:
        check(scene(lie, "substeps"))
