"""Puts a run on disk as it goes: tables each step, fields, points and a checkpoint each output, the summary at the end.

Ranks that share a run write each its part of the fields and its checkpoint, and the root all that is there once.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.model.ranks import ALONE, ROOT, Ranks
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.checkpoint import (
    Checkpoint,
    adopt_checkpoint,
    read_checkpoint,
    read_origin,
    read_staged,
    stage_checkpoint,
)
from rigidfluid.core.output.disk import replace_text, writing
from rigidfluid.core.output.output_files import (
    FIELDS,
    present_files,
    require_outputs,
    stem_of_output,
    written_sizes,
)
from rigidfluid.core.output.point_sets import PointSet
from rigidfluid.core.output.records import Records
from rigidfluid.core.output.results_folder import clear, take_folder
from rigidfluid.core.output.run_files import RUN
from rigidfluid.core.output.tables import Prefix, Table, table_path
from rigidfluid.core.output.vtu import DATASETS, FLUID, write_pvd, write_pvtu, write_vtu
from rigidfluid.errors import OutputError

CHECKPOINT, SUMMARY, SERIES = "state.h5", "summary.json", "fields.pvd"


class Writer:
    """Writes the files of one run to the folder ``out``, tables of these columns; every method is called by all
    ranks together.

    All files are started again, unless an earlier run is ``resumed`` from its checkpoint. Every method raises
    OutputError, on all ranks, if the disk refuses on one; so does the start if another run is writing there, or files
    of these names are not a run's.
    """

    def __init__(
        self,
        out: Path,
        columns_by_table: Mapping[str, Sequence[str]],
        resumed: Checkpoint | None,
        ranks: Ranks,
    ) -> None:
        self.out, self.closed, self._ranks = out, False, ranks
        self._tables: dict[str, Table] = {}
        self._mark: TextIO | None = None
        self._series: list[dict[str, str]] = []
        self.sizes: IntArray = np.zeros((0, len(DATASETS)), dtype=np.int64) if resumed is None else resumed.sizes
        with ExitStack() as undo:
            undo.callback(self.close)
            self._start(columns_by_table, resumed)
            undo.pop_all()

    def _start(self, columns_by_table: Mapping[str, Sequence[str]], resumed: Checkpoint | None) -> None:
        out, kept = self.out, {} if resumed is None else resumed.tables
        with self._writing_once(out) as is_mine:
            if is_mine:
                self._mark = _taken(out, new=resumed is None)
                self._series = [] if resumed is None else _series(out, len(resumed.times))
        with self._ranks.raise_on_all(), writing(out):
            require_outputs(out, self.sizes, self._ranks.rank)
        for name, names in columns_by_table.items():
            path = table_path(out, name)
            with self._writing_once(path) as is_mine:
                if is_mine:
                    self._tables[name] = Table(path, names, kept.get(name))
        if resumed is not None:
            self._write_series(resumed.times)

    @property
    def tables(self) -> dict[str, Prefix]:
        """Content of each table, as far as it is written; the root has them all."""
        return {name: table.written for name, table in self._tables.items()}

    def extend(self, records: Records) -> None:
        """Append the rows of one state to their tables."""
        with self._ranks.raise_on_all():
            for name in records.keys() & self._tables.keys():
                with writing(table_path(self.out, name)):
                    self._tables[name].extend(records[name])

    def output(self, fields: Fields | None, points: Mapping[str, PointSet], times: tuple[float, ...]) -> None:
        """Write what there is at the last of ``times``, fields if there are some and ``points`` by name, and the series
        of all of them."""
        stem = stem_of_output(len(times) - 1)
        files = {} if fields is None else {FLUID: self._write_fields(stem, fields)}
        for name, some in points.items():
            files[name] = f"{stem}.{name}.vtu"
            with self._writing_once(self.out / files[name]) as is_mine:
                if is_mine:
                    some.write(self.out / files[name])
        self._series.append(files)
        self.sizes = np.vstack([self.sizes, written_sizes(self.out, len(times) - 1, self._ranks.rank)])
        self._write_series(times)

    def _write_fields(self, stem: str, fields: Fields) -> str:
        """Write the fields of this rank, and return the file in which there are those of all."""
        ranks, whole = self._ranks, f"{stem}.vtu" if self._ranks.size == 1 else f"{stem}.pvtu"
        pieces = [f"{stem}.{rank}.vtu" for rank in range(ranks.size)] if ranks.size > 1 else []
        own = pieces[ranks.rank] if pieces else whole
        with ranks.raise_on_all(), writing(self.out / own):
            write_vtu(self.out / own, fields)
        with self._writing_once(self.out / whole) as is_mine:
            if is_mine and pieces:
                names = [Path(piece).name for piece in pieces]
                write_pvtu(self.out / whole, names, fields)
            elif is_mine:
                (self.out / f"{stem}.pvtu").unlink(missing_ok=True)  # of several ranks that were killed
        return whole

    def _write_series(self, times: Sequence[float]) -> None:
        with self._writing_once(self.out / SERIES) as is_mine:
            if is_mine:
                write_pvd(self.out / SERIES, times, self._series)

    def checkpoint(self, checkpoint: Checkpoint) -> None:
        """Replace the checkpoint, no rank before all have written theirs."""
        path = self.out / checkpoint_name(self._ranks.rank)
        for work in (partial(stage_checkpoint, path, checkpoint), partial(adopt_checkpoint, path)):
            with self._ranks.raise_on_all(), writing(path):
                work()
        with self._writing_once(self.out) as is_mine:
            for stale in _checkpoints(self.out)[self._ranks.size :] if is_mine else ():
                stale.unlink()  # of more ranks that wrote before

    def summary(self, summary: dict[str, Any]) -> None:
        """Write the summary."""
        with self._writing_once(self.out / SUMMARY) as is_mine:
            if is_mine:
                replace_text(self.out / SUMMARY, json.dumps(summary, indent=2) + "\n")

    def close(self) -> None:
        """Let other runs write to the folder."""
        self.closed = True
        if self._mark is not None:
            self._mark.close()

    @property
    def files(self) -> list[str]:
        """The files of a finished run; those of output times are listed in the series."""
        checkpoints = [checkpoint_name(rank) for rank in range(self._ranks.size)]
        names = [*(f"{name}.csv" for name in self._tables), SERIES, *checkpoints]
        present = [str(self.out / name) for name in names if (self.out / name).exists()]
        return self._ranks.bcast([*present, str(self.out / SUMMARY)])

    @contextmanager
    def _writing_once(self, path: Path) -> Iterator[bool]:
        """Tell whether this rank writes a file shared by all ranks; a failure raises on all."""
        with self._ranks.raise_on_all(), writing(path):
            yield self._ranks.is_root


def _taken(out: Path, new: bool) -> TextIO:
    """The folder's lock; of an earlier run there only what is not to be written by a ``new`` one is left."""
    mark = take_folder(out, RUN, new=new)
    if new:
        clear(out, RUN)
    (out / FIELDS).mkdir(exist_ok=True)
    return mark


