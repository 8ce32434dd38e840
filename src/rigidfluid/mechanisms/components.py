"""Components of a mechanism, from tables."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field

from rigidfluid.core.model.mechanism import Component
from rigidfluid.core.nested.bodies import NestedBodyTable, build_shape, tables_by_name
from rigidfluid.core.scene.table import Positive
from rigidfluid.errors import SceneError


class ComponentTable(NestedBodyTable):
    """A rigid body of a mechanism, placed in the mechanism's frame with all strokes at value zero."""

    density: Positive = Field(description="Density [mass/length^d]")


def build_components(tables: Sequence[ComponentTable], at: str, dimension: int) -> list[Component]:
    """Components of a mechanism, in the order of their tables; `initial_pose` of these says where they are.

    Parameters
    ----------
    tables : sequence of ComponentTable
        One for each; those without a name are numbered.
    at : str
        Place of the tables in a scene, for messages and for names that are not given: ``mechanism.component``.
    dimension : int
        2 or 3.

    Returns
    -------
    list of Component
        One or more, each with a name of its own.

    Raises
    ------
    SceneError
        If there is none, a name comes twice, a key is unknown, a vector has a wrong length or a shape cannot be.
    PluginError
        If there is no such body type.
    """
    if not tables:
        raise SceneError(at, "none", "one component or more", f"Add tables [[{at}]].")
    return [
        Component(name, build_shape(table, f"{at}.{number}", dimension), table.density)
        for number, (name, table) in enumerate(tables_by_name(tables, at).items())
    ]
