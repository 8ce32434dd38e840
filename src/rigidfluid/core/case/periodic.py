"""Periodic surfaces of the domain, and their opposite ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rigidfluid.core.case.boundary_tables import placed_tables
from rigidfluid.core.scene.boundary_tables import PeriodicTable
from rigidfluid.core.setup.opposite import is_opposite
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.scene.boundary_tables import BoundaryTable


def periodic_pairs(tables: Sequence[BoundaryTable], domain: Domain) -> tuple[tuple[int, int], ...]:
    """Pairs of numbers of periodic pieces; one with a drop of pressure or a flux comes first.

    Raises SceneError for a surface without an opposite one that is periodic too, or with what drives a flow on both.
    """
    placed = enumerate(placed_tables(tables, domain))
    chosen = {i: (table, place.at) for i, (table, place) in placed if isinstance(table, PeriodicTable)}
    pairs = []
    for i, (table, at) in chosen.items():
        name = domain.names[i]
        others = [j for j in range(len(domain.names)) if is_opposite(domain, domain.pieces[i], domain.pieces[j])]
        if not others:
            statement = f"only a flat surface with an equal one opposite can be periodic, and {name!r} has none"
            raise SceneError(f"{at}.type", statement, None, "Choose another type.")
        if others[0] not in chosen:
            remedy = f"Set type = 'periodic' on {domain.names[others[0]]!r} too."
            statement = f"{name!r} is periodic and the surface opposite to it is not"
            raise SceneError(f"{at}.type", statement, None, remedy)
        other, _ = chosen[others[0]]
        if table.driving and other.driving:
            statement = (
                f"only one of {name!r} and {domain.names[others[0]]!r} can have the drop of pressure or the flux"
            )
            raise SceneError(f"{at}.{table.driving}", statement, None, "Keep one.")
        if table.driving or (not other.driving and i < others[0]):
            pairs.append((i, others[0]))
    return tuple(pairs)
