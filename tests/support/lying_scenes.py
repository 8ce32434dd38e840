"""Scenes that name a part that lies, and the ways in which a program meets it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dry_scenes import ball
from lying_parts import Lie, constraint_lies, lies, wet_lies
from scenes import dry_tables, wet_tables

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene
from rigidfluid.registry import BODY, DETECTOR, DOMAIN, FLUID_BACKEND, FORCE_LAW, JOINT, MECHANISM, SIZE_FIELD, Registry

DRY, WET = [*lies(), *constraint_lies()], list(wet_lies())
IN_STEPS = {"advance", "unknowns", "memory", "initial"}
"""What a check does not ask."""

APPROACHING = ball([0.3, 0.5], [1.0, 0.0], name="first"), ball([0.54, 0.5], [-1.0, 0.0], name="second")
HONEST = Registry.load()


def with_liars() -> Registry:
    """The registry of all installed parts, and of those that lie."""
    return Registry((*HONEST.entries, *(lie.entry for lie in (*DRY, *WET))), ())


def ways(lie: Lie) -> dict[str, Callable[[], Any]]:
    """Ways to meet a lie, by name: runs by the steppings that ask for it, and a check where that does."""
    if lie in WET:
        return {"run in a fluid": lambda: _run_in_fluid(lie)}
    steppings = ("substeps", "implicit") if lie.kind in (FORCE_LAW, DETECTOR) else ("substeps",)
    runs = {
        f"run by {stepping}": lambda stepping=stepping: rigidfluid.run(_dry(lie, stepping)) for stepping in steppings
    }
    return runs if lie.key in IN_STEPS else {**runs, "check": lambda: checked(lie)}


def checked(lie: Lie) -> None:
    """Check a scene with the part, which the check may not ask."""
    check(_dry(lie, "substeps"))


def _tables(lie: Lie) -> dict[str, Any]:
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


def _dry(lie: Lie, stepping: str) -> Scene:
    contact = {"law": "centre", "range": 0.05, "epsilon": 1e-4, "epsilon_wall": 1e-4}
    given = {"contact": contact} | _tables(lie)
    return scene_from_dict(
        dry_tables(*APPROACHING, end=0.03, **given | {"contact": given["contact"] | {"stepping": stepping}})
    )


def _run_in_fluid(lie: Lie) -> None:
    at_rest = ball([0.5, 0.5], [0.0, 0.0], fixed=True)
    del at_rest["velocity"]
    given = wet_tables(at_rest, end=0.01, output={"probes": [[0.2, 0.2]]}, **_tables(lie))
    with TemporaryDirectory() as folder:
        rigidfluid.run(scene_from_dict(given), Path(folder))
