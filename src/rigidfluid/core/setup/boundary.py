"""The faces of a box: their names, what the scene says holds on each, and the values prescribed there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.model.types import BoundaryCondition, FloatArray, Wall

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import BoundaryTable, Scene

FACES = ("left", "right", "bottom", "top", "back", "front")


@dataclass(frozen=True)
class FaceVelocity:
    """Velocity prescribed on a face of the box.

    Uniform, or parabolic: peak · ∏ 4 s(1 - s) over the face's own coordinates s, each from 0 to 1.
    """

    peak: FloatArray
    lower: FloatArray
    upper: FloatArray
    axis: int
    parabolic: bool

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Velocity (N, d) at ``points`` (N, d) [length/time]."""
        return self._shape(points)[:, None] * self.peak

    def _shape(self, points: FloatArray) -> FloatArray:
        if not self.parabolic:
            return np.ones(len(points))
        s = np.delete((points - self.lower) / (self.upper - self.lower), self.axis, axis=1)
        return np.asarray(np.prod(4 * s * (1 - s), axis=1))

    @property
    def mean(self) -> FloatArray:
        """Mean over the face, (d,) [length/time]."""
        # ∫₀¹ 4 s(1 - s) ds = 2/3 for each coordinate of the face.
        return self.peak * (2 / 3) ** (len(self.peak) - 1) if self.parabolic else self.peak


@dataclass(frozen=True)
class FacePressure:
    """Pressure prescribed on a face of the box, the same everywhere [force/length^(d-1)]."""

    pressure: float

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Pressure (N,) at ``points`` (N, d)."""
        return np.full(len(points), self.pressure)


def faces(dimension: int) -> tuple[str, ...]:
    """Names of a box's faces in the order of their surface numbers."""
    return FACES[: 2 * dimension]


def inward_normal(face: int, dimension: int) -> FloatArray:
    """Unit normal (d,) of the face of this number, into the box."""
    normal = np.zeros(dimension)
    normal[face // 2] = -1.0 if face % 2 else 1.0
    return normal


def face_table(scene: Scene, name: str) -> BoundaryTable | None:
    """What the scene says of a face: its last entry for it or for all; None means a wall."""
    return next((table for table in reversed(scene.boundary) if table.on in (name, "all")), None)


def face_velocity(scene: Scene, face: int, table: BoundaryTable) -> FaceVelocity:
    """The velocity prescribed on a face.

    Parameters
    ----------
    scene : Scene
        The scene, for its box.
    face : int
        Number of the face.
    table : BoundaryTable
        A table of type ``velocity``.

    Returns
    -------
    FaceVelocity
        A function of time and points.
    """
    peak, lower, upper = (np.array(v) for v in (table.velocity, scene.domain.lower, scene.domain.upper))
    return FaceVelocity(peak, lower, upper, face // 2, table.profile == "parabolic")


def conditions(scene: Scene) -> tuple[BoundaryCondition, ...]:
    """The boundary condition of each face, in the order of surface numbers; normals point into the box."""
    return tuple(_condition(scene, face, name) for face, name in enumerate(faces(scene.dimension)))


def _condition(scene: Scene, face: int, name: str) -> BoundaryCondition:
    surface, normal = len(scene.body) + face, inward_normal(face, scene.dimension)
    table = face_table(scene, name)
    if table is None or table.type == "wall":
        return BoundaryCondition(surface, name, "wall", normal)
    if table.type == "velocity":
        return BoundaryCondition(surface, name, "velocity", normal, face_velocity(scene, face, table))
    if table.type == "pressure" and table.pressure is not None:
        return BoundaryCondition(surface, name, "pressure", normal, FacePressure(table.pressure))
    return BoundaryCondition(surface, name, "slip", normal)


def face_planes(scene: Scene) -> tuple[Wall, ...]:
    """Every face of the box as a plane, whether it repels or not, in the order of surface numbers."""
    corners = np.array([scene.domain.lower, scene.domain.upper], dtype=float)
    return tuple(
        Wall(len(scene.body) + face, name, corners[face % 2], inward_normal(face, scene.dimension))
        for face, name in enumerate(faces(scene.dimension))
    )
