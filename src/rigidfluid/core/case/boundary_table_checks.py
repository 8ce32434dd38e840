"""Refuses tables of conditions that the domain does not have, or that contradict themselves."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from typing import TYPE_CHECKING

from rigidfluid.core.case.time_factor import rows_over_time
from rigidfluid.core.geometry.piece import all_names
from rigidfluid.core.nested.rows import check_rows
from rigidfluid.core.scene.all_errors import all_told, raise_all
from rigidfluid.core.scene.boundary_tables import BoundaryTable, PeriodicTable, VelocityTable, WallTable
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain


def check_boundary_tables(tables: Sequence[BoundaryTable], domain: Domain, end: float) -> None:
    """Refuse, with SceneError, unknown names of surfaces, keys that do not go together, and rows over time that do not
    reach from the start to the ``end`` [time]."""
    with all_told() as ask:
        ask(check_surface_names, tables, domain)
        for number, table in enumerate(tables):
            ask(_check_table, table, f"boundary.{number}")
        for at, rows in rows_over_time(tables).items():
            ask(check_rows, rows, end, at)


def check_surface_names(tables: Sequence[BoundaryTable], domain: Domain) -> None:
    """Refuse, with SceneError, unknown names of surfaces."""
    known = ["all", *all_names(domain.pieces)]
    raise_all(_unknown(f"boundary.{n}.on", table.on, domain) for n, table in enumerate(tables) if table.on not in known)


def _unknown(field: str, name: str, domain: Domain) -> SceneError:
    remedy = suggestion(name, all_names(domain.pieces)) or "Name a surface of the domain."
    return SceneError(field, repr(name), f"all, {domain.names_in_words}", remedy)


@singledispatch
def _check_table(table: BoundaryTable, at: str) -> None:
    """Refuse keys of a table that its type has and that do not go together; of most types they all do."""


@_check_table.register(VelocityTable)
def _check_velocity_table(table: VelocityTable, at: str) -> None:
    if table.velocity is None and table.flux is None:
        raise SceneError(f"{at}.velocity", "nothing", "a value with type = 'velocity'", "Add 'velocity' or 'flux'.")
    if table.velocity is not None and table.flux is not None:
        raise SceneError(f"{at}.flux", "flux takes the place of velocity, and both are given", None, "Keep one.")


@_check_table.register(PeriodicTable)
def _check_periodic_table(table: PeriodicTable, at: str) -> None:
    if table.pressure_drop is not None and table.flux is not None:
        raise SceneError(f"{at}.flux", "flux takes the place of pressure_drop, and both are given", None, "Keep one.")


@_check_table.register(WallTable)
def _check_wall_table(table: WallTable, at: str) -> None:
    if table.centre is not None and table.angular_velocity is None:
        raise SceneError(f"{at}.centre", "a centre is read only with an angular_velocity", None, "Leave it out.")
