"""The naive twin of the other detectors: any shapes, from dense samples and a local search."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.wall import Wall, radius_of
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose

Distance = Callable[[FloatArray], FloatArray]


class BruteForceOptions(PartOptions):
    """Keys of the ``[contact]`` table with detector ``brute_force``: ``samples``, points on each surface [1]."""

    samples: int = Field(
        default=1000, ge=100, description="Points tested on each surface before the nearest are refined [1]"
    )


class _Placed(NamedTuple):
    """A body where it stands, asked in lab coordinates."""

    shape: Body
    position: FloatArray
    rotation: FloatArray

    def signed_distance(self, points: FloatArray) -> FloatArray:
        return self.shape.signed_distance((points - self.position) @ self.rotation)

    def closest_point(self, points: FloatArray) -> FloatArray:
        local = self.shape.closest_point((points - self.position) @ self.rotation)
        return self.position + local @ self.rotation.T

    def sample_surface(self, count: int) -> FloatArray:
        return self.position + self.shape.sample_surface(count) @ self.rotation.T


class _Touch(NamedTuple):
    """One contact before it is put into arrays."""

    body_a: int
    body_b: int
    point_a: FloatArray
    point_b: FloatArray
    normal: FloatArray
    gap: float
    radius_a: float
    radius_b: float
    at_wall: bool


class BruteForceDetector(Detector):
    """gap = min over x on surface a of the signed distance to b; one contact for each pair of surfaces.

    The best of many samples starts a local minimisation on the surface, so that the gap of smooth convex bodies is
    accurate to rounding (the points to its square root). Costs grow with the square of the number of bodies.
    """

    name: ClassVar[str] = "brute_force"
    cost: ClassVar[float] = 4e5
    Options: ClassVar[type[PartOptions]] = BruteForceOptions
    options: BruteForceOptions

    @classmethod
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why any shapes are detected, at any cost."""
        return "the shapes are of any kind, and there is no mesh or no law"

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), from the shapes alone."""
        rotations = rotation_matrices(pose.orientation)
        placed = [_Placed(*row) for row in zip(self.bodies, pose.position, rotations, strict=True)]
        touches = self._body_touches(placed, reach) + self._wall_touches(placed, reach)
        near = sorted((touch for touch in touches if touch.gap <= reach), key=lambda touch: touch[:2])
        return _contacts(near, pose.position.shape[1])

    def _body_touches(self, placed: Sequence[_Placed], reach: float) -> list[_Touch]:
        count = len(placed)
        pairs = [(a, b) for a in range(count) for b in range(a + 1, count)]
        return [self._body_touch(placed, a, b) for a, b in pairs if _bounding_gap(placed[a], placed[b]) <= reach]

    def _body_touch(self, placed: Sequence[_Placed], a: int, b: int) -> _Touch:
        point_a, gap = _nearest(placed[a], placed[b].signed_distance, self.options.samples)
        point_b = placed[b].closest_point(point_a[None])[0]
        normal = _normal(placed[b], point_a, point_b, gap)
        radii = radius_of(placed[a].shape), radius_of(placed[b].shape)
        return _Touch(a, b, point_a, point_b, normal, gap, *radii, False)

    def _wall_touches(self, placed: Sequence[_Placed], reach: float) -> list[_Touch]:
        return [
            self._wall_touch(body, index, wall)
            for index, body in enumerate(placed)
            for wall in self.walls
            if wall.shape.signed_distance(body.position[None])[0] - body.shape.bounding_radius <= reach
        ]

    def _wall_touch(self, body: _Placed, index: int, wall: Wall) -> _Touch:
        point_a, gap = _nearest(body, wall.shape.signed_distance, self.options.samples)
        normal = wall.shape.normal(point_a[None])[0]
        radii = radius_of(body.shape), radius_of(wall.shape)
        return _Touch(index, wall.surface, point_a, point_a - gap * normal, normal, gap, *radii, True)


def _nearest(body: _Placed, distance: Distance, samples: int) -> tuple[FloatArray, float]:
    """The point of the surface where ``distance`` is least, and that least value."""
    surface = body.sample_surface(samples)
    start = surface[np.argmin(distance(surface))]
    nearest = _descend(body, distance, start)
    return nearest, float(distance(nearest[None])[0])


def _descend(body: _Placed, distance: Distance, start: FloatArray) -> FloatArray:
    from scipy.optimize import minimize

    size = body.shape.bounding_radius
    tangents = _tangents(body, start)

    def on_surface(steps: FloatArray) -> FloatArray:
        return body.closest_point((start + size * steps @ tangents)[None])

    def objective(steps: FloatArray) -> float:
        return float(distance(on_surface(steps))[0] / size)

    simplex = 0.01 * np.eye(len(tangents) + 1, len(tangents), k=-1)
    result = minimize(
        objective,
        np.zeros(len(tangents)),
        method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-16, "initial_simplex": simplex},
    )
    return np.asarray(on_surface(result.x)[0])


def _tangents(body: _Placed, point: FloatArray) -> FloatArray:
    """An orthonormal basis (d-1, d) across the surface's normal at ``point``."""
    _, _, axes = np.linalg.svd(_gradient(body, point)[None])
    return np.asarray(axes[1:])


def _gradient(body: _Placed, point: FloatArray) -> FloatArray:
    step = 1e-6 * body.shape.bounding_radius * np.eye(len(point))
    difference = body.signed_distance(point + step) - body.signed_distance(point - step)
    return np.asarray(difference / np.linalg.norm(difference))


def _normal(body: _Placed, point_a: FloatArray, point_b: FloatArray, gap: float) -> FloatArray:
    # the line from b to a has no direction where they touch
    if abs(gap) < 1e-4 * body.shape.bounding_radius:
        return _gradient(body, point_b)
    return np.asarray((point_a - point_b) / gap)


def _bounding_gap(a: _Placed, b: _Placed) -> float:
    return float(np.linalg.norm(a.position - b.position) - a.shape.bounding_radius - b.shape.bounding_radius)


def _contacts(touches: Sequence[_Touch], dimension: int) -> Contacts:
    columns = list(zip(*touches, strict=True)) or [()] * len(_Touch._fields)
    body_a, body_b, point_a, point_b, normal, gap, radius_a, radius_b, at_wall = columns
    shape = (len(touches), dimension)
    return Contacts(
        body_a=np.array(body_a, dtype=np.int64),
        body_b=np.array(body_b, dtype=np.int64),
        point_a=np.array(point_a, dtype=float).reshape(shape),
        point_b=np.array(point_b, dtype=float).reshape(shape),
        normal=np.array(normal, dtype=float).reshape(shape),
        gap=np.array(gap, dtype=float),
        radius_a=np.array(radius_a, dtype=float),
        radius_b=np.array(radius_b, dtype=float),
        at_wall=np.array(at_wall, dtype=bool),
    )
