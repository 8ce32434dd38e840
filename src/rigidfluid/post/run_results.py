"""Results of a run read back from its folder, also while it goes on or after it was cut off."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.case.load import scene_of_results
from rigidfluid.core.case.scene_model import Case
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.fluid_fields import FluidFields
from rigidfluid.core.output.history import History, reading
from rigidfluid.core.output.records import columns, wrapped_columns
from rigidfluid.core.output.run_document import read_document
from rigidfluid.core.output.tables import read_columns, read_header, table_path
from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.core.output.writer import SERIES
from rigidfluid.core.setup.description import refuse_description
from rigidfluid.errors import OutputError
from rigidfluid.regular_file import path_of


class RunResults(History):
    """Tables, summary, scene and fields of a run in its folder, as `load_results` gives them.

    Tables and fields are read when they are asked for. While the run goes on, a table ends with the latest state that
    all tables have; the ``summary`` is that of the moment when the results were loaded, empty if there was none.

    Parameters
    ----------
    folder : Path
        The folder that the run has written.
    """

    def __init__(self, folder: Path) -> None:
        summary, self._document = read_document(folder)
        dimension = self._document["scene"]["dimension"]
        super().__init__(dimension, folder=folder, columns_by_table=_columns(folder, dimension))
        self.summary = summary
        self.folder: Path = folder

    @property
    def scene(self) -> Case:
        """Scene of the run; raises OutputError for a run of a model made in Python, and as `scene_from_dict` does."""
        refuse_description(self._document, self.folder, "Make the model again as it was made.")
        return scene_of_results(self._document)

    @property
    def times(self) -> FloatArray:
        """Times (F,) of the fields on disk, none without a fluid [time]."""
        return np.array([time for time, _ in self._series()])

    def fields(self, time: float | None = None) -> FluidFields:
        """Read the fields of the output that is nearest to a time.

        Parameters
        ----------
        time : float
            Time of the state, none before the first output or after the latest; the latest if not given [time].

        Returns
        -------
        FluidFields
            Arrays, which are of 7 digits but for the points, and the time of the output.

        Raises
        ------
        OutputError
            If there are none or none so early or late, or a file cannot be read.
        """
        series = self._series()
        if not series:
            allowed, remedy = "those of a run with a fluid", "See its tables."
            raise OutputError(f"{self.folder}, fields", "none", allowed, remedy)
        first, latest = series[0][0], series[-1][0]
        wanted = latest if time is None else time
        is_number = isinstance(wanted, float | int | np.number)
        if not (is_number and (first <= wanted <= latest or math.isclose(wanted, latest))):
            allowed, remedy = f"{first:.6g} to {latest:.6g}", "Choose one of `times`."
            raise OutputError(f"{self.folder}, time of fields", wanted, allowed, remedy)
        nearest, path = min(series, key=lambda one: abs(one[0] - wanted))
        return FluidFields.from_fields(read_vtu(path), nearest)

    def table(self, name: str, only: Iterable[str] | None = None) -> dict[str, NDArray[Any]]:
        """Read one table as `History.table` does, up to the latest state that all tables have."""
        # A state's rows of bodies, contacts and joints are written before its row here.
        latest = super().table("energy", ("step",))["step"].max(initial=-1)
        wanted = None if only is None else tuple(only)
        found = super().table(name, None if wanted is None else (*wanted, "step"))
        whole = found["step"] <= latest
        return {column: values[whole] for column, values in found.items() if wanted is None or column in wanted}

    def _read(self, path: Path, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
        return read_columns(path, wanted, complete=False)

    def _series(self) -> tuple[tuple[float, Path], ...]:
        return read_pvd(self.folder / SERIES) if (self.folder / SERIES).exists() else ()

    def _facts(self) -> Mapping[str, object]:
        times = self.times
        outputs = f"{len(times)}, from {times[0]:.4g} to {times[-1]:.4g}" if len(times) else None
        return {**super()._facts(), "scene": self._document["scene"]["name"], "outputs with fields": outputs}


def load_results(folder: str | Path) -> RunResults:
    """Read the results of a run, complete or not, from its folder.

    Parameters
    ----------
    folder : str or Path
        The folder that `run` or the command was given.

    Returns
    -------
    RunResults
        Tables, scene, summary and fields.

    Raises
    ------
    ArgumentError
        If it is no path.
    OutputError
        If the folder has neither a summary nor a checkpoint, or they cannot be read.
    """
    return RunResults(path_of("folder", folder, "a path", "Give the folder of a run."))


def _columns(folder: Path, dimension: int) -> dict[str, tuple[str, ...]]:
    """Columns of each table: with coordinates of joints, also those that a plug-in names, and wrapped positions if the
    run has written them."""
    known, wrapped = columns(dimension, ())["joints"], set(wrapped_columns(dimension))
    coordinates = [name for name in _header(folder, "joints") if name not in known]
    return columns(dimension, coordinates, periodic=wrapped <= set(_header(folder, "bodies")))


def _header(folder: Path, name: str) -> list[str]:
    """Columns of a table on disk, none if there is none."""
    path = table_path(folder, name)
    if not path.exists():
        return []
    with reading(path):
        return read_header(path)
