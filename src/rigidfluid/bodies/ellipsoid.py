"""An ellipse in 2D, an ellipsoid in 3D, its axes along those of its own frame."""

from __future__ import annotations

from math import pi, prod
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.bodies.ellipsoid_distance import closest_point
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.geometry.unit_sphere import unit_sphere_points
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import PartOptions
from rigidfluid.errors import SceneError


class EllipsoidOptions(PartOptions):
    """Keys of a ``[[body]]`` table of type ``ellipsoid``: ``semi_axes``, as many as there are dimensions [length]."""

    semi_axes: tuple[Annotated[float, Field(gt=0)], ...] = Field(
        min_length=2,
        max_length=3,
        description="Half the lengths of the axes, along x, y[, z] of the body's frame [length]",
    )


class Ellipsoid(Body):
    """An ellipsoid Σ (x_i/a_i)² = 1, volume πab or 4πabc/3, unit_inertia (a² + b²)/4 or diag(b² + c², …)/5.

    Parameters
    ----------
    options : EllipsoidOptions
        ``semi_axes`` (half the full axes) [length].
    dimension : int
        2 or 3.

    Raises
    ------
    SceneError
        If there are not as many semi-axes as dimensions.
    """

    name: ClassVar[str] = "ellipsoid"
    also_called: ClassVar[tuple[str, ...]] = ("ellipse", "oval", "spheroid")
    Options: ClassVar[type[PartOptions]] = EllipsoidOptions
    options: EllipsoidOptions

    def __init__(self, options: EllipsoidOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        if len(options.semi_axes) != dimension:
            raise SceneError(
                "body.semi_axes",
                options.semi_axes,
                f"a list of {dimension} lengths",
                "Give half of each full axis, one per dimension.",
            )
        self._semi_axes = np.array(options.semi_axes)

    @property
    def semi_axes(self) -> FloatArray:
        """Half of each full axis (d,) [length]."""
        return self._semi_axes

    @property
    def volume(self) -> float:
        """πab or 4πabc/3 [length^d]."""
        return (pi if self.dimension == 2 else 4 / 3 * pi) * prod(self.options.semi_axes)

    @property
    def unit_inertia(self) -> FloatArray:
        """(a² + b²)/4 (1, 1) in 2D, diag(b² + c², c² + a², a² + b²)/5 (3, 3) in 3D [length²]."""
        squares = self.semi_axes**2
        if self.dimension == 2:
            return np.full((1, 1), squares.sum() / 4)
        return np.diag(squares.sum() - squares) / 5

    @property
    def bounding_radius(self) -> float:
        """The longest semi-axis [length]."""
        return max(self.options.semi_axes)

    @property
    def radius(self) -> float | None:
        """The semi-axis if all are equal, else None [length]."""
        return self.bounding_radius if len(set(self.options.semi_axes)) == 1 else None

    def closest_point(self, points: FloatArray) -> FloatArray:
        """Nearest points of the surface (N, d) for ``points`` (N, d) [length]."""
        return closest_point(points, self.semi_axes)

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """(x - x_s)·n (N,), x_s the closest point and n the outward normal there, for ``points`` x (N, d) [length]."""
        foot = self.closest_point(points)
        gradient = foot / self.semi_axes**2
        along = np.sum((points - foot) * gradient, axis=1)
        return np.asarray(along / np.linalg.norm(gradient, axis=1))

    def sample_surface(self, count: int) -> FloatArray:
        """``count`` points (count, d), the stretched image of evenly spread ones on a ball [length]."""
        return self.semi_axes * unit_sphere_points(count, self.dimension)

    def cad_shape(self, unit: float) -> Any:
        """An ellipse in the plane z = 0 (2D) or an ellipsoid (3D), as ``netgen.occ`` shapes with lengths over
        ``unit``."""
        from netgen import occ

        origin, semi_axes = occ.Pnt(0, 0, 0), in_unit(self.semi_axes, unit).tolist()
        if self.dimension == 3:
            return occ.Ellipsoid(occ.Axes(origin, occ.X, occ.Y), *semi_axes)
        # Open CASCADE wants the major axis first (and crashes otherwise)
        minor, major = sorted(semi_axes)
        along = occ.X if semi_axes[0] == major else occ.Y
        return occ.WorkPlane(occ.Axes(origin, occ.Z, along)).Ellipse(major, minor).Face()
