"""Tables of scenes in a box of side 1: what a test does not care about has a default here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Table = dict[str, Any]
COMPLETED = ("scene", "fluid", "mesh", "time", "output")
"""Tables whose keys are added to the defaults; all others take their place."""


def dry_tables(*bodies: Table, end: float = 1.0, step: float = 0.01, **tables: Any) -> Table:
    """Tables of bodies without a fluid."""
    return _box(bodies, tables, end, step) | _completed(tables, {"fluid": {"backend": "dry"}})


def wet_tables(*bodies: Table, end: float = 1.0, step: float = 0.01, **tables: Any) -> Table:
    """Tables of bodies in a fluid of density 1 and viscosity .1, on a coarse mesh."""
    wet = {"fluid": {"density": 1.0, "viscosity": 0.1}, "mesh": {"size": 0.2, "size_body": 0.1}}
    return _box(bodies, tables, end, step) | _completed(tables, wet)


def _box(bodies: Sequence[Table], tables: Table, end: float, step: float) -> Table:
    """Tables that dry and wet scenes share, with ``tables`` in them or in their place."""
    dimension = len((*bodies, *tables.get("mechanism", ()))[0]["position"])
    box = {
        "scene": {"name": "box", "dimension": dimension},
        "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
        "body": list(bodies),
        "time": {"end": end, "step": step},
        "output": {"every": end},
    }
    return box | tables | _completed(tables, {name: box[name] for name in box if name in COMPLETED})


def _completed(tables: Table, defaults: Table) -> Table:
    """``defaults`` with the keys that ``tables`` give."""
    return {name: table | tables.get(name, {}) for name, table in defaults.items()}
