"""A ball: a disk in 2D, a sphere in 3D."""

from __future__ import annotations

from math import pi
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.geometry.unit_sphere import unit_sphere_points
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import PartOptions


class SphereOptions(PartOptions):
    """Keys of a ``[[body]]`` table of type ``sphere``: ``radius`` [length]."""

    radius: float = Field(gt=0, description="Radius of the ball [length]")


class Sphere(Body):
    """A ball of radius a: |x| = a, volume πa² or 4πa³/3, unit_inertia a²/2 or (2/5)a² I.

    Parameters
    ----------
    options : SphereOptions
        ``radius`` [length].
    dimension : int
        2 or 3.
    """

    name: ClassVar[str] = "sphere"
    also_called: ClassVar[tuple[str, ...]] = ("ball", "circle", "cylinder", "disc", "disk")
    Options: ClassVar[type[PartOptions]] = SphereOptions
    options: SphereOptions

    @property
    def radius(self) -> float:
        """The radius [length]."""
        return self.options.radius

    @property
    def volume(self) -> float:
        """πa² or 4πa³/3 [length^d]."""
        return pi * self.radius**2 if self.dimension == 2 else 4 / 3 * pi * self.radius**3

    @property
    def unit_inertia(self) -> FloatArray:
        """a²/2 (1, 1) in 2D, (2/5)a² I (3, 3) in 3D [length²]."""
        return self.radius**2 * (np.full((1, 1), 0.5) if self.dimension == 2 else 0.4 * np.eye(3))

    @property
    def bounding_radius(self) -> float:
        """The radius [length]."""
        return self.radius

    def closest_point(self, points: FloatArray) -> FloatArray:
        """a x/|x| (N, d) for ``points`` x (N, d); for the centre itself a point on the first axis [length]."""
        distance = np.linalg.norm(points, axis=1, keepdims=True)
        at_centre = distance == 0
        first_axis = np.eye(1, self.dimension)
        return self.radius * np.where(at_centre, first_axis, points / np.where(at_centre, 1.0, distance))

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """|x| - a (N,) for ``points`` x (N, d) [length]."""
        return np.asarray(np.linalg.norm(points, axis=1) - self.radius)

    def sample_surface(self, count: int) -> FloatArray:
        """``count`` evenly spread points of the surface (count, d) [length]."""
        return self.radius * unit_sphere_points(count, self.dimension)

    def cad_shape(self, unit: float) -> Any:
        """A disk in the plane z = 0 (2D) or a ball (3D), as ``netgen.occ`` shapes with lengths over ``unit``."""
        from netgen import occ

        radius = float(in_unit(self.radius, unit))
        return occ.WorkPlane().Circle(radius).Face() if self.dimension == 2 else occ.Sphere(occ.Pnt(0, 0, 0), radius)
