"""Velocities and pressures on the boundary that an agent scales."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from rigidfluid.api import (
    BoundaryCondition,
    ConditionMaker,
    FloatArray,
    Model,
    NoSlip,
    PrescribedPressure,
    PrescribedVelocity,
    SceneError,
)
from rigidfluid_gymnasium.actions import Action
from rigidfluid_gymnasium.course import Course


@dataclass(frozen=True)
class BoundaryFactor(Action):
    """Factor on the velocity or pressure that the scene prescribes on a surface, that it reaches by the next action; 1
    at the start [1]."""

    start: ClassVar[float] = 1.0

    def length(self, dimension: int) -> int:
        return 1

    def followed_by(self, model: Model, course: Course) -> Model:
        """The model with the values scaled; raises SceneError where none are prescribed, or a factor at the bounds lets
        more fluid in than out."""
        for limit in self.limits(model.dimension):
            self._scaled(model, Course(limit))
        return self._scaled(model, course)

    def _scaled(self, model: Model, course: Course) -> Model:
        surface = self._surface(model)
        maker = partial(_scaled_condition, make=model.boundary.get(surface, NoSlip), course=course)
        return replace(model, boundary={**model.boundary, surface: maker})

    def _surface(self, model: Model) -> str:
        """Name of the surface in the model; raises SceneError where there is none."""
        for piece in model.domain.pieces:
            if self.name in piece.all_names:
                return piece.name
        allowed = f"a surface of the domain: {model.domain.names_in_words}"
        raise SceneError("boundary", repr(self.name), allowed, "Name another.")


@dataclass(frozen=True)
class _Scaled:
    """A ``value(time, points)`` times the present factor of a ``course``."""

    value: Callable[[float, FloatArray], FloatArray]
    course: Course

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        return np.asarray(self.course.value(time)[0] * self.value(time, points))


def _scaled_condition(
    surface: int, name: str, normal: FloatArray | None, *, make: ConditionMaker, course: Course
) -> BoundaryCondition:
    condition = make(surface, name, normal)
    if isinstance(condition, PrescribedVelocity | PrescribedPressure):
        return replace(condition, value=_Scaled(condition.value, course))
    found = f"{condition.type!r} on {name!r}"
    raise SceneError(condition.field, found, "'velocity' or 'pressure', to be scaled", "Name another surface.")
