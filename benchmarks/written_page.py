"""A page that a benchmark writes, with a record of what it was measured by."""

from __future__ import annotations

import datetime
import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from page_tools.record import Record

DOCS = Path(__file__).resolve().parents[1] / "docs"


def measurement(page: Path, rows: Any = None) -> dict[str, Any]:
    """What a page tells: ``rows`` with their date, the machine's load and cores, kept beside the page; without rows,
    what is kept there."""
    kept = page.parent / "measured" / f"{page.stem}.json"
    if rows is not None:
        found = {"date": str(datetime.date.today()), "load": os.getloadavg()[1], "cores": os.cpu_count(), "rows": rows}
        kept.parent.mkdir(exist_ok=True)
        kept.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    told: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
    return told


def write_page(path: Path, text: str, *, kept: bool = False) -> None:
    """Write a page, after its figure; one of docs/validation tells its commit and CPU time, and has a record. Of what
    was ``kept`` they are those of when it was measured."""
    if path.resolve().parent != DOCS / "validation":
        path.write_text(text, encoding="utf-8")
        return
    sys.path.append(str(DOCS))
    from page_tools.provenance import file_digest
    from page_tools.record import read_record

    records = path.parent / "records"
    record = (read_record(path.stem, records) if kept else None) or _record_of_now()
    told = f"Measured: {record.making}; [versions](records/{path.stem}.json)."
    path.write_text(f"{text.rstrip()}\n\n{told}\n", encoding="utf-8")
    record.files.update({file.name: file_digest(file) for file in (path, path.with_suffix(".png")) if file.exists()})
    record.write(path.stem, records)


def _record_of_now() -> Record:
    from page_tools.cpu_time import cpu_seconds
    from page_tools.provenance import commit, source_digest
    from page_tools.record import Record

    from rigidfluid.core.run.summary import versions

    return Record(str(datetime.date.today()), commit(), round(cpu_seconds(), 1), versions(), (source_digest(),))
