"""Closed-form contacts of balls with each other and, through imaginary balls, with flat walls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from rigidfluid.core.broad_phase import near_pairs
from rigidfluid.core.contacts import in_order, select
from rigidfluid.core.interfaces import Body, Detector, PartOptions
from rigidfluid.core.types import Contacts, FloatArray, Mesh, Pose, Wall
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
        super().__init__(options, bodies, walls)
        self._radii = np.array([_radius(index, body) for index, body in enumerate(bodies)], dtype=float)

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the positions alone."""
        found = [_ball_contacts(pose.position, self._radii, reach)]
        found += [_wall_contacts(pose.position, self._radii, wall, reach) for wall in self.walls]
        return in_order(found)


def _radius(index: int, body: Body) -> float:
    if body.radius is not None:
        return body.radius
    raise SceneError(
        "contact.detector",
        f'"sphere" with body.{index} of type "{body.name}"',
        "balls only",
        'Use detector = "auto", which takes one for these shapes.',
    )


def _ball_contacts(position: FloatArray, radii: FloatArray, reach: float) -> Contacts:
    body_a, body_b = near_pairs(position, radii, reach)
    line = position[body_a] - position[body_b]
    distance = np.linalg.norm(line, axis=1)
    gap = distance - radii[body_a] - radii[body_b]
    normal = _unit(line, distance)
    contacts = Contacts(
        body_a=body_a,
        body_b=body_b,
        point_a=position[body_a] - radii[body_a, None] * normal,
        point_b=position[body_b] + radii[body_b, None] * normal,
        normal=normal,
        gap=gap,
        radius_a=radii[body_a],
        radius_b=radii[body_b],
    )
    return select(contacts, gap <= reach)


def _wall_contacts(position: FloatArray, radii: FloatArray, wall: Wall, reach: float) -> Contacts:
    height = (position - wall.point) @ wall.normal
    normal = np.broadcast_to(wall.normal, position.shape)
    contacts = Contacts(
        body_a=np.arange(len(radii)),
        body_b=np.full(len(radii), wall.surface),
        point_a=position - radii[:, None] * normal,
        point_b=position - height[:, None] * normal,
        normal=normal,
        gap=height - radii,
        radius_a=radii,
        radius_b=np.full(len(radii), np.inf),
    )
    return select(contacts, contacts.gap <= reach)


def _unit(line: FloatArray, distance: FloatArray) -> FloatArray:
    """Directions; the first axis for balls with a common centre, where any direction will do."""
    together = (distance == 0)[:, None]
    return np.where(together, np.eye(1, line.shape[1]), line / np.where(together, 1.0, distance[:, None]))
