"""Conditions that a scene sets on the domain's surfaces."""

from __future__ import annotations

from collections.abc import Iterator
from functools import singledispatch
from typing import TYPE_CHECKING

from rigidfluid.core.model.conditions import (
    BoundaryCondition,
    NoSlip,
    Periodic,
    PrescribedPressure,
    PrescribedVelocity,
    Slip,
    no_pressure,
)
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.wall import Wall
from rigidfluid.core.scene.scene import (
    BoundaryTable,
    PeriodicTable,
    PressureTable,
    SlipTable,
    VelocityTable,
    WallTable,
)
from rigidfluid.core.setup.boundary_tables import Place, placed_tables, tables_of_walls
from rigidfluid.core.setup.boundary_values import prescribed_pressure, prescribed_velocity, pressure_drop, wall_velocity

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import Scene


def conditions(scene: Scene, domain: Domain) -> tuple[BoundaryCondition, ...]:
    """The condition on each piece of the boundary, in the order of surface numbers."""
    return tuple(condition_of(table, place) for table, place in placed_tables(scene, domain))


def oblique_parts(scene: Scene, domain: Domain) -> Iterator[tuple[BoundaryTable, Place]]:
    """The tables that hold a part of the velocity on a surface that lies across no axis."""
    for table, place in placed_tables(scene, domain):
        if condition_of(table, place).holds_part and not place.across_an_axis:
            yield table, place


def surfaces_of(domain: Domain, bodies: int) -> tuple[Wall, ...]:
    """Every piece of the boundary as a wall, whether it repels or not, in the order of surface numbers."""
    return tuple(Wall(bodies + i, piece.name, piece.shape) for i, piece in enumerate(domain.pieces))


def repelling_walls(scene: Scene, domain: Domain) -> tuple[Wall, ...]:
    """The pieces of the boundary that are walls, with the velocities at which they slide."""
    return tuple(
        Wall(place.surface, place.piece.name, place.piece.shape, wall_velocity(table, domain.dimension))
        for table, place in tables_of_walls(scene, domain)
    )


@singledispatch
def condition_of(table: BoundaryTable, place: Place) -> BoundaryCondition:
    """The condition of a table at a place; raises SceneError for values that cannot be there.

    Each class of tables has its own function below.
    """
    raise NotImplementedError(type(table).__name__)


@condition_of.register(WallTable)
def _no_slip(table: WallTable, place: Place) -> NoSlip:
    velocity = wall_velocity(table, place.dimension)
    return NoSlip(*place.surface_name_normal, None if velocity is None else velocity.velocity_at)


@condition_of.register(VelocityTable)
def _prescribed_velocity(table: VelocityTable, place: Place) -> PrescribedVelocity:
    return PrescribedVelocity(*place.surface_name_normal, prescribed_velocity(table, place))


@condition_of.register(PressureTable)
def _prescribed_pressure(table: PressureTable, place: Place) -> PrescribedPressure:
    return PrescribedPressure(*place.surface_name_normal, prescribed_pressure(table, place))


@condition_of.register(SlipTable)
def _slip(table: SlipTable, place: Place) -> Slip:
    return Slip(*place.surface_name_normal)


@condition_of.register(PeriodicTable)
def _periodic(table: PeriodicTable, place: Place) -> Periodic:
    drop = pressure_drop(table, place)
    return Periodic(*place.surface_name_normal, place.image, no_pressure if drop is None else drop)
