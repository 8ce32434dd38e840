"""The size fields that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.hookspecs import hookimpl
from rigidfluid.size_fields.vorticity import Vorticity


@hookimpl
def rigidfluid_size_fields() -> list[type[SizeField]]:
    """The built-in size fields."""
    return [Vorticity]
