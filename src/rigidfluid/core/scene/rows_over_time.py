"""Tables of values over time: a text file of them, and a stroke."""

from __future__ import annotations

from pydantic import Field

from rigidfluid.core.scene.table import Positive, Table


class TimeFileTable(Table):
    """A table over time in a text file; it is read when the scene is loaded, and kept with the scene."""

    file: str = Field(description="Lines of `time, value`; lines that start with # are skipped")


class StrokeTable(Table):
    """A length or an angle as a function of time: either `piecewise` or `smooth` gives its rows [time, value]."""

    piecewise: tuple[tuple[float, float], ...] | TimeFileTable | None = Field(
        default=None,
        description="Rows [time, value] from time 0 on, linear between them; or a table with a `file` of such rows",
    )
    smooth: tuple[tuple[float, float], ...] | TimeFileTable | None = Field(
        default=None,
        description="The same, joined by a monotone cubic: its rate is continuous, and zero where the value turns back",
    )
    period: Positive | None = Field(
        default=None,
        description="Time after which it repeats; the value is constant after the last row; time of the last row if "
        "not given [time]",
    )
    repeat: bool = Field(default=True, description="Whether it repeats; else the last value is held")
