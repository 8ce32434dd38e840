"""The fluid domain Ω \\ ∪ B_i: the domain minus the bodies at a pose, which is what a mesh fills."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.frames import distance_to_body, to_body_frame, to_world
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose


@dataclass(frozen=True, slots=True)
class FluidDomain:
    """The ``domain`` minus the ``bodies`` at their ``pose``, and the ``walls`` that make gaps with them.

    Surfaces have the numbers of a mesh's markers: bodies 0 … n-1, then the domain's pieces.
    """

    bodies: Sequence[Body]
    pose: Pose
    domain: Domain
    walls: Sequence[Wall]

    @property
    def width(self) -> float:
        """Longest side of the box around the domain [length]."""
        return float(np.max(self.domain.size))

    def closest_points(self, surface: int, points: FloatArray) -> FloatArray:
        """The closest points (N, d) of a surface, by its number, to ``points`` (N, d) [length]."""
        if surface < len(self.bodies):
            in_frame = to_body_frame(self.pose, surface, points)
            return to_world(self.pose, surface, self.bodies[surface].closest_point(in_frame))
        return self.domain.pieces[surface - len(self.bodies)].shape.closest_point(points)

    def body_distances(self, points: FloatArray) -> FloatArray:
        """Distance of points (N, d) from each body, negative inside, (n, N) [length]."""
        return np.array([distance_to_body(self.pose, i, body, points) for i, body in enumerate(self.bodies)])

    def two_nearest_bodies(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Distances to the nearest and to the second nearest body, each (N,), infinite where beyond ``reach``
        [length]."""
        first, second = np.full((2, len(points)), np.inf)
        columns = np.ascontiguousarray(points.T)
        for i, body in enumerate(self.bodies):
            square = sum((column - place) ** 2 for column, place in zip(columns, self.pose.position[i], strict=True))
            near = np.flatnonzero(square < (np.minimum(reach, second) + body.bounding_radius) ** 2)
            distance = np.maximum(distance_to_body(self.pose, i, body, points[near]), 0.0)
            second[near] = np.minimum(second[near], np.maximum(first[near], distance))
            first[near] = np.minimum(first[near], distance)
        return first, second

    def nearest_wall(self, points: FloatArray) -> FloatArray:
        """Distance to the nearest wall, (N,), infinite without walls [length]."""
        distance = np.full(len(points), np.inf)
        for wall in self.walls:
            np.minimum(distance, np.maximum(wall.shape.signed_distance(points), 0.0), out=distance)
        return distance

    def gap_widths(self, points: FloatArray) -> FloatArray:
        """Distance to the nearest body and that to the next surface together, (N,) [length]."""
        first, second = self.two_nearest_bodies(points, np.inf)
        for piece in self.domain.pieces:
            np.minimum(second, np.abs(piece.shape.signed_distance(points)), out=second)
        return first + second


def fluid_domain_at(system: System, pose: Pose) -> FluidDomain:
    """The part of a system's fluid domain that is meshed while its bodies are at ``pose``."""
    return FluidDomain(system.bodies, pose, system.meshed(pose), system.walls)
