"""Which bodies were seeded: how many, how densely, and how near to each other?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidfluid.checks.finding import Finding, figure
from rigidfluid.core.scene.swarm_tables import SwarmTable

QUESTION = "swarm"

_WAYS = {
    "insertion": "inserted one by one",
    "growth": "grown until they had their gaps",
    "file": "as they are listed",
}


def swarm_findings(tables: Sequence[SwarmTable]) -> Iterator[Finding]:
    """Report number, fraction of the region's volume and smallest gap of each swarm."""
    for table in tables:
        record = table.seeded
        if record is not None:
            text = f"{record.number} bodies fill {figure(100.0 * record.fraction)} % of their region"
            text += f", with gaps of at least {figure(record.gap)}, {_WAYS[record.way]}"
            yield Finding("note", QUESTION, (table.name,), text, found=record.model_dump())
