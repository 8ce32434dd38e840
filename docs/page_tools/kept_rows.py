"""Rows that a page measures itself, kept beside the page, so that it can be written again without measuring."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from page_tools.made import Made

Row = Mapping[str, Any]
"""What JSON can hold: no infinities."""


@dataclass(frozen=True)
class KeptRows:
    """What was measured, and what has ``made`` it."""

    made: Made
    rows: list[Row]

    @classmethod
    def read(cls, path: Path) -> KeptRows:
        """What a file holds."""
        told = json.loads(path.read_text(encoding="utf-8"))
        return cls(Made.of(told["made"]), told["rows"])

    def write(self, path: Path) -> None:
        """Write it, a row a line."""
        lines = ",\n".join(f"  {json.dumps(row, ensure_ascii=False, allow_nan=False)}" for row in self.rows)
        path.parent.mkdir(parents=True, exist_ok=True)
        made = json.dumps(asdict(self.made))
        path.write_text(f'{{\n "made": {made},\n "rows": [\n{lines}\n ]\n}}\n', encoding="utf-8")
