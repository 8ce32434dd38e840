"""Puts a run on disk as it goes: tables each step, fields and a checkpoint each output, the summary at the end."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rigidfluid.core.checkpoint import Checkpoint, read_checkpoint, write_checkpoint
from rigidfluid.core.records import Records, columns
from rigidfluid.core.tables import Table, read_rows
from rigidfluid.core.types import Fields
from rigidfluid.core.vtu import write_pvd, write_vtu
from rigidfluid.errors import OutputError

CHECKPOINT, SUMMARY, SERIES, FIELDS = "state.h5", "summary.json", "fields.pvd", "fields"


class Writer:
    """The files of one run.

    Parameters
    ----------
    out : Path
        Their folder; made if it is not there.
    dimension : int
        2 or 3.
    resumed : Checkpoint or None
        Where an earlier run is taken up; None starts all files anew.

    Raises
    ------
    OutputError
        From every method, where the disk refuses.
    """

    def __init__(self, out: Path, dimension: int, resumed: Checkpoint | None) -> None:
        self.out = out
        with writing(out):
            (out / FIELDS).mkdir(parents=True, exist_ok=True)
            if resumed is None:
                _clear(out)
        lengths = {} if resumed is None else resumed.lengths
        self._tables = {}
        for name, names in columns(dimension).items():
            with writing(out / f"{name}.csv"):
                self._tables[name] = Table(out / f"{name}.csv", names, lengths.get(name))

    @property
    def lengths(self) -> dict[str, int]:
        """Bytes in each table."""
        return {name: table.length for name, table in self._tables.items()}

    def records(self) -> Records:
        """The rows that are on disk."""
        return {name: read_rows(self.out / f"{name}.csv") for name in self._tables}

    def extend(self, records: Records) -> None:
        """Append the rows of one state."""
        for name, rows in records.items():
            with writing(self.out / f"{name}.csv"):
                self._tables[name].extend(rows)

    def fields(self, fields: Fields, times: tuple[float, ...]) -> None:
        """Write the fields of the last of ``times``, and the series of all of them."""
        names = [f"{FIELDS}/{i:06d}.vtu" for i in range(len(times))]
        with writing(self.out / names[-1]):
            write_vtu(self.out / names[-1], fields)
            write_pvd(self.out / SERIES, times, names)

    def checkpoint(self, checkpoint: Checkpoint) -> None:
        """Replace the checkpoint."""
        with writing(self.out / CHECKPOINT):
            write_checkpoint(self.out / CHECKPOINT, checkpoint)

    def summary(self, summary: dict[str, Any]) -> None:
        """Write the summary."""
        with writing(self.out / SUMMARY):
            (self.out / SUMMARY).write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")

    @property
    def files(self) -> list[str]:
        """The files of a finished run; those with fields are listed in the series."""
        names = [*(f"{name}.csv" for name in self._tables), SERIES, CHECKPOINT]
        return [str(self.out / name) for name in names if (self.out / name).exists()] + [str(self.out / SUMMARY)]


def earlier_run(out: Path) -> Checkpoint:
    """The checkpoint of the run in a folder; raises OutputError where there is none."""
    return read_checkpoint(out / CHECKPOINT)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn the operating system's refusal into an OutputError that names the file."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            str(path),
            error.strerror or str(error),
            "a folder that can be written to, on a disk with room",
            "Choose another --out, or make room and go on with --resume.",
        ) from error


def _clear(out: Path) -> None:
    """Remove an earlier run's files, so that two runs never mix."""
    for name in (CHECKPOINT, SUMMARY, SERIES):
        (out / name).unlink(missing_ok=True)
    for file in (out / FIELDS).glob("*.vtu"):
        file.unlink()
    (out / "report.html").unlink(missing_ok=True)
    shutil.rmtree(out / "report", ignore_errors=True)
