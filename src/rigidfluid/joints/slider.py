"""A body that slides along an axis of another one, without turning."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from pydantic import Field

from rigidfluid.core.joints.constraints import Constraint, OnAxis, SameOrientation
from rigidfluid.core.joints.coordinates import Coordinate, Displacement
from rigidfluid.core.joints.markers import MarkerPair, axes_along
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.rows_over_time import StrokeTable
from rigidfluid.core.scene.table import Positive
from rigidfluid.core.scene.vectors import Vector
from rigidfluid.joints.one_coordinate import CoordinateOptions, OneCoordinate, unit_axis


class SliderOptions(CoordinateOptions):
    """Keys of a ``[[joint]]`` table with type ``slider``: the first body moves along an axis of the second, without
    relative rotation."""

    axis: Vector | None = Field(
        default=None,
        description="Direction of the axis at the start, which a slider needs; it turns with the second body [1]",
    )
    stiffness: Positive | None = Field(default=None, description="Of a spring; none if not given [force/length]")
    rest_length: float | None = Field(
        default=None,
        description="Rest length of the spring: the displacement of the first body relative to the second along the "
        "axis; 0, that at the start, if not given [length]",
    )
    damping: Positive | None = Field(default=None, description="Of a damper; none if not given [force·time/length]")
    drive: StrokeTable | None = Field(
        default=None, description="The displacement of a driven slider as a function of time, 0 at the start"
    )


class Slider(OneCoordinate):
    """The first point stays on the axis, which the second body carries, and the orientations stay the same."""

    name: ClassVar[str] = "slider"
    Options: ClassVar[type[PartOptions]] = SliderOptions
    coordinate: Coordinate = Displacement()
    rest_key: ClassVar[str] = "rest_length"
    options: SliderOptions

    def __init__(self, options: SliderOptions, dimension: int) -> None:
        self._axes = axes_along(unit_axis(options.axis, self.name, dimension))
        super().__init__(options, dimension)

    def held(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        """The same axis and orientation."""
        return [OnAxis(name, markers), SameOrientation(name, markers)]
