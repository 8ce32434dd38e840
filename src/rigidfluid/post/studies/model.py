"""Tables of a study file, and the `Study` that they give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from rigidfluid.core.scene.patterns import FILE_NAME
from rigidfluid.post.studies.samples import RandomTable, draw_samples
from rigidfluid.post.studies.strict_table import Settings, StrictTable, flat

FINEST: Literal["finest"] = "finest"
"""Reference that is the figure of the most expensive run of a group."""

Lists = Annotated[dict[str, Annotated[list[Any], Field(min_length=1)]], BeforeValidator(flat)]
"""Values by dotted key of the scene, or knob of the kernel."""


def _listed(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


class StudyTable(StrictTable):
    """Subject of a study, and the combination of its settings."""

    name: str = Field(pattern=FILE_NAME, description="Name of the study; results go to `out/<name>` by default")
    scene: str | None = Field(default=None, description="Path of the scene file, relative to the study file")
    kernel: str | None = Field(default=None, description="Name of a kernel, in place of a scene")
    label: str = Field(default="", description="What the error is of, for the plot; the figure if not given")
    group: Annotated[list[str], BeforeValidator(_listed)] = Field(
        default=[], max_length=2, description="Key of [vary], or two; the plot has a line for each of their values"
    )
    zip: bool = Field(default=False, description="Take the lists of [vary] side by side, not every combination")
    seconds: Literal["wall", "cpu"] | None = Field(
        default=None, description="By which clock a run of a scene is timed; cpu if not given"
    )

    @property
    def timed_by(self) -> Literal["wall", "cpu"]:
        """The clock that measures the seconds; calls of a kernel are timed by the one on the wall."""
        return self.seconds or ("cpu" if self.kernel is None else "wall")

    @property
    def clock(self) -> str:
        """Name of that clock."""
        return "CPU time" if self.timed_by == "cpu" else "wall time"


class FigureTable(StrictTable):
    """A number that a run ends with: a key path of summary.json, or a column of a table at a time or its extreme."""

    key: str | None = Field(default=None, description="Key path of summary.json, as `energy.dissipation`")
    table: Literal["bodies", "contacts", "energy", "probes", "driving", "scalar", "scalar_fluxes"] | None = Field(
        default=None, description="Table that holds the column"
    )
    column: str | None = Field(default=None, description="Column of that table")
    body: str | None = Field(
        default=None, description="Name of the body, the first if not given; in contacts.csv one of the two, all if not"
    )
    probe: int | None = Field(default=None, ge=0, description="Number of the probe; the first if not given")
    surface: str | None = Field(
        default=None, description="Name of the surface in driving.csv and scalar_fluxes.csv; the first if not given"
    )
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
        rest = (self.table, self.column, self.body, self.probe, self.surface, self.at, self.extreme)
        if of_summary == of_table or (of_summary and any(part is not None for part in rest)):
            raise ValueError("a key path of summary.json, or table, column and one of at and extreme")
        self._refuse_unread()
        return self

    def _refuse_unread(self) -> None:
        if self.body is not None and self.table not in ("bodies", "contacts"):
            raise ValueError("body with table bodies or contacts")
        if self.probe is not None and self.table != "probes":
            raise ValueError("probe with table probes")
        if self.surface is not None and self.table not in ("driving", "scalar_fluxes"):
            raise ValueError("surface with table driving or scalar_fluxes")
        if self.at is not None and self.table == "contacts":
            raise ValueError("extreme with table contacts, which has no row for each step")

    def __str__(self) -> str:
        if self.key is not None:
            return self.key
        moment = f"at {self.at:g}" if self.at is not None else str(self.extreme)
        probe = None if self.probe is None else f"probe {self.probe}"
        return " ".join(filter(None, (self.body, self.surface, probe, self.column, moment)))


class ErrorTable(StrictTable):
    """Figure, reference and scaling of the error."""

    figure: FigureTable = Field(description="The figure that is studied")
    reference: float | Literal["finest"] | None = Field(
        default=None,
        description='What the figure should be: a number, or "finest", its value in the most expensive run with the '
        "same parameters; without it there is no error",
    )
    relative: bool = Field(default=False, description="Divide the error by the reference")


class StudyFile(StrictTable):
    """A whole study file."""

    study: StudyTable
    set: Annotated[Settings, BeforeValidator(flat)] = Field(
        default={}, description="Values that all runs have, by dotted key of the scene, or knob of the kernel"
    )
    vary: Lists = Field(default={}, description="Lists of numerical settings")
    parameters: Lists = Field(default={}, description="Lists of values of physical parameters")
    random: RandomTable | None = None
    error: ErrorTable | None = Field(default=None, description="The error; a kernel has its own")

    def set_keys(self) -> dict[str, list[str]]:
        """Keys of the scene that each table sets."""
        random = [] if self.random is None else list(self.random.parameters)
        listed = {name: list(getattr(self, name)) for name in ("vary", "parameters", "set")}
        return {**listed, "random.parameters": random}


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

    @cached_property
    def parameters(self) -> list[str]:
        """Keys of the physical parameters."""
        random = self.tables.random
        return list(self.tables.parameters if random is None else random.parameters)

    @cached_property
    def knobs(self) -> list[str]:
        """Keys of the scene, or knobs of the kernel, that vary: physical parameters, then numerical settings."""
        return [*self.parameters, *self.tables.vary]

    def values(self, knob: str) -> list[Any]:
        """Values in the list of a knob."""
        return (self.tables.parameters | self.tables.vary)[knob]

    @cached_property
    def groups(self) -> list[Settings]:
        """Values of the physical parameters, one after the other: runs with the same ones are compared."""
        random = self.tables.random
        return _combinations(self.tables.parameters) if random is None else draw_samples(random)

    @cached_property
    def variants(self) -> list[Settings]:
        """Numerical settings that each group is run with."""
        return _combinations(self.tables.vary, side_by_side=self.tables.study.zip)

    def settings(self) -> list[Settings]:
        """The values of the knobs, run by run."""
        return [group | variant for group in self.groups for variant in self.variants]


def _combinations(lists: Mapping[str, list[Any]], *, side_by_side: bool = False) -> list[Settings]:
    """Every combination of the values, or one from each list side by side; an empty one without lists."""
    rows = zip(*lists.values(), strict=True) if side_by_side and lists else product(*lists.values())
    return [dict(zip(lists, row, strict=True)) for row in rows]