def has_checkpoint(out: Path) -> bool:
    """Tell whether there is a checkpoint in a folder; raises OutputError where no folder can have that name."""
    with writing(out):
        return (out / CHECKPOINT).exists()


def checkpoint_name(rank: int) -> str:
    """The file of one rank's checkpoint."""
    return CHECKPOINT if rank == ROOT else f"state.{rank}.h5"


def ranks_of_run(out: Path) -> int:
    """Number of ranks that have written the latest checkpoint in a folder; raises OutputError where there is none."""
    latest, count = read_origin(out / CHECKPOINT)
    for path in _checkpoints(out)[1:]:
        latest, count = max((latest, count), read_origin(path))
    return count


def earlier_run(out: Path, ranks: Ranks) -> Checkpoint:
    """Read this rank's checkpoint of the run in a folder, of as many ranks; called by all of them together.

    Raises OutputError where there is none, or the ranks' files are not of one time.
    """
    path = out / checkpoint_name(ranks.rank)
    for my_turn in (ranks.is_root, not ranks.is_root):
        with ranks.raise_on_all():
            if my_turn:
                checkpoint = read_checkpoint(path, ranks)
    latest = int(ranks.greatest(checkpoint.state.tick))
    with ranks.raise_on_all():
        return _checkpoint_of_tick(latest, path, checkpoint, ranks)


def earlier_parts(out: Path, count: int) -> list[Checkpoint]:
    """The checkpoints of all ``count`` ranks that have written a run, in one process; raises as `earlier_run`."""
    parts = [read_checkpoint(out / checkpoint_name(rank)) for rank in range(count)]
    latest = max(part.state.tick for part in parts)
    return [_checkpoint_of_tick(latest, out / checkpoint_name(rank), part, ALONE) for rank, part in enumerate(parts)]


def _checkpoint_of_tick(latest: int, path: Path, checkpoint: Checkpoint, ranks: Ranks) -> Checkpoint:
    """Checkpoint of the ``latest`` tick: the one given, or the one that was staged for its place."""
    tick = checkpoint.state.tick
    return checkpoint if tick == latest else _caught_up(path, tick, latest, ranks)


def _caught_up(path: Path, tick: int, latest: int, ranks: Ranks) -> Checkpoint:
    """The ``latest`` of a run killed while its ranks replaced their checkpoints; all had staged it before one did."""
    try:
        staged = read_staged(path, ranks)
    except OutputError:
        staged = None
    if staged is None or staged.state.tick != latest:
        found = f"checkpoints of different times, {tick} and {latest} shortest steps after the start"
        raise OutputError(str(path.parent), found, "one time in the files of all processes", "Run without --resume.")
    with writing(path):
        adopt_checkpoint(path)
    return staged


def _checkpoints(out: Path) -> list[Path]:
    """Paths of all ranks' checkpoints, in their order."""
    others = {int(path.name.split(".")[1]): path for path in out.glob("state.*.h5")}
    return [out / CHECKPOINT, *(others[rank] for rank in sorted(others))]


def _series(out: Path, count: int) -> list[dict[str, str]]:
    """The files of the first ``count`` output times of a run, as far as they are in its folder."""
    return [present_files(out, number) for number in range(count)]
