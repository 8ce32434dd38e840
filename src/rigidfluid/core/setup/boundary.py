"""What the scene says holds on the domain's surfaces, and the values prescribed there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.model.domain import Domain, Piece
from rigidfluid.core.model.types import BoundaryCondition, FloatArray
from rigidfluid.core.model.wall import Wall

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import BoundaryTable, Scene


@dataclass(frozen=True)
class BoundaryVelocity:
    """Velocity prescribed on a surface.

    Uniform, or with ``coordinates`` (see `Piece`) parabolic: peak · ∏ 4 s(1 - s) over the surface's own coordinates s.
    """

    peak: FloatArray
    coordinates: Callable[[FloatArray], FloatArray] | None = None

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Velocity (N, d) at ``points`` (N, d) [length/time]."""
        return self._shape(points)[:, None] * self.peak

    def _shape(self, points: FloatArray) -> FloatArray:
        if self.coordinates is None:
            return np.ones(len(points))
        s = self.coordinates(points)
        return np.asarray(np.prod(4 * s * (1 - s), axis=1))

    @property
    def mean(self) -> FloatArray:
        """Mean over the surface, (d,) [length/time]."""
        # ∫₀¹ 4 s(1 - s) ds = 2/3 for each coordinate of the surface.
        return self.peak if self.coordinates is None else self.peak * (2 / 3) ** (len(self.peak) - 1)


@dataclass(frozen=True)
class BoundaryPressure:
    """Pressure prescribed on a surface, the same everywhere [force/length^(d-1)]."""

    pressure: float

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Pressure (N,) at ``points`` (N, d)."""
        return np.full(len(points), self.pressure)


def boundary_table(scene: Scene, name: str) -> BoundaryTable | None:
    """What the scene says of a surface: its last entry for it or for all; None means a wall at rest."""
    return next((table for table in reversed(scene.boundary) if table.on in (name, "all")), None)


def prescribed_velocity(piece: Piece, table: BoundaryTable) -> BoundaryVelocity:
    """The velocity that a table prescribes on a piece of the boundary.

    Parameters
    ----------
    piece : Piece
        For its coordinates.
    table : BoundaryTable
        A table with a velocity.

    Returns
    -------
    BoundaryVelocity
        A function of time and points.
    """
    return BoundaryVelocity(np.array(table.velocity), piece.coordinates if table.profile == "parabolic" else None)


def conditions(scene: Scene, domain: Domain) -> tuple[BoundaryCondition, ...]:
    """The condition on each piece of the boundary, in the order of surface numbers."""
    return tuple(_condition(scene, len(scene.body) + i, piece) for i, piece in enumerate(domain.pieces))


def surfaces_of(domain: Domain, bodies: int) -> tuple[Wall, ...]:
    """Every piece of the boundary as a wall, whether it repels or not, in the order of surface numbers."""
    return tuple(Wall(bodies + i, piece.name, piece.shape) for i, piece in enumerate(domain.pieces))


def repelling_walls(scene: Scene, domain: Domain) -> tuple[Wall, ...]:
    """The pieces of the boundary that are walls, with the velocities at which they slide."""
    walls = []
    for wall in surfaces_of(domain, len(scene.body)):
        table = boundary_table(scene, wall.name)
        if table is None or table.type == "wall":
            velocity = None if table is None or table.velocity is None else np.array(table.velocity)
            walls.append(Wall(wall.surface, wall.name, wall.shape, velocity))
    return tuple(walls)


def _condition(scene: Scene, surface: int, piece: Piece) -> BoundaryCondition:
    plane, table = piece.shape.plane, boundary_table(scene, piece.name)
    normal = None if plane is None else plane.unit_normal
    if table is None:
        return BoundaryCondition(surface, piece.name, "wall", normal)
    value: Callable[[float, FloatArray], FloatArray] | None = None
    if table.velocity is not None:
        value = prescribed_velocity(piece, table)
    elif table.pressure is not None:
        value = BoundaryPressure(table.pressure)
    kind = "slip" if table.type == "symmetry" else table.type
    return BoundaryCondition(surface, piece.name, kind, normal, value)
