"""Gaps of bodies to each other and to walls that are less than they should be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from rigidfluid.core.contact.pairs.image_detection import ImageDetection
from rigidfluid.core.contact.path.detector_choice import exact_detector
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.registry import Registry

_DEAR = 1e4
"""Cost of a detector, as `Detector.cost`, from which on it is too slow to be asked hundreds of times."""


class Gaps(NamedTuple):
    """Gaps (m,) of bodies ``a`` (m,) to others ``b`` (m,), -1 of walls; nearest points ``point_a`` of a and ``point_b``
    of b (m, d) [length], and unit ``normal`` from b to a (m, d)."""

    a: IntArray
    b: IntArray
    point_a: FloatArray
    point_b: FloatArray
    normal: FloatArray
    gap: FloatArray


@dataclass(frozen=True)
class Surroundings:
    """Surfaces around a swarm: the ``pieces`` of the domain's boundary, and the ``surfaces`` of its region; the
    ``lattice`` of bodies' images, without vectors where there are none; the parts that are installed."""

    pieces: tuple[Piece, ...]
    surfaces: tuple[Surface, ...]
    lattice: Lattice
    registry: Registry

    @property
    def all(self) -> tuple[Surface, ...]:
        """All of them."""
        return (*(piece.shape for piece in self.pieces), *self.surfaces)

    def parted(self, bodies: Sequence[Body]) -> tuple[type[Detector], tuple[Surface, ...], tuple[Surface, ...]]:
        """A detector that is exact for bodies, the surfaces that it is exact for too, and the others, to which the
        bodies' bounding balls keep their gaps."""
        inner = [Piece(f"region {number}", surface, np.nan) for number, surface in enumerate(self.surfaces)]
        flat = [piece for piece in inner if piece.shape.plane]
        curved = tuple(piece.shape for piece in inner if not piece.shape.plane)
        detector = exact_detector(bodies, [*self.pieces, *flat], self.registry)
        taken = [*self.pieces, *flat]
        if detector.cost > _DEAR:
            taken = [piece for piece in taken if piece.shape.plane]
            curved += tuple(piece.shape for piece in self.pieces if not piece.shape.plane)
            detector = exact_detector(bodies, taken, self.registry)
        return detector, tuple(piece.shape for piece in taken), curved


class Clearance:
    """Gaps of ``bodies``, of which the first ``moving`` ones are looked at, to each other, to images of others and to
    what is around."""

    def __init__(self, bodies: Sequence[Body], moving: int, around: Surroundings) -> None:
        detector, walls, self._curved = around.parted(bodies)
        count = len(bodies)
        placed = [Wall(count + number, str(number), shape) for number, shape in enumerate(walls)]
        make = partial(detector, detector.Options())
        if len(around.lattice.vectors):
            self._detect = ImageDetection(make, bodies, placed, around.lattice).detect
        else:
            self._detect = partial(_detected, make(bodies, placed))
        self._count, self._moving = count, moving
        self._bounds = np.array([body.bounding_radius for body in bodies[:moving]])

    def within(self, pose: Pose, reach: float) -> Gaps:
        """All gaps up to ``reach`` [length] at a ``pose`` of all bodies."""
        found = self._detect(pose, reach)
        found = select(found, found.body_a < self._moving)
        other = np.where(found.body_b < self._count, found.body_b, -1)
        on_b = found.point_b if found.shift is None else found.point_b - found.shift
        told = Gaps(found.body_a, other, found.point_a, on_b, found.normal, found.gap)
        of_balls = [self._ball_gaps(surface, pose.position[: self._moving], reach) for surface in self._curved]
        return _joined([told, *of_balls])

    def _ball_gaps(self, surface: Surface, position: FloatArray, reach: float) -> Gaps:
        """Gaps of bounding balls to one surface, up to ``reach`` [length]."""
        gap = surface.signed_distance(position) - self._bounds
        near = np.flatnonzero(gap <= reach)
        normal = surface.normal(position[near])
        point_a = position[near] - self._bounds[near, None] * normal
        return Gaps(near, np.full(len(near), -1), point_a, point_a - gap[near, None] * normal, normal, gap[near])


def _detected(detector: Detector, pose: Pose, reach: float) -> Contacts:
    """Contacts without images."""
    return detector.detect(pose, None, reach)


def _joined(parts: Sequence[Gaps]) -> Gaps:
    columns: list[Any] = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return Gaps(*columns)
