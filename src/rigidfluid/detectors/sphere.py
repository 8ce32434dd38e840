"""Closed-form contacts of balls with each other and, through imaginary balls, with walls of any shape."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facet_surface import nearby
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.wall import Wall, radius_of
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import in_order
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.errors import SceneError

SPREAD = 0.5
"""Greatest difference of distance between places of one wall, over the smallest radius [1]; others are left out."""


class SphereDetector(Detector):
    """Balls at x_i: gap = |x_i - x_j| - r_i - r_j, normal = (x_i - x_j)/|x_i - x_j|.

    A wall acts as an imaginary ball of the same radius that touches it from outside: x_i' = x_i - (h + r) n with h the
    signed distance of x_i to the wall and n the wall's normal there, so that the gap is |x_i' - x_i| - 2r = h - r.
    Bodies other than balls raise SceneError.

    Notes
    -----
    Imaginary bodies: Van Landeghem et al., arXiv 2402.19093; here always tangent to the wall.
    """

    name: ClassVar[str] = "sphere"
    cost: ClassVar[float] = 1.0
    closed_form: ClassVar[bool] = True

    def __init__(self, options: PartOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        from rigidfluid.core.contact.pairs.near_pairs import NearPairs, flat_walls

        super().__init__(options, bodies, walls)
        self._radii = np.array([_radius(index, body) for index, body in enumerate(bodies)], dtype=float)
        flat = [wall for wall in walls if wall.shape.plane]
        self._surfaces = np.array([wall.surface for wall in flat], dtype=np.int64)
        self._pairs = NearPairs(self._radii, flat_walls(bodies, walls))
        self._curved = [wall for wall in walls if not wall.shape.plane]

    @classmethod
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why balls alone are detected exactly; None if a body is no ball."""
        return "all bodies are balls" if all(body.radius is not None for body in bodies) else None

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the positions alone."""
        near = self._flat_contacts(pose.position, reach)
        if not self._curved:
            return near
        return in_order([near, *(self._curved_contacts(pose.position, wall, reach) for wall in self._curved)])

    def _flat_contacts(self, position: FloatArray, reach: float) -> Contacts:
        """Contacts of balls with balls and flat walls."""
        from rigidfluid.detectors.sphere_contacts import contact_columns

        near, walls = self._pairs.within(position, reach), (self._pairs.planes, self._surfaces)
        return Contacts(*contact_columns((position, self._radii), (near.start, near.second), walls, reach))

    def _curved_contacts(self, position: FloatArray, wall: Wall, reach: float) -> Contacts:
        """Contacts of balls with one wall, h by its signed distance; with facets at all places nearest around."""
        found = nearby(wall.shape, position, reach + float(self._radii.max()), SPREAD * float(self._radii.min()))
        gap = found.distance - self._radii[found.point]
        order = np.argsort(gap, kind="stable")
        chosen = order[gap[order] <= reach]
        near, gap, normal = found.point[chosen], gap[chosen], found.normal[chosen]
        centre, radius = position[near], self._radii[near]
        return Contacts(
            body_a=near,
            body_b=np.full(len(near), wall.surface),
            point_a=centre - radius[:, None] * normal,
            point_b=centre - (gap + radius)[:, None] * normal,
            normal=normal,
            gap=gap,
            radius_a=radius,
            radius_b=np.full(len(near), radius_of(wall.shape)),
            at_wall=np.ones(len(near), dtype=bool),
        )


def _radius(index: int, body: Body) -> float:
    if body.radius is not None:
        return body.radius
    raise SceneError(
        "contact.detector",
        f'"sphere" with body.{index} of type "{body.name}"',
        "balls only",
        'Use detector = "auto", which takes one for these shapes.',
    )
