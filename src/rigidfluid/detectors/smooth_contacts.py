"""Contacts of the true shapes of balls, ellipses and ellipsoids with each other and with flat and round walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.contact.pairs.broad_phase import near_pairs
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.unit_sphere import unit_sphere_points
from rigidfluid.core.geometry.wall import Wall, centre_of, is_round, radius_of
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.detectors.ellipsoid_in_hollow import farthest_points
from rigidfluid.detectors.in_space import in_space
from rigidfluid.errors import StepError

_STARTS = 16

_ON_THE_WALL = 1e-6
"""Distance of a point of a round surface from a part of it, over the radius, above which it is beyond the part's
end."""


class SmoothContacts:
    """gap = max over unit n of n·(x_a - x_b) - h_a(n) - h_b(n), with h(n) = |diag(a) Rᵀn| the reach of an ellipsoid.

    ``bodies`` have semi-axes, and ``walls`` are flat or round.
    """

    def __init__(self, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        self._axes = [body.semi_axes for body in bodies if body.semi_axes is not None]
        self._round = [(wall, centre_of(wall.shape)) for wall in walls if is_round(wall.shape)]
        self._flat = [(wall.surface, plane) for wall in walls if (plane := wall.shape.plane)]
        self._bounds = np.array([body.bounding_radius for body in bodies], dtype=float)
        self._radii = np.array([radius_of(body) for body in bodies], dtype=float)

    def pair_contacts(self, pose: Pose, reach: float) -> Contacts:
        """Contacts of bodies with each other, up to a gap of ``reach`` [length]; StepError if one has no normal."""
        return self._body_contacts(pose.position, self._half(pose), reach)

    def wall_contacts(self, pose: Pose, reach: float) -> list[Contacts]:
        """Contacts of the bodies with each wall, some beyond ``reach`` [length]."""
        half = self._half(pose)
        found = [self._flat_contacts(pose.position, half, *wall) for wall in self._flat]
        for wall, centre in self._round:
            touching = self._bump_contacts if radius_of(wall.shape) > 0 else self._hollow_contacts
            found.append(touching(pose.position, half, wall, centre, reach))
        return found

    def _half(self, pose: Pose) -> FloatArray:
        axes = np.reshape(self._axes, pose.position.shape)
        return np.asarray(rotation_matrices(pose.orientation) * axes[:, None, :])

    def _body_contacts(self, position: FloatArray, half: FloatArray, reach: float) -> Contacts:
        body_a, body_b = near_pairs(position, self._bounds, reach)
        normal, near = _normals(position, half, body_a, body_b, reach)
        body_a, body_b = body_a[near], body_b[near]
        point_a = position[body_a] - _farthest(half[body_a], normal)
        point_b = position[body_b] + _farthest(half[body_b], normal)
        return Contacts(
            body_a=body_a,
            body_b=body_b,
            point_a=point_a,
            point_b=point_b,
            normal=normal,
            gap=np.sum((point_a - point_b) * normal, axis=1),
            radius_a=self._radii[body_a],
            radius_b=self._radii[body_b],
            at_wall=np.zeros(len(body_a), dtype=bool),
        )

    def _flat_contacts(self, position: FloatArray, half: FloatArray, surface: int, plane: Plane) -> Contacts:
        normal = np.broadcast_to(plane.unit_normal, position.shape)
        point_a = position - _farthest(half, normal)
        gap = plane.signed_distance(point_a)
        return Contacts(
            body_a=np.arange(len(position)),
            body_b=np.full(len(position), surface),
            point_a=point_a,
            point_b=point_a - gap[:, None] * normal,
            normal=normal,
            gap=gap,
            radius_a=self._radii,
            radius_b=np.full(len(position), np.inf),
            at_wall=np.ones(len(position), dtype=bool),
        )

    def _bump_contacts(
        self, position: FloatArray, half: FloatArray, wall: Wall, centre: FloatArray, reach: float
    ) -> Contacts:
        """Contacts with a wall that is a ball's surface."""
        radius, count = radius_of(wall.shape), len(position)
        near = np.flatnonzero(np.linalg.norm(position - centre, axis=1) - self._bounds - radius <= reach)
        ball = radius * np.eye(len(centre))
        both = np.vstack([position, centre]), np.concatenate([half, ball[None]])
        normal, found = _normals(*both, near, np.full(len(near), count), reach)
        body = near[found]
        point_a, point_b = position[body] - _farthest(half[body], normal), centre + radius * normal
        return self._round_wall_contacts(body, wall, point_a, point_b, normal)

    def _hollow_contacts(
        self, position: FloatArray, half: FloatArray, wall: Wall, centre: FloatArray, reach: float
    ) -> Contacts:
        """Contacts with a wall that is a ball's surface seen from inside, as far as it goes."""
        radius = -radius_of(wall.shape)
        near = np.flatnonzero(np.linalg.norm(position - centre, axis=1) + self._bounds >= radius - reach)
        first, other, there = farthest_points(position[near] - centre, half[near])
        body, away = np.concatenate([near, near[there]]), np.concatenate([first, other[there]])
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        point_b = centre + radius * away / distance
        ends = np.linalg.norm(wall.shape.closest_point(point_b) - point_b, axis=1) <= _ON_THE_WALL * radius
        found = self._round_wall_contacts(body, wall, centre + away, point_b, -away / distance)
        return select(found, np.flatnonzero(ends)[np.argsort(found.gap[ends], kind="stable")])

    def _round_wall_contacts(
        self, body: IntArray, wall: Wall, point_a: FloatArray, point_b: FloatArray, normal: FloatArray
    ) -> Contacts:
        return Contacts(
            body_a=body,
            body_b=np.full(len(body), wall.surface),
            point_a=point_a,
            point_b=point_b,
            normal=normal,
            gap=np.sum((point_a - point_b) * normal, axis=1),
            radius_a=self._radii[body],
            radius_b=np.full(len(body), radius_of(wall.shape)),
            at_wall=np.ones(len(body), dtype=bool),
        )


