"""The repulsion laws that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.core.interfaces import ForceLaw
from rigidfluid.forces.centre import CentreLaw
from rigidfluid.hookspecs import hookimpl


@hookimpl
def rigidfluid_force_laws() -> list[type[ForceLaw]]:
    """The built-in force laws."""
    return [CentreLaw]
