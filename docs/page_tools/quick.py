"""The quick pages, which `make pages` makes again: the cheapest ones that fit into forty minutes of two cores."""

from __future__ import annotations

from pathlib import Path

from page_tools.make import TESTS, WITH_DOLFINX
from page_tools.places import RECORDS, generators
from page_tools.record import read_record

SECONDS = 2 * 40 * 60.0
"""CPU time of all [s]."""
OTHERS = (*WITH_DOLFINX, TESTS)
"""Pages that are not made again to be compared."""


def quick(records: Path = RECORDS) -> list[str]:
    """Their names, by the CPU time that is recorded of them, the cheapest first."""
    known = {name: read_record(name, records) for name in generators() if name not in OTHERS}
    costs = {name: one.cpu_seconds for name, one in known.items() if one is not None and one.cpu_seconds is not None}
    chosen, spent = [], 0.0
    for name in sorted(costs, key=costs.__getitem__):
        spent += costs[name]
        if spent <= SECONDS:
            chosen.append(name)
    return chosen
