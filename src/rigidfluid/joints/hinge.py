"""Two bodies that turn about a point, in 3D about an axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.joints.constraints import Constraint, SameAxis, SamePoint
from rigidfluid.core.joints.coordinates import Angle, Coordinate
from rigidfluid.core.joints.markers import MarkerPair, axes_along
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.rows_over_time import StrokeTable
from rigidfluid.core.scene.table import Positive
from rigidfluid.core.scene.vectors import Vector
from rigidfluid.errors import SceneError
from rigidfluid.joints.one_coordinate import CoordinateOptions, OneCoordinate, unit_axis


class HingeOptions(CoordinateOptions):
    """Keys of a ``[[joint]]`` table with type ``hinge``: the bodies turn about a point, in 3D about an axis."""

    axis: Vector | None = Field(default=None, description="Direction of the axis at the start; 3D only [1]")
    stiffness: Positive | None = Field(default=None, description="Of a spring; none if not given [force·length/rad]")
    rest_angle: float | None = Field(
        default=None,
        description="Rest angle of the spring: that of the first body relative to the second, counter-clockwise about "
        "the axis; 0, the angle at the start, if not given [rad]",
    )
    damping: Positive | None = Field(default=None, description="Of a damper; none if not given [force·length·time/rad]")
    drive: StrokeTable | None = Field(
        default=None, description="The angle of a driven hinge as a function of time, 0 at the start"
    )


class Hinge(OneCoordinate):
    """The points stay together, and in 3D the axes parallel."""

    name: ClassVar[str] = "hinge"
    Options: ClassVar[type[PartOptions]] = HingeOptions
    needs_point: ClassVar[bool] = True
    coordinate: Coordinate = Angle()
    rest_key: ClassVar[str] = "rest_angle"
    options: HingeOptions

    def __init__(self, options: HingeOptions, dimension: int) -> None:
        if dimension == 2 and options.axis is not None:
            raise SceneError("joint.axis", list(options.axis), "none in 2D, where all axes are one", "Remove it.")
        self._axes = np.eye(2) if dimension == 2 else axes_along(unit_axis(options.axis, self.name, 3))
        super().__init__(options, dimension)

    def held(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        """The same point, and in 3D the same axis."""
        parts: list[Constraint] = [SamePoint(name, markers, np.eye(self.dimension))]
        return parts if self.dimension == 2 else [*parts, SameAxis(name, markers)]
