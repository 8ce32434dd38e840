"""Tables of a study file, and the `Study` that they give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from math import prod
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from rigidfluid.core.scene.scene import read_toml
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.scene.validation import read_table
from rigidfluid.errors import SceneError

Settings = dict[str, Any]
"""Values by dotted key of the scene."""


def _flat(value: Any) -> Any:
    """``{"mesh": {"size": x}}`` as ``{"mesh.size": x}``: TOML reads a bare dotted key as tables."""
    if not isinstance(value, Mapping):
        return value
    flat: Settings = {}
    for key, part in value.items():
        below = _flat(part)
        flat |= {f"{key}.{rest}": leaf for rest, leaf in below.items()} if isinstance(part, Mapping) else {key: part}
    return flat


def _listed(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


class _Table(BaseModel):
    """A table whose keys are all given here."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class StudyTable(_Table):
    """Subject of a study, and the combination of its settings."""

    name: str = Field(pattern=r"^[\w.-]*\w$", description="Name of the study; results go to `out/<name>` by default")
    scene: str | None = Field(default=None, description="Path of the scene file, relative to the study file")
    kernel: str | None = Field(default=None, description="Name of a kernel, in place of a scene")
    label: str = Field(default="", description="What the error is of, for the plot; the figure if not given")
    group: Annotated[list[str], BeforeValidator(_listed)] = Field(
        default=[], max_length=2, description="Key of [vary], or two; the plot has a line for each of their values"
    )
    zip: bool = Field(default=False, description="Take the lists of [vary] side by side, not every combination")
    seconds: Literal["wall", "cpu"] = Field(
        default="wall", description="By which clock a run of a scene is timed; cpu where other programs run too"
    )

    @property
    def clock(self) -> str:
        """Name of the clock that measures the seconds."""
        return "CPU time" if self.seconds == "cpu" else "wall time"


