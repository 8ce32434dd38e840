"""A piece of the domain's boundary that bodies may meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.surface import Plane, Surface
from rigidfluid.errors import SceneError


class WallVelocities(Protocol):
    """Motion of walls that slide in themselves, by surface number."""

    def __call__(self, surfaces: IntArray, points: FloatArray) -> FloatArray:
        """Velocity (m, d) of ``surfaces`` (m,) at ``points`` (m, d) of theirs [length/time]."""
        ...

    def angular_velocity(self, surfaces: IntArray, points: FloatArray) -> FloatArray:
        """Angular velocity (m, k) of ``surfaces`` (m,) at ``points`` (m, d) of theirs [rad/time]."""
        ...


@dataclass(frozen=True, slots=True)
class Wall:
    """A wall that repels: its ``surface`` number, its name, the ``shape`` of its surface, and the ``velocity`` at
    which it slides in itself, (N, d) at points (N, d), None at rest [length/time]."""

    surface: int
    name: str
    shape: Surface
    velocity: Callable[[FloatArray], FloatArray] | None = None


def radius_of(shape: Surface) -> float:
    """The radius of curvature of a shape, NaN where it is not known, as contacts have it [length]."""
    return np.nan if shape.radius is None else shape.radius


def wall_radii(walls: Sequence[Wall], surfaces: IntArray) -> FloatArray:
    """The radius of curvature of the wall of each number in ``surfaces`` (m,), NaN where it is not known, (m,)
    [length]."""
    known = {wall.surface: radius_of(wall.shape) for wall in walls}
    return np.array([known[surface] for surface in surfaces.tolist()], dtype=float)


def centre_of(shape: Surface) -> FloatArray:
    """The centre (d,) of a round surface or a part of one, from points of it: |x|² = 2c·x + const. [length]"""
    lower, upper = shape.bounds
    middle = 0.5 * (lower + upper)
    steps = np.stack(np.meshgrid(*[[-0.5, 0.0, 0.5]] * len(middle)), axis=-1).reshape(-1, len(middle))
    steps = steps[np.any(steps != 0.0, axis=1)]  # no point is nearest to the centre
    points = shape.closest_point(middle + steps * (upper - lower)) - middle
    system = np.column_stack([2.0 * points, np.ones(len(points))])
    return np.asarray(middle + np.linalg.lstsq(system, np.sum(points**2, axis=1))[0][:-1])


def is_round(shape: Surface) -> bool:
    """Tell whether it is a ball's surface, seen from outside or inside, or a part of one."""
    return shape.plane is None and shape.radius is not None and bool(np.isfinite(shape.radius))


def require_plane(wall: Wall, detector: str) -> Plane:
    """The plane of a wall, for a detector that knows no other shapes.

    Parameters
    ----------
    wall : Wall
        Any wall.
    detector : str
        Name of the detector, for the message.

    Returns
    -------
    Plane
        Its plane.

    Raises
    ------
    SceneError
        If the wall is not flat.
    """
    if wall.shape.plane is not None:
        return wall.shape.plane
    raise SceneError(
        "contact.detector",
        f'"{detector}" with the wall {wall.name!r}, which is not flat',
        "flat walls only",
        'Use detector = "auto", which takes one for this wall.',
    )
