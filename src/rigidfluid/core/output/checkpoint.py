"""A state on disk: every array of the record tree, by its path, in one sealed HDF5 file that is replaced as a whole.

Each rank has a file of its own. The ranks themselves are not stored: who reads a part of a mesh names them.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.model.ranks import ALONE, Ranks
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import FluidState
from rigidfluid.core.output.checkpoint_checks import json_table, require_sound
from rigidfluid.core.output.disk import replace_file
from rigidfluid.core.output.extremes import Extremes
from rigidfluid.core.output.result_file import require_result
from rigidfluid.core.output.sealed_file import BLOCK, is_intact, is_sealed, seal
from rigidfluid.core.output.stored_records import Misfit, load, load_value, store
from rigidfluid.core.output.tables import Prefix
from rigidfluid.errors import OutputError

FORMAT = 20
"""Number of the checkpoint's format, raised with each change of the records, the backend's memory or the tables'
columns; files of other formats are refused."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """Data with which a rank goes on with a run: its ``state`` and the backend's ``memory``, the ``scene`` as JSON, so
    the ``population``, who has entered and left, the digests of the ``files`` that it names, the ``times`` of its
    outputs, the ``sizes`` (times, DATASETS) of the files that the rank then wrote, 0 for none [byte], the ``tables`` as
    far as they were written, what the run has cost, its ``extremes``, and how many ``ranks`` have such."""

    state: State
    memory: FluidState
    scene: str
    population: str
    files: str
    times: tuple[float, ...]
    sizes: IntArray
    tables: Mapping[str, Prefix]
    seconds: Mapping[str, float]
    rejected: int
    unsettled: int
    remeshes: int
    failed_remeshes: int
    latest_failed_remesh: str | None
    elapsed: float
    cpu_time: float
    extremes: Extremes
    ranks: int


def stage_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write next to ``path`` first, so that a run killed in the middle leaves the checkpoint before.

    The file is made in memory: on a full disk HDF5's own writing does not fail, it crashes.
    """
    image = io.BytesIO()
    with h5py.File(image, "w", userblock_size=BLOCK) as file:
        file.attrs["format"] = FORMAT
        store(file, checkpoint)
    seal(image)
    replace_file(_staged(path), image.getbuffer())


def adopt_checkpoint(path: Path) -> None:
    """Put what was staged in the place of the checkpoint before."""
    _staged(path).replace(path)


def read_staged(path: Path, ranks: Ranks) -> Checkpoint:
    """Read the checkpoint staged for ``path`` and not yet put in its place; raises OutputError as read_checkpoint
    does."""
    return read_checkpoint(_staged(path), ranks)


def read_checkpoint(path: Path, ranks: Ranks = ALONE) -> Checkpoint:
    """Read a checkpoint back, bit for bit; raises OutputError where there is none, it cannot be read, or no run can
    have written what it holds."""
    with _opened(path) as file:
        checkpoint: Checkpoint = load(file, Checkpoint, ranks)
        require_sound(checkpoint)
    return replace(checkpoint, state=_with_shared_cells(checkpoint.state))


def read_origin(path: Path) -> tuple[int, int]:
    """The tick of a checkpoint, and how many ranks wrote it together; raises OutputError as read_checkpoint does."""
    with _opened(path) as file:
        tick, ranks = (load_value(file, name, int, ALONE) for name in ("state/tick", "ranks"))
        if ranks < 1:
            raise Misfit("ranks", f"{ranks}", "1 or more")
        return tick, ranks


def read_scene(path: Path) -> dict[str, Any]:
    """The scene of the run that a checkpoint is of; raises OutputError where there is none or it cannot be read."""
    with _opened(path) as file:
        return json_table("scene", load_value(file, "scene", str, ALONE))


def read_population(path: Path) -> dict[str, Any]:
    """The bodies that entered and left the run of a checkpoint; raises OutputError as read_scene does."""
    with _opened(path) as file:
        return json_table("population", load_value(file, "population", str, ALONE))


@contextmanager
def _opened(path: Path) -> Iterator[h5py.File]:
    """A checkpoint, of whose bytes each is as it was written."""
    if not path.exists():
        raise OutputError(str(path), "no such file", "the checkpoint of an earlier run", "Run without --resume.")
    require_result(path)
    data, remedy = path.read_bytes(), "Run without --resume."
    if not is_sealed(data):
        raise OutputError(str(path), "no checkpoint of this version", f"one of format {FORMAT}", remedy)
    if not is_intact(data):
        raise OutputError(str(path), "a damaged or edited checkpoint", "one as it was written", remedy)
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            if not np.array_equal(found := file.attrs.get("format"), FORMAT):
                raise OutputError(str(path), f"a checkpoint of format {found}", f"format {FORMAT}", remedy)
            yield file
    except Misfit as misfit:
        raise misfit_error(path, misfit) from None
    except (OSError, RuntimeError, ValueError, TypeError, KeyError) as error:  # of HDF5, for what is no file of its own
        found = f"what cannot be read ({type(error).__name__}: {error})"
        raise OutputError(str(path), found, "a checkpoint as it was written", remedy) from error


def misfit_error(path: Path, misfit: Misfit) -> OutputError:
    """The error of a checkpoint that holds what none can."""
    return OutputError(f"{path}, {misfit.name}", misfit.found, misfit.allowed, "Run without --resume.")


def _staged(path: Path) -> Path:
    return path.with_name(path.name + ".part")


def _with_shared_cells(state: State) -> State:
    """A moved mesh has the very cells of its reference: backends know a topology by its array."""
    return replace(state, mesh=state.reference.mesh.moved_to(state.mesh.geometry))
