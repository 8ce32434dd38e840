"""The results of a run in memory: the same tables and summary that the writer puts on disk."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.records import Records, columns


@dataclass
class History:
    """Tables ``bodies``, ``contacts``, ``energy`` and ``probes``, and the ``summary`` of summary.json.

    Parameters
    ----------
    dimension : int
        2 or 3; it decides the columns.
    """

    dimension: int
    records: Records = field(default_factory=dict)
    summary: dict[str, Any] = field(default_factory=dict)

    def extend(self, records: Records) -> None:
        """Append the rows of one state."""
        for name, rows in records.items():
            self.records.setdefault(name, []).extend(rows)

    def table(self, name: str) -> dict[str, NDArray[Any]]:
        """One table as arrays by column name, a row per entry."""
        names = columns(self.dimension)[name]
        rows = self.records.get(name, [])
        return {column: np.array([row[i] for row in rows]) for i, column in enumerate(names)}

    @property
    def bodies(self) -> dict[str, NDArray[Any]]:
        """The table of bodies.csv: a row per body and accepted step."""
        return self.table("bodies")

    @property
    def contacts(self) -> dict[str, NDArray[Any]]:
        """The table of contacts.csv: a row per contact within range."""
        return self.table("contacts")

    @property
    def energy(self) -> dict[str, NDArray[Any]]:
        """The table of energy.csv: a row per accepted step."""
        return self.table("energy")

    @property
    def probes(self) -> dict[str, NDArray[Any]]:
        """The table of probes.csv: a row per probe and accepted step."""
        return self.table("probes")