def _normals(
    position: FloatArray, half: FloatArray, body_a: IntArray, body_b: IntArray, reach: float
) -> tuple[FloatArray, IntArray]:
    """Normals (k, d) of the pairs that are in reach, and which pairs (k,) these are."""
    dimension = position.shape[1]
    if len(body_a) == 0:
        return np.empty((0, dimension)), body_a
    from rigidfluid.detectors.ellipsoid_separation import BEYOND, LOST, separate

    offset = in_space(position[body_a] - position[body_b])
    normal, state = np.empty_like(offset), np.empty(len(offset), dtype=np.int64)
    directions = in_space(unit_sphere_points(_STARTS, dimension))
    separate(offset, body_a, body_b, _solids(half), directions, reach, normal, state)
    lost = np.flatnonzero(state == LOST)
    if len(lost):
        raise _no_normal(int(body_a[lost[0]]), int(body_b[lost[0]]), offset[lost[0], :dimension])
    near = np.flatnonzero(state != BEYOND)
    return normal[near, :dimension], near


def _no_normal(a: int, b: int, offset: FloatArray) -> StepError:
    return StepError(
        f"bodies {a} and {b}",
        f"no common normal, with their centres {offset.tolist()} apart",
        "finite positions and orientations",
        'Look at how the bodies move before this; `detector = "brute_force"` is another way to their gap.',
    )


def _farthest(half: FloatArray, normal: FloatArray) -> FloatArray:
    """Points S Sᵀn/|Sᵀn| (m, d) of ellipsoids ``half`` S (m, d, d) in directions n (m, d), from their centres."""
    on_ball = np.einsum("mij,mi->mj", half, normal)
    on_ball /= np.linalg.norm(on_ball, axis=1, keepdims=True)
    return np.asarray(np.einsum("mij,mj->mi", half, on_ball))


def _solids(half: FloatArray) -> FloatArray:
    """The matrices S (n, 3, 3), in the plane with a third semi-axis as long as the first."""
    if half.shape[1] == 3:
        return half
    solids = np.zeros((len(half), 3, 3))
    solids[:, :2, :2], solids[:, 2, 2] = half, np.linalg.norm(half[:, :, 0], axis=1)
    return solids
