"""Conditions that a scene sets on the domain's surfaces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.piece import Piece
from rigidfluid.core.model.types import BoundaryCondition, FloatArray
from rigidfluid.core.model.wall import Wall
from rigidfluid.core.setup.boundary_values import prescribed_pressure, prescribed_velocity, pressure_drop, wall_velocity

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import BoundaryTable, Scene


def boundary_table(scene: Scene, name: str) -> BoundaryTable | None:
    """Last entry of a scene's ``boundary`` for the surface ``name`` or for all; None means a wall at rest."""
    return next((table for table in reversed(scene.boundary) if table.on in (name, "all")), None)


def table_key(scene: Scene, table: BoundaryTable) -> str:
    """Key of a boundary table in the scene, for messages."""
    return f"boundary.{scene.boundary.index(table)}"


def conditions(scene: Scene, domain: Domain) -> tuple[BoundaryCondition, ...]:
    """The condition on each piece of the boundary, in the order of surface numbers."""
    return tuple(_condition(scene, domain, len(scene.body) + i, piece) for i, piece in enumerate(domain.pieces))


def surfaces_of(domain: Domain, bodies: int) -> tuple[Wall, ...]:
    """Every piece of the boundary as a wall, whether it repels or not, in the order of surface numbers."""
    return tuple(Wall(bodies + i, piece.name, piece.shape) for i, piece in enumerate(domain.pieces))


def repelling_walls(scene: Scene, domain: Domain) -> tuple[Wall, ...]:
    """The pieces of the boundary that are walls, with the velocities at which they slide."""
    walls = []
    for wall in surfaces_of(domain, len(scene.body)):
        table = boundary_table(scene, wall.name)
        if table is None or table.type == "wall":
            velocity = None if table is None else wall_velocity(table, scene.dimension)
            walls.append(replace(wall, velocity=velocity))
    return tuple(walls)


def _condition(scene: Scene, domain: Domain, surface: int, piece: Piece) -> BoundaryCondition:
    plane, table = piece.shape.plane, boundary_table(scene, piece.name)
    normal = None if plane is None else plane.unit_normal
    if table is None:
        return BoundaryCondition(surface, piece.name, "wall", normal)
    value: Callable[[float, FloatArray], FloatArray] | None = None
    if table.type == "wall":
        sliding = wall_velocity(table, scene.dimension)
        value = None if sliding is None else sliding.velocity_at
    elif table.type == "velocity":
        value = prescribed_velocity(piece, table, table_key(scene, table))
    elif table.pressure is not None:
        value = prescribed_pressure(piece, table, scene.dimension, table_key(scene, table))
    elif table.pressure_drop is not None:
        value = pressure_drop(table, scene.dimension, table_key(scene, table))
    kind = "slip" if table.type == "symmetry" else table.type
    number = surface - len(scene.body)
    image = next((len(scene.body) + second for first, second in domain.periodic if first == number), None)
    return BoundaryCondition(surface, piece.name, kind, normal, value, image)
