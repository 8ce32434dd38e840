"""The fluid domain Ω \\ ∪ B_i: the domain minus the bodies at a pose, which is what a mesh fills."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.frames import distance_to_body, to_body_frame, to_world
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose


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
            return self._closest_on_body(surface, points)
        there = self.domain.wrapped(points)
        return self.domain.pieces[surface - len(self.bodies)].shape.closest_point(there) + (points - there)

    def _closest_on_body(self, body: int, points: FloatArray) -> FloatArray:
        """The closest points (N, d) of a body and its images."""
        found, best = np.empty_like(points), np.full(len(points), np.inf)
        for way in self.images:
            in_frame = to_body_frame(self.pose, body, points - way)
            closest = way + to_world(self.pose, body, self.bodies[body].closest_point(in_frame))
            distance = np.linalg.norm(closest - points, axis=1)
            nearer = ~(distance >= best)
            found[nearer], best[nearer] = closest[nearer], distance[nearer]
        return found

    @property
    def images(self) -> FloatArray:
        """Displacements of the bodies' images from their poses, (c, d), none first: those in all periods around the
        poses [length]."""
        ways = self.domain.lattice
        steps = sorted(product((-1, 0, 1), repeat=len(ways)), key=lambda step: sum(map(abs, step)))
        return np.asarray(np.array(steps, dtype=float).reshape(len(steps), len(ways)) @ ways)

    def periods_outside(self) -> IntArray:
        """Whole periods that the bodies' centres are away from the domain, (n, k)."""
        ways, position = self.domain.lattice, self.pose.position
        firsts = [self.domain.pieces[first].shape for first, _ in self.domain.periodic]
        ahead = [(position - shape.closest_point(position)) @ way for shape, way in zip(firsts, ways, strict=True)]
        outside = np.floor(np.reshape(ahead, (len(ways), len(position))).T / (ways**2).sum(axis=1))
        return np.asarray(outside.astype(np.int64))

    def placed_on(self, mesh: Mesh) -> FluidDomain:
        """The same with the images of the bodies that are on a ``mesh``."""
        return self if mesh.periods is None else replace(self, pose=mesh.images_of(self.pose))

    def body_distances(self, points: FloatArray) -> FloatArray:
        """Distance of points (N, d) from each body, negative inside, (n, N) [length]."""
        return np.array([distance_to_body(self.pose, i, body, points) for i, body in enumerate(self.bodies)])

    def two_nearest_bodies(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Distances to the nearest and to the second nearest body or image of one, each (N,), infinite where beyond
        ``reach`` [length]."""
        first, second = np.full((2, len(points)), np.inf)
        columns = np.ascontiguousarray(points.T)
        for (i, body), way in product(enumerate(self.bodies), self.images):
            centre = self.pose.position[i] + way
            square = sum((column - place) ** 2 for column, place in zip(columns, centre, strict=True))
            near = np.flatnonzero(square < (np.minimum(reach, second) + body.bounding_radius) ** 2)
            distance = np.maximum(distance_to_body(self.pose, i, body, points[near] - way), 0.0)
            second[near] = np.minimum(second[near], np.maximum(first[near], distance))
            first[near] = np.minimum(first[near], distance)
        return first, second

    def nearest_wall(self, points: FloatArray) -> FloatArray:
        """Distance to the nearest wall, (N,), infinite without walls [length]."""
        distance, there = np.full(len(points), np.inf), self.domain.wrapped(points)
        for wall in self.walls:
            np.minimum(distance, np.maximum(wall.shape.signed_distance(there), 0.0), out=distance)
        return distance

    def gap_widths(self, points: FloatArray) -> FloatArray:
        """Distance to the nearest body and that to the next surface together, (N,) [length]."""
        first, second = self.two_nearest_bodies(points, np.inf)
        periodic = self.domain.periodic_pieces
        there = self.domain.wrapped(points)
        for number, piece in enumerate(self.domain.pieces):
            if number not in periodic:
                np.minimum(second, np.abs(piece.shape.signed_distance(there)), out=second)
        return first + second


def fluid_domain_at(system: System, pose: Pose) -> FluidDomain:
    """The part of a system's fluid domain that is meshed while its bodies are at ``pose``."""
    return FluidDomain(system.bodies, pose, system.meshed(pose), system.walls)
