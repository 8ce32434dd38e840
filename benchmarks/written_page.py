"""A page that a benchmark writes, with a record of what it was measured by."""

from __future__ import annotations

import datetime
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1] / "docs"


def write_page(path: Path, text: str) -> None:
    """Write a page, after its figure; one of docs/validation tells its commit and CPU time, and has a record."""
    if path.resolve().parent != DOCS / "validation":
        path.write_text(text, encoding="utf-8")
        return
    sys.path.append(str(DOCS))
    from page_tools.cpu_time import cpu_seconds
    from page_tools.provenance import commit, file_digest, source_digest
    from page_tools.record import Record

    from rigidfluid.core.run.summary import versions

    record = Record(str(datetime.date.today()), commit(), round(cpu_seconds(), 1), versions(), (source_digest(),))
    told = f"Written: {record.making}; [versions](records/{path.stem}.json)."
    path.write_text(f"{text.rstrip()}\n\n{told}\n", encoding="utf-8")
    record.files.update({file.name: file_digest(file) for file in (path, path.with_suffix(".png")) if file.exists()})
    record.write(path.stem, path.parent / "records")
