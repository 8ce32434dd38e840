"""Scenes of runs that are older than a change of the tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def tables_now(stored: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a scene as `Scene.to_dict` writes them now; those of this version are left as they are.

    Conditions of all types once had a ``profile``, which was uniform but for velocities.
    """
    boundary = stored.get("boundary")
    if not isinstance(boundary, list):
        return dict(stored)
    return {**stored, "boundary": [_without_profile(table) for table in boundary]}


def _without_profile(table: Any) -> Any:
    if not isinstance(table, Mapping) or table.get("type") == "velocity" or table.get("profile") != "uniform":
        return table
    return {key: value for key, value in table.items() if key != "profile"}
