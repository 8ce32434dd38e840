"""The detector "coal"."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from rigidfluid.api import (
    Body,
    BoolArray,
    Contacts,
    Detector,
    FloatArray,
    IntArray,
    Mesh,
    PartOptions,
    Piece,
    Plane,
    Pose,
    Wall,
    require_plane,
    rotation_matrices,
)
from rigidfluid_coal.broad_phase import near_pairs
from rigidfluid_coal.narrow_phase import NarrowPhase
from rigidfluid_coal.refinement import extent, farthest, refined, separation, shape_matrices
from rigidfluid_coal.shapes import semi_axes

_COLUMNS = tuple(name for name in Contacts.__slots__ if name not in ("shift", "curvatures"))
"""Columns of contacts; displacements of images and curvatures of ellipsoids are none of a detector's."""


class CoalDetector(Detector):
    """Contacts of balls and ellipsoids (disks and ellipses in 2D) with each other and with flat walls.

    Pairs whose bounding balls are near go to coal, which finds their normal; Newton's method on the support functions
    then makes the gap accurate to round-off. A wall's normal is known, and the gap there is in closed form. Where two
    bodies overlap, the gap is minus the shortest way apart.

    Parameters
    ----------
    options : PartOptions
        None are read.
    bodies : sequence of Body
        Balls and ellipsoids.
    walls : sequence of Wall
        The walls that repel.

    Raises
    ------
    SceneError
        If a body is neither a ball nor an ellipsoid, or a wall is not flat.
    """

    name: ClassVar[str] = "coal"
    cost: ClassVar[float] = 300.0
    requires: ClassVar[Mapping[str, str]] = {"coal": "coal (`pip install coal`)"}

    def __init__(self, options: PartOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        super().__init__(options, bodies, walls)
        self._flat = [(wall.surface, require_plane(wall, self.name)) for wall in walls]
        self._axes = np.array([semi_axes(index, body) for index, body in enumerate(bodies)])
        self._bounding = self._axes.max(axis=1)
        self._radii = np.array([np.nan if body.radius is None else body.radius for body in bodies])
        self._narrow = NarrowPhase(self._axes)

    @classmethod
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why balls and ellipsoids between flat walls are met exactly, or None."""
        taken = all(body.semi_axes is not None for body in bodies) and all(piece.shape.plane for piece in pieces)
        return "all bodies are balls or ellipsoids and all walls flat" if taken else None

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the shapes alone."""
        rotation = rotation_matrices(pose.orientation)
        shapes = shape_matrices(rotation, self._axes)
        found = [self._body_contacts(pose.position, rotation, shapes, reach)]
        found += [self._wall_contacts(pose.position, shapes, *wall, reach) for wall in self._flat]
        return _sorted(found)

    def _body_contacts(self, position: FloatArray, rotation: FloatArray, shapes: FloatArray, reach: float) -> Contacts:
        body_a, body_b = near_pairs(position, self._bounding, reach)
        offset, shape_a, shape_b = position[body_a] - position[body_b], shapes[body_a], shapes[body_b]
        normal = self._narrow.normals(body_a, body_b, position, rotation)
        normal = refined(normal, offset, shape_a, shape_b)
        gap = separation(normal, offset, shape_a, shape_b)
        contacts = Contacts(
            body_a=body_a,
            body_b=body_b,
            point_a=position[body_a] - farthest(shape_a, normal),
            point_b=position[body_b] + farthest(shape_b, normal),
            normal=normal,
            gap=gap,
            radius_a=self._radii[body_a],
            radius_b=self._radii[body_b],
            at_wall=np.zeros(len(body_a), dtype=bool),
        )
        return _take(contacts, gap <= reach)

    def _wall_contacts(
        self, position: FloatArray, shapes: FloatArray, surface: int, plane: Plane, reach: float
    ) -> Contacts:
        normal = plane.normal(position)
        gap = plane.signed_distance(position) - extent(shapes, normal)
        point = position - farthest(shapes, normal)
        contacts = Contacts(
            body_a=np.arange(len(position)),
            body_b=np.full(len(position), surface),
            point_a=point,
            point_b=point - gap[:, None] * normal,
            normal=normal,
            gap=gap,
            radius_a=self._radii,
            radius_b=np.full(len(position), np.inf),
            at_wall=np.ones(len(position), dtype=bool),
        )
        return _take(contacts, gap <= reach)


def _take(contacts: Contacts, chosen: IntArray | BoolArray) -> Contacts:
    return Contacts(**{name: getattr(contacts, name)[chosen] for name in _COLUMNS})


def _sorted(parts: Sequence[Contacts]) -> Contacts:
    merged = Contacts(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in _COLUMNS})
    return _take(merged, np.lexsort((merged.body_b, merged.body_a)))
