"""Are there conditions that later ones override everywhere?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidfluid.checks.finding import Finding
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.scene.boundary_tables import BoundaryTable

QUESTION = "boundary"


def overridden_findings(tables: Sequence[BoundaryTable], domain: Domain) -> Iterator[Finding]:
    """Report tables of conditions without effect: on all surfaces that they name, later ones apply."""
    last = {piece.name: -1 for piece in domain.pieces}
    named = [[piece.name for piece in domain.pieces if table.on in (*piece.all_names, "all")] for table in tables]
    for number, surfaces in enumerate(named):
        last |= dict.fromkeys(surfaces, number)
    for number, surfaces in enumerate(named):
        if number not in last.values():
            later = " and ".join(f"boundary.{other}" for other in sorted({last[name] for name in surfaces}))
            text = f"boundary.{number}, {tables[number].type!r} on {tables[number].on!r}, has no effect, as {later}"
            yield Finding("note", QUESTION, tuple(surfaces), f"{text} overrides it")
