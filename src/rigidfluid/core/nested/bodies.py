"""Bodies in tables of other parts: obstacles of a domain, components of a mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from pydantic import ConfigDict, Field

from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.nested.part_options import build_part
from rigidfluid.core.nested.placing import check_orientation
from rigidfluid.core.scene.body_tables import InitialAngle, InitialOrientation
from rigidfluid.core.scene.patterns import BODY_NAME
from rigidfluid.core.scene.vectors import Vector
from rigidfluid.errors import SceneError
from rigidfluid.registry import BODY, Registry


class NestedBodyTable(PartOptions):
    """A shape at a position; it also has the keys of its type."""

    model_config = ConfigDict(extra="allow")

    name: str = Field(default="", pattern=BODY_NAME, description="Name; numbered from 0 if not given")
    type: str = Field(description="Name of a body type")
    position: Vector = Field(description="Position of the centre of mass [length]")
    angle: InitialAngle = None
    orientation: InitialOrientation = None


T = TypeVar("T", bound=NestedBodyTable)


def tables_by_name(tables: Sequence[T], at: str) -> Mapping[str, T]:
    """Tables by name, in order; one without a name gets the last word of its key ``at`` and its number. Raises
    SceneError if a name comes twice."""
    found: dict[str, T] = {}
    for number, table in enumerate(tables):
        name = table.name or f"{at.rpartition('.')[2]}{number}"
        if name in found:
            remedy = "Rename one of them."
            raise SceneError(f"{at}.{number}.name", f"{name!r} for the second time", "a name of its own", remedy)
        found[name] = table
    return found


def build_shape(table: NestedBodyTable, at: str, dimension: int) -> Body:
    """Build the shape, in its own frame, of the table at the key ``at``; raises SceneError for an unknown key, a vector
    of wrong length or an invalid shape, PluginError for an unknown body type."""
    check_length(table.position, f"{at}.position", dimension)
    check_orientation(table, dimension, at)
    return build_part(BODY, table, at, Registry.load(), dimension)


def check_length(vector: Sequence[float], at: str, dimension: int) -> None:
    """Raise SceneError for a ``vector`` that has not as many numbers as there are dimensions."""
    if len(vector) != dimension:
        found = f"{list(vector)}, {len(vector)} of them"
        raise SceneError(at, found, f"{dimension} numbers", f"The scene has {dimension} dimensions.")
