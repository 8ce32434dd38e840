"""Velocities and pressures prescribed on a piece of the boundary, as functions of time and place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from rigidfluid.core.case.boundary_tables import Place
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.mechanics.wall_velocity import WallVelocity
from rigidfluid.core.nested.expressions import Expression, VectorExpression
from rigidfluid.core.scene.boundary_tables import PeriodicTable, PressureTable, VelocityTable, WallTable
from rigidfluid.core.setup.boundary_data import BoundaryPressure, BoundaryVelocity, Profile, TimeFactor
from rigidfluid.core.setup.profiles import Rectangle, couette, poiseuille, section
from rigidfluid.errors import SceneError


@dataclass(frozen=True)
class PeakOfFlux:
    """The velocity Q n/∫ profile at the peak of a profile, of a ``flux`` Q(t); ``per_flux`` (d,): n/∫ profile."""

    flux: Expression
    per_flux: FloatArray

    @property
    def names(self) -> frozenset[str]:
        """The names that it uses."""
        return self.flux.names

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """The velocity (N, d), the same at all ``points`` (N, d) [length/time]."""
        return self.flux(time, points)[:, None] * self.per_flux


def prescribed_velocity(table: VelocityTable, place: Place) -> BoundaryVelocity:
    """Velocity of a table with a velocity or flux; raises SceneError for an invalid expression, or a shape that the
    profile or a flux does not fit."""
    piece, at = place.piece, place.at
    profile = _profile(piece, table.profile, f"{at}.profile")
    if table.flux is not None:
        return BoundaryVelocity(_peak_of_flux(piece, profile, table.flux, f"{at}.flux"), profile, factor=_factor(table))
    assert table.velocity is not None
    velocity = VectorExpression.parse(table.velocity, f"{at}.velocity", f" on {piece.name!r}")
    return BoundaryVelocity(velocity, profile, factor=_factor(table))


def prescribed_pressure(table: PressureTable, place: Place) -> BoundaryPressure:
    """Pressure of an open end."""
    pressure = Expression(table.pressure, f"{place.at}.pressure", place.dimension, f" on {place.piece.name!r}")
    return BoundaryPressure(pressure, factor=_factor(table))


def pressure_drop(table: PeriodicTable, place: Place) -> BoundaryPressure | None:
    """Pressure on a periodic surface less the pressure on the opposite one [force/length^(d-1)]; None if not given."""
    if table.pressure_drop is None:
        return None
    return BoundaryPressure(
        Expression(table.pressure_drop, f"{place.at}.pressure_drop", 0, f" on {place.piece.name!r}")
    )


@dataclass(frozen=True)
class HeldFlux:
    """Flux Q(t) of fluid [length^d/time]."""

    flux: Expression

    def __call__(self, time: float) -> float:
        """The flux at a time."""
        return float(self.flux(time, np.zeros((1, 0)))[0])


def held_flux(table: PeriodicTable, place: Place) -> HeldFlux | None:
    """Flux into the domain through a periodic surface; None if not given."""
    if table.flux is None:
        return None
    return HeldFlux(Expression(table.flux, f"{place.at}.flux", 0, f" on {place.piece.name!r}"))


def wall_velocity(table: WallTable, dimension: int) -> WallVelocity | None:
    """Velocity of a wall's points by its ``table``; None for a wall at rest."""
    if table.velocity is None and table.angular_velocity is None:
        return None
    still = [0.0] * dimension
    velocity = np.array(table.velocity or still, dtype=float)
    return WallVelocity(velocity, np.array(table.angular_velocity or [0.0]), np.array(table.centre or still))


def _peak_of_flux(piece: Piece, profile: Profile | None, flux: float | str, at: str) -> PeakOfFlux:
    shape, plane = section(piece), piece.shape.plane
    if shape is None or plane is None:
        statement = f"a flux needs a segment, a rectangle across an axis or a disk, and {piece.name!r} is none of them"
        raise SceneError(at, statement, None, "Give `velocity` instead.")
    points, weights = shape.quadrature()
    whole = float(weights.sum() if profile is None else weights @ profile(points))
    # With no coordinates the only names are t and pi.
    return PeakOfFlux(Expression(flux, at, 0, f" on {piece.name!r}"), plane.unit_normal / whole)


def parabolic(coordinates: Callable[[FloatArray], FloatArray], points: FloatArray) -> FloatArray:
    """Product ∏ 4 s(1 - s) over a surface's own coordinates s from 0 to 1, (N,), at ``points`` (N, d)."""
    s = coordinates(points)
    return np.asarray(np.prod(4 * s * (1 - s), axis=1))


def _factor(table: VelocityTable | PressureTable) -> TimeFactor:
    assert table.over_time is None or isinstance(table.over_time, tuple), "files are read when the scene is loaded"
    return TimeFactor(table.over_time, table.ramp)


def _profile(piece: Piece, name: str, at: str) -> Profile | None:
    shape = section(piece)
    if name == "parabolic" and piece.coordinates is not None:
        return partial(parabolic, piece.coordinates)
    if name == "poiseuille" and shape is not None:
        return partial(poiseuille, shape)
    if name == "couette" and isinstance(shape, Rectangle) and len(shape.sides) == 1:
        return partial(couette, shape)
    if name == "uniform":
        return None
    needed = {
        "parabolic": "with coordinates of its own",
        "poiseuille": "that is a segment, a rectangle across an axis or a disk",
        "couette": "that is a segment, in 2D",
    }[name]
    developed = name == "parabolic" and shape is not None
    remedy = "Set it to 'poiseuille'." if developed else "Give `velocity` as expressions of x, y, z instead."
    raise SceneError(at, f"{name!r} needs a surface {needed}, unlike {piece.name!r}", None, remedy)