class FigureTable(_Table):
    """A number that a run ends with: a key path of summary.json, or a column of a table at a time or its extreme."""

    key: str | None = Field(default=None, description="Key path of summary.json, as `energy.dissipation`")
    table: Literal["bodies", "contacts", "energy", "probes"] | None = Field(
        default=None, description="Table that holds the column"
    )
    column: str | None = Field(default=None, description="Column of that table")
    body: str | None = Field(
        default=None, description="Name of the body, the first if not given; in contacts.csv one of the two, all if not"
    )
    probe: int | None = Field(default=None, ge=0, description="Number of the probe; the first if not given")
    at: float | None = Field(default=None, description="Time when the column is read, by cubic interpolation [time]")
    extreme: Literal["highest", "lowest"] | None = Field(default=None, description="Which extreme over time is taken")

    @model_validator(mode="before")
    @classmethod
    def _from_key(cls, value: Any) -> Any:
        return {"key": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _is_one_of_two(self) -> FigureTable:
        of_summary = self.key is not None
        of_table = self.table is not None and self.column is not None and (self.at is None) != (self.extreme is None)
        rest = (self.table, self.column, self.body, self.probe, self.at, self.extreme)
        if of_summary == of_table or (of_summary and any(part is not None for part in rest)):
            raise ValueError("a key path of summary.json, or table, column and one of at and extreme")
        self._refuse_unread()
        return self

    def _refuse_unread(self) -> None:
        if self.body is not None and self.table not in ("bodies", "contacts"):
            raise ValueError("body with table bodies or contacts")
        if self.probe is not None and self.table != "probes":
            raise ValueError("probe with table probes")
        if self.at is not None and self.table == "contacts":
            raise ValueError("extreme with table contacts, which has no row for each step")

    def __str__(self) -> str:
        if self.key is not None:
            return self.key
        moment = f"at {self.at:g}" if self.at is not None else str(self.extreme)
        probe = None if self.probe is None else f"probe {self.probe}"
        return " ".join(filter(None, (self.body, probe, self.column, moment)))


class ErrorTable(_Table):
    """Figure, reference and scaling of the error."""

    figure: FigureTable = Field(description="The figure whose error is studied")
    reference: Annotated[float | None, BeforeValidator(lambda value: None if value == "finest" else value)] = Field(
        description='What the figure should be: a number, or "finest", its value in the most expensive run'
    )
    relative: bool = Field(default=False, description="Divide the error by the reference")


class StudyFile(_Table):
    """A whole study file."""

    study: StudyTable
    set: Annotated[Settings, BeforeValidator(_flat)] = Field(
        default={}, description="Values that all runs have, by dotted key of the scene, or knob of the kernel"
    )
    vary: Annotated[dict[str, Annotated[list[Any], Field(min_length=1)]], BeforeValidator(_flat)] = Field(
        min_length=1, description="Lists of values, by dotted key of the scene, or knob of the kernel"
    )
    error: ErrorTable | None = Field(default=None, description="The error; a kernel has its own")


MOST_RUNS = 10_000
"""Largest number of runs in a study: all of them are held in memory and in one table."""


@dataclass(frozen=True)
class Study:
    """A study file, read: its ``tables``, where it is (``path``), and its ``text`` as it stands there."""

    tables: StudyFile
    path: Path
    text: str

    @property
    def name(self) -> str:
        """Name of the study."""
        return self.tables.study.name

    @property
    def scene(self) -> Path | None:
        """The scene file; None in the study of a kernel."""
        return None if self.tables.study.scene is None else self.path.parent / self.tables.study.scene

    @property
    def knobs(self) -> list[str]:
        """Keys of the scene, or knobs of the kernel, that vary."""
        return list(self.tables.vary)

    def settings(self) -> list[Settings]:
        """The values of the knobs, run by run."""
        lists = self.tables.vary.values()
        rows = zip(*lists, strict=True) if self.tables.study.zip else product(*lists)
        return [dict(zip(self.knobs, row, strict=True)) for row in rows]


def load_study(path: str | Path) -> Study:
    """Read a study file (TOML), validated but for its scene or kernel.

    Raises SceneError if it cannot be read, is no TOML, or has a value that is not allowed.
    """
    path = Path(path)
    tables = read_table(StudyFile, read_toml(path, "study"))
    _check_subject(tables)
    _check_group(tables)
    _check_lengths(tables)
    _check_reference(tables)
    return Study(tables, path, path.read_text(encoding="utf-8"))


def _check_subject(tables: StudyFile) -> None:
    scene, kernel = tables.study.scene, tables.study.kernel
    if (scene is None) == (kernel is None):
        found = "neither scene nor kernel" if scene is None else "scene and kernel"
        raise SceneError("study", found, "one of scene and kernel", "Say what is run by one of them.")
    if scene is not None and tables.error is None:
        raise SceneError("error", "nothing", "a table", "Add the table [error].")
    if kernel is not None and tables.error is not None:
        raise SceneError("error", "a table", "nothing with study.kernel", "Remove it: a kernel has its own reference.")
    if kernel is not None and tables.study.seconds == "cpu":
        raise SceneError(
            "study.seconds", "'cpu'", "'wall' with study.kernel", "Remove it: calls are timed by themselves."
        )


def _check_group(tables: StudyFile) -> None:
    knobs = list(tables.vary)
    for key in tables.study.group:
        if key not in knobs:
            remedy = suggestion(key, knobs) or "Name one of them, or leave it out."
            raise SceneError("study.group", repr(key), f"a key of [vary]: {', '.join(knobs)}", remedy)


def _check_lengths(tables: StudyFile) -> None:
    lengths = {key: len(values) for key, values in tables.vary.items()}
    if tables.study.zip and len(set(lengths.values())) > 1:
        found = ", ".join(f"{length} values of {key}" for key, length in lengths.items())
        raise SceneError("vary", found, "lists of one length with zip = true", "Complete the lists, or drop zip.")
    runs = max(lengths.values()) if tables.study.zip else prod(lengths.values())
    if runs > MOST_RUNS:
        remedy = "Shorten the lists, or take them side by side."
        raise SceneError("vary", f"{runs} runs", f"at most {MOST_RUNS}", remedy)


def _check_reference(tables: StudyFile) -> None:
    if tables.error is not None and tables.error.relative and tables.error.reference == 0:
        raise SceneError("error.reference", 0, "another number with relative = true", "Set relative = false.")
