"""Prescribed velocities at points of a surface and at times of the run: their fluxes, and their greatest speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.fluid.conditions import BoundaryCondition
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.setup.boundary_data import BoundaryData, BoundaryVelocity, boundary_velocity
from rigidfluid.core.setup.profiles import section

_TIMES, _ROWS = 65, 500
"""Times in a run, and rows of a table, that are looked at."""


@dataclass(frozen=True)
class SampledInflow:
    """A ``velocity`` prescribed on a ``piece``, with ``points`` (N, d) and ``weights`` (N,) of an integral over it.

    A flat piece of unknown section has one point, and then only a uniform velocity has a flux.
    """

    piece: Piece
    velocity: BoundaryVelocity
    points: FloatArray
    weights: FloatArray

    def flux(self, time: float) -> float | None:
        """Flux into the domain ∫ u·n [length^d/time]; None where it is not known."""
        plane = self.piece.shape.plane
        if plane is None or (len(self.points) == 1 and not self.velocity.is_uniform):
            return None
        return float(self.weights @ (self.velocity(time, self.points) @ plane.unit_normal))

    def speed(self, time: float) -> float:
        """Greatest speed at the points, where the profile is 1 [length/time]."""
        points = self.points if self.velocity.value.names & {"x", "y", "z"} else self.points[:1]
        return max(float(np.linalg.norm(velocity)) for velocity in self.velocity.peak(time, points))


def sampled_inflows(conditions: Sequence[BoundaryCondition], domain: Domain) -> list[SampledInflow]:
    """Velocities that are prescribed on surfaces that are not walls."""
    return [
        SampledInflow(piece, boundary_velocity(condition.data), *quadrature(piece, domain))
        for condition, piece in zip(conditions, domain.pieces, strict=True)
        if condition.holds_all and condition.passes
    ]


def sample_times(conditions: Sequence[BoundaryCondition], end: float, *, steady: bool) -> FloatArray:
    """Times from 0 to the ``end``, with those where a table over time has a row; the first alone where all is steady.

    A long table contributes every n-th row and the row with the greatest value.
    """
    every: list[object] = [condition.data for condition in conditions]
    known = [data for data in every if isinstance(data, BoundaryData)]
    tables = [data.factor.table for data in known if data.factor.table]
    rows = [row for table in tables for row in (*table[:: 1 + len(table) // _ROWS], max(table, key=_size))]
    times = np.concatenate([np.linspace(0.0, end, _TIMES), [time for time, _ in rows]])
    return times[:1] if steady else np.unique(times[(times >= 0.0) & (times <= end)])


def quadrature(piece: Piece, domain: Domain) -> tuple[FloatArray, FloatArray]:
    """Points (N, d) and weights (N,) of an integral over a piece of the domain.

    A curved piece has points all over it, a flat piece of unknown section a single one.
    """
    shape = section(piece)
    if shape is not None:
        return shape.quadrature()
    points = points_of(piece.shape, domain)
    points = points if piece.shape.plane is None else points.mean(axis=0, keepdims=True)
    return points, np.full(len(points), piece.area / len(points))


def _size(row: tuple[float, float]) -> float:
    return abs(row[1])


def points_of(shape: Surface, domain: Domain) -> FloatArray:
    """Points all over a surface of the domain, (100, d) [length]."""
    lower, upper = (np.clip(corner, *domain.extent) for corner in shape.bounds)
    return shape.closest_point(np.random.default_rng(0).uniform(lower, upper, (100, domain.dimension)))
