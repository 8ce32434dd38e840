"""The results of a run: tables and summary, the same in memory and on disk."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.output.optional_package import optional_package
from rigidfluid.core.output.records import Records, Row, columns
from rigidfluid.core.output.tables import read_columns, read_header, read_rows, table_path
from rigidfluid.described import Described
from rigidfluid.errors import ArgumentError, OutputError


class History(Described):
    """Tables of a run by column, and its summary.

    Rows are kept in memory, ``records`` from the start; but with the ``folder`` in which a run writes its tables none
    is: each table is read when it is asked for, and a later run in the same folder replaces it.

    Parameters
    ----------
    dimension : int
        Number of space dimensions d.
    records : dict, optional
        Rows to begin with, by table.
    folder : Path, optional
        Folder of the tables on disk.
    columns_by_table : dict of str to tuple of str, optional
        Names of the columns of each table; if not given those of a scene without periodic surfaces and joints of
        plug-ins.

    Attributes
    ----------
    columns : dict of str to tuple of str
        Names of the columns of each table.
    summary : dict
        The content of summary.json; empty before the run has ended.
    folder : Path or None
        Folder of the tables on disk.
    """

    def __init__(
        self,
        dimension: int,
        records: Records | None = None,
        folder: Path | None = None,
        columns_by_table: Mapping[str, tuple[str, ...]] | None = None,
    ) -> None:
        self.dimension = dimension
        self.columns = dict(columns_by_table or columns(dimension))
        self.summary: dict[str, Any] = {}
        self._rows: Records = records or {}
        self.folder = folder

    @property
    def records(self) -> Records:
        """All rows by table name; raises OutputError as `table` does."""
        if self.folder is None:
            return self._rows
        return {name: _rows(table_path(self.folder, name)) for name in self.columns}

    @property
    def lengths(self) -> dict[str, int]:
        """Rows in memory by table name."""
        return {name: len(rows) for name, rows in self._rows.items()}

    def cut(self, lengths: Mapping[str, int]) -> None:
        """Drop what came after so many rows in memory."""
        self._rows = {name: self._rows[name][:length] for name, length in lengths.items()}

    def extend(self, records: Records) -> None:
        """Append the rows of one state, unless a writer puts them on disk."""
        if self.folder is None:
            for name, rows in records.items():
                self._rows.setdefault(name, []).extend(rows)

    def table(self, name: str, only: Iterable[str] | None = None) -> dict[str, NDArray[Any]]:
        """Read one table as arrays by column.

        Parameters
        ----------
        name : str
            ``bodies``, ``contacts``, ``joints``, ``energy``, ``steps``, ``probes``, ``driving``, ``stresslets``,
            ``walls``, ``statistics``, ``exchanges``, ``mesh_error``, ``sensitivities``, ``error_estimates``, ``scalar``
            or ``scalar_fluxes``.
        only : iterable of str, optional
            The columns that are wanted; all if not given. A folder that an earlier version has written has all that it
            knew.

        Returns
        -------
        dict of str to array
            A column (r,) by its name, r rows.

        Raises
        ------
        ArgumentError
            If no table or column has such a name.
        OutputError
            If the table is on disk and cannot be read.
        """
        _require("table", [name], self.columns)
        names = self.columns[name]
        wanted = tuple(names if only is None else only)
        _require(f"{name}, column", wanted, names)
        if self.folder is not None:
            path = table_path(self.folder, name)
            with reading(path):
                known = wanted if only is not None else [name for name in read_header(path) if name in wanted]
                return self._read(path, known or wanted)
        rows = self._rows.get(name, [])
        return {column: np.array([row[i] for row in rows]) for i, column in enumerate(names) if column in wanted}

    def frame(self, name: str) -> Any:
        """Table as a data frame of pandas.

        Parameters
        ----------
        name : str
            As `table` takes it.

        Returns
        -------
        pandas.DataFrame
            A row for each of the table's, a column for each of its.

        Raises
        ------
        ArgumentError
            If no table has this name.
        OutputError
            If pandas is not installed, or the table cannot be read.
        """
        pandas = optional_package("pandas", "notebooks")
        return pandas.DataFrame(self.table(name))

    def _read(self, path: Path, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Columns of a table on disk."""
        return read_columns(path, wanted)

    def _facts(self) -> Mapping[str, object]:
        found = self.summary
        energy = found.get("energy", {})
        return {
            "scene": found["scene"]["scene"]["name"] if "scene" in found else None,
            "status": found.get("status", "no summary yet"),
            "folder": self.folder,
            **{key.replace("_", " "): found.get(key) for key in ("time", "steps", "remeshes", "cells", "smallest_gap")},
            "energy not accounted for": energy.get("relative_residual"),
        }

    @property
    def bodies(self) -> dict[str, NDArray[Any]]:
        """The table of bodies.csv: a row per body and accepted step."""
        return self.table("bodies")

    @property
    def contacts(self) -> dict[str, NDArray[Any]]:
        """The table of contacts.csv: a row per contact within range."""
        return self.table("contacts")

    @property
    def joints(self) -> dict[str, NDArray[Any]]:
        """The table of joints.csv: a row per joint and accepted step."""
        return self.table("joints")

    @property
    def energy(self) -> dict[str, NDArray[Any]]:
        """The table of energy.csv: a row per accepted step."""
        return self.table("energy")

    @property
    def steps(self) -> dict[str, NDArray[Any]]:
        """The table of steps.csv: a row per accepted step, with what it took."""
        return self.table("steps")

    @property
    def probes(self) -> dict[str, NDArray[Any]]:
        """The table of probes.csv: a row per probe and accepted step."""
        return self.table("probes")

    @property
    def driving(self) -> dict[str, NDArray[Any]]:
        """The table of driving.csv: a row per pair of periodic surfaces and accepted step."""
        return self.table("driving")

    @property
    def stresslets(self) -> dict[str, NDArray[Any]]:
        """The table of stresslets.csv: a row per body and accepted step, with ``output.stresslets``."""
        return self.table("stresslets")

    @property
    def walls(self) -> dict[str, NDArray[Any]]:
        """The table of walls.csv: a row per surface of the domain and accepted step, with ``output.walls``."""
        return self.table("walls")

    @property
    def statistics(self) -> dict[str, NDArray[Any]]:
        """The table of statistics.csv: a row per accepted step, with ``output.statistics``."""
        return self.table("statistics")

    @property
    def exchanges(self) -> dict[str, NDArray[Any]]:
        """The table of exchanges.csv: a row per body that entered or left."""
        return self.table("exchanges")

    @property
    def mesh_error(self) -> dict[str, NDArray[Any]]:
        """The table of mesh_error.csv: a row per accepted step, with ``mesh.estimate``."""
        return self.table("mesh_error")

    @property
    def sensitivities(self) -> dict[str, NDArray[Any]]:
        """The table of sensitivities.csv: a row per key in ``output.sensitivities``, body and accepted step."""
        return self.table("sensitivities")

    @property
    def error_estimates(self) -> dict[str, NDArray[Any]]:
        """The table of error_estimates.csv: a row per body and output, with ``output.error_bars``."""
        return self.table("error_estimates")

    @property
    def scalar(self) -> dict[str, NDArray[Any]]:
        """The table of scalar.csv: a row per accepted step, with a table ``[scalar]``."""
        return self.table("scalar")

    @property
    def scalar_fluxes(self) -> dict[str, NDArray[Any]]:
        """The table of scalar_fluxes.csv: a row per surface and accepted step, with a table ``[scalar]``."""
        return self.table("scalar_fluxes")


def _rows(path: Path) -> list[Row]:
    with reading(path):
        return read_rows(path)


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn what is wrong with a table into an OutputError that names the file."""
    try:
        yield
    except (OSError, ValueError) as error:
        remedy = "Restore the file, or run the scene again."
        raise OutputError(str(path), error, "a table as a run has written it", remedy) from error


def _require(field: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Raise ArgumentError where one of the names is not known."""
    for name in names:
        if not isinstance(name, str) or name not in known:
            raise ArgumentError(field, repr(name), f"one of {', '.join(known)}", "Correct the name.")
