"""Joints that leave one coordinate, on which a spring and a damper act, or a drive."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from math import isfinite, remainder
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.along_coordinate import CoordinateDamper, CoordinateSpring, DrivenCoordinate
from rigidfluid.core.joints.constraints import Constraint
from rigidfluid.core.joints.coordinates import Coordinate
from rigidfluid.core.joints.joint import Joint
from rigidfluid.core.joints.markers import MarkerPair
from rigidfluid.core.joints.springs import Spring
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.nested.bodies import check_length
from rigidfluid.core.nested.strokes import build_stroke
from rigidfluid.core.scene.rows_over_time import StrokeTable
from rigidfluid.core.scene.table import Positive
from rigidfluid.core.scene.vectors import Vector
from rigidfluid.errors import SceneError

_ROUNDING = 1e-9


class CoordinateOptions(PartOptions):
    """Keys that all such joints read; each says what their units are."""

    axis: Vector | None = None
    stiffness: Positive | None = None
    damping: Positive | None = None
    drive: StrokeTable | None = None


class OneCoordinate(Joint):
    """A joint of one ``coordinate``, that a spring pulls to the value of the option ``rest_key``."""

    coordinate: Coordinate
    rest_key: ClassVar[str]
    options: CoordinateOptions
    _axes: FloatArray

    def __init__(self, options: CoordinateOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self._refuse_contradictions()
        self.drive = None if options.drive is None else build_stroke(options.drive, "joint.drive")

    @property
    def axes(self) -> FloatArray:
        return self._axes

    @abstractmethod
    def held(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        """Constraints apart from those on the coordinate."""

    def constraints(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        """Held directions, and its drive or damper; raises SceneError if the drive does not start at zero."""
        parts, damping = list(self.held(name, markers)), self.options.damping
        if self.drive is not None:
            self._refuse_offset(name, self.drive.value(0.0))
            parts.append(DrivenCoordinate(name, markers, self.coordinate, self.drive))
        if damping is not None:
            parts.append(CoordinateDamper(name, markers, self.coordinate, damping))
        return parts

    def springs(self, markers: MarkerPair) -> Sequence[Spring]:
        """One along the coordinate, or none."""
        stiffness, rest = self.options.stiffness, getattr(self.options, self.rest_key)
        return [] if stiffness is None else [CoordinateSpring(markers, self.coordinate, stiffness, rest or 0.0)]

    def _refuse_contradictions(self) -> None:
        if getattr(self.options, self.rest_key) is not None and self.options.stiffness is None:
            statement = f"a {self.name} has a {self.rest_key.replace('_', ' ')} only if it has a stiffness"
            raise SceneError(f"joint.{self.rest_key}", statement, None, "Add `stiffness`, or remove it.")
        for key in ("stiffness", "damping"):
            if self.options.drive is not None and getattr(self.options, key) is not None:
                statement = f"a {self.name} whose {self.coordinate.name} is driven does not feel a `{key}`"
                raise SceneError("joint.drive", statement, None, f"Remove `drive` or `{key}`.")

    def _refuse_offset(self, name: str, start: float) -> None:
        """An angle may be rounded when a file gives it in degrees; lengths have no scale of their own."""
        rounding = _ROUNDING if isfinite(self.coordinate.period) else 0.0
        if abs(remainder(start, self.coordinate.period)) > rounding:
            found = f"a drive that starts at the {self.coordinate.name} {start:g}"
            allowed = "0, since the bodies are placed at the start"
            raise SceneError(name, found, allowed, "Let the drive start at 0, or place the body there.")


def unit_axis(axis: Vector | None, kind: str, dimension: int) -> FloatArray:
    """Unit vector (d,) along the ``axis`` of a joint of that ``kind``; raises SceneError without one."""
    if axis is None:
        raise SceneError(
            "joint.axis", "nothing", f"the direction of a {kind}'s axis in {dimension}D", "Add the key 'axis'."
        )
    check_length(axis, "joint.axis", dimension)
    if not any(axis):
        raise SceneError("joint.axis", list(axis), "a vector of length above 0", "Give its direction.")
    return np.asarray(np.array(axis) / np.linalg.norm(axis))
