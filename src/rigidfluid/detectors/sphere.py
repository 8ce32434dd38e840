"""Closed-form contacts of balls with each other and, through imaginary balls, with flat walls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from rigidfluid.core.model.interfaces import Body, Detector, PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose, Wall
from rigidfluid.errors import SceneError


class SphereDetector(Detector):
    """Balls at x_i: gap = |x_i - x_j| - r_i - r_j, normal = (x_i - x_j)/|x_i - x_j|.

    A flat wall acts as an imaginary ball of the same radius that touches the wall from outside: x_i' = x_i - (h + r) n
    with h the height of x_i above the wall and n the wall's normal, so that the gap is |x_i' - x_i| - 2r = h - r.

    Parameters
    ----------
    options : PartOptions
        None are read.
    bodies : sequence of Body
        Balls only.
    walls : sequence of Wall
        The walls that repel.

    Raises
    ------
    SceneError
        If a body is not a ball.

    Notes
    -----
    Imaginary bodies: Van Landeghem et al., arXiv 2402.19093; here always tangent to the wall.
    """

    name: ClassVar[str] = "sphere"

    def __init__(self, options: PartOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        from rigidfluid.core.contact.near_pairs import NearPairs

        super().__init__(options, bodies, walls)
        self._radii = np.array([_radius(index, body) for index, body in enumerate(bodies)], dtype=float)
        self._pairs = NearPairs(self._radii)
        self._surfaces = np.array([wall.surface for wall in walls], dtype=np.int64)
        self._planes = np.array([[wall.point, wall.normal] for wall in walls], dtype=float)

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the positions alone."""
        from rigidfluid.detectors.sphere_contacts import near_surfaces, points_and_normals

        position, radii = pose.position, self._radii
        pairs = self._pairs.within(position, reach)
        planes = self._planes.reshape(-1, 2, position.shape[1])
        a, b, gap = near_surfaces(position, radii, pairs.start, pairs.second, planes, self._surfaces, reach)
        point_a, point_b, normal = points_and_normals(position, radii, planes, self._surfaces, a, b)
        # behind the bodies' radii that of any wall
        all_radii = np.append(radii, np.inf)
        return Contacts(
            body_a=a,
            body_b=b,
            point_a=point_a,
            point_b=point_b,
            normal=normal,
            gap=gap,
            radius_a=radii[a],
            radius_b=all_radii[np.minimum(b, len(radii))],
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
