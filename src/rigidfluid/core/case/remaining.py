"""The tables of a scene that can still be read where some of its values are refused."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

_UNASKED = {"fluid": {"backend": "dry"}, "time": {"end": 1.0, "step": 1.0}, "output": {"every": 1.0}}
"""Tables that every scene has, of which nothing more is asked then."""

_LISTS = ("boundary", "body", "mechanism")


def remaining_tables(data: Mapping[str, Any], refused: Iterable[str]) -> tuple[dict[str, Any], dict[str, list[int]]]:
    """Domain, conditions, bodies and mechanisms of a scene without the tables that hold ``refused`` values; and the
    numbers in the whole lists of the entries that are left."""
    entries = {".".join(subject.split(".")[:2]) for subject in refused}
    lists = {key: data[key] for key in _LISTS if isinstance(data.get(key), list)}
    kept = {key: [n for n in range(len(lists[key])) if f"{key}.{n}" not in entries] for key in lists}
    own = {key: data[key] for key in ("scene", "domain") if key in data}
    return {**_UNASKED, **own, **{key: [lists[key][n] for n in kept[key]] for key in lists}}, kept
