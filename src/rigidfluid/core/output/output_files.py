"""Files of fields and points of a run's output times: their names, and whether they are still as they were written."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.output.vtu import DATASETS, FLUID
from rigidfluid.errors import OutputError

FIELDS = "fields"
"""The folder of these files, in that of the run."""


def stem_of_output(number: int) -> str:
    """Path in the run's folder of the files of one output time, but for what follows its first dot."""
    return f"{FIELDS}/{number:06d}"


def present_files(out: Path, number: int) -> dict[str, str]:
    """The files of one output time by what is in them, as far as there are such; several ranks have listed their
    fields."""
    stem = stem_of_output(number)
    listed = f"{stem}.pvtu"
    files = {FLUID: listed if (out / listed).exists() else f"{stem}.vtu"}
    files |= {name: f"{stem}.{name}.vtu" for name in DATASETS if name != FLUID}
    return {name: file for name, file in files.items() if (out / file).exists()}


def written_sizes(out: Path, number: int, rank: int) -> IntArray:
    """Bytes of the files (DATASETS,) that a ``rank`` has written at one output time, 0 of those it has not."""
    found = np.zeros(len(DATASETS), dtype=np.int64)
    for place, path in enumerate(_own_files(out, number, rank)):
        found[place] = path.stat().st_size if path.exists() else 0
    return found


def require_outputs(out: Path, sizes: IntArray, rank: int) -> None:
    """Raise OutputError where files that a ``rank`` has written have other ``sizes`` (times, DATASETS) now."""
    for number, row in enumerate(sizes.tolist()):
        for path, size in zip(_own_files(out, number, rank), row, strict=False):
            found = path.stat().st_size if path.is_file() else None
            if size and found != size:
                told = "no such file" if found is None else f"{found} bytes"
                remedy = "Restore the file, or run without --resume."
                raise OutputError(str(path), told, f"the {size} bytes that the run has written", remedy)


def _own_files(out: Path, number: int, rank: int) -> list[Path]:
    """The fields of a rank's cells, alone or as one of several, and the points, which the first rank writes."""
    stem = stem_of_output(number)
    fields = f"{stem}.{rank}.vtu" if (out / f"{stem}.pvtu").exists() else f"{stem}.vtu"
    points = [f"{stem}.{name}.vtu" for name in DATASETS if name != FLUID]
    return [out / name for name in (fields, *(points if rank == 0 else ()))]
