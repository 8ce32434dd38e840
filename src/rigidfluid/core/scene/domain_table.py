"""Table of a scene's domain, and of the window that moves through it."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigidfluid.core.scene.table import OpenTable, Positive, Table


class WindowTable(Table):
    """The meshed part of a long domain, which moves with a body.

    Its rear end is open. Its front end has the condition of the domain's end there: at rest for a wall.
    """

    follow: str = Field(description="Name of the body")
    direction: Literal["x", "y", "z", "-x", "-y", "-z"] = Field(
        description="Direction in which the body moves; the window never moves back"
    )
    ahead: Positive = Field(description="Distance from the body's centre to its front end at the start [length]")
    behind: Positive = Field(description="Distance from the body's centre to its rear end at the start [length]")


class DomainTable(OpenTable):
    """The region that fluid and bodies share."""

    type: str = Field(default="box", description="Name of a domain")
    window: WindowTable | None = Field(default=None, description="The part that is meshed; all if not given")
