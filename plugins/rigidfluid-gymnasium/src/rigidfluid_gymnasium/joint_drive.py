"""Joints that an agent drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from rigidfluid.api import (
    Constraint,
    DrivenCoordinate,
    FloatArray,
    Joint,
    MarkerPair,
    Model,
    SceneError,
    Spring,
)
from rigidfluid_gymnasium.actions import Action
from rigidfluid_gymnasium.course import Course, CourseDrive


@dataclass(frozen=True)
class JointDrive(Action):
    """Coordinate of a joint, that it reaches by the next action: the angle of a hinge, the displacement of a slider, 0
    at the start [rad | length]."""

    fewest_steps: ClassVar[int] = 4

    def length(self, dimension: int) -> int:
        return 1

    def followed_by(self, model: Model, course: Course) -> Model:
        """The model with the joint driven; raises SceneError where there is none to be driven."""
        names = [joint.name for joint in model.joints]
        if self.name not in names:
            allowed = f"a joint of the scene: {', '.join(names) or 'it has none'}"
            raise SceneError("joint", repr(self.name), allowed, "Name another.")
        drive, at = CourseDrive(course), names.index(self.name)
        driven = replace(model.joints[at], kind=_DrivenJoint(model.joints[at].kind, self.name, drive))
        return replace(model, joints=(*model.joints[:at], driven, *model.joints[at + 1 :]))


class _DrivenJoint(Joint):
    """A joint that leaves one coordinate, and a drive of that."""

    name: ClassVar[str] = "driven joint"

    def __init__(self, kind: Joint, name: str, drive: CourseDrive) -> None:
        if kind.coordinate is None or kind.drive is not None:
            found = "one without a coordinate" if kind.coordinate is None else "one with a drive of its own"
            raise SceneError(f"joint {name!r}", found, "a hinge or slider without a drive", "Name another.")
        super().__init__(kind.options, kind.dimension)
        self._kind, self.coordinate, self.drive = kind, kind.coordinate, drive

    @property
    def axes(self) -> FloatArray:
        return self._kind.axes

    def constraints(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        assert self.coordinate is not None
        assert self.drive is not None
        return [*self._kind.constraints(name, markers), DrivenCoordinate(name, markers, self.coordinate, self.drive)]

    def springs(self, markers: MarkerPair) -> Sequence[Spring]:
        return self._kind.springs(markers)
