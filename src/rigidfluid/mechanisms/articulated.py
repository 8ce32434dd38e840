"""Bodies of any shape that move relatively to each other as strokes say, or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.nested.bodies import check_length
from rigidfluid.core.nested.placing import initial_pose
from rigidfluid.core.nested.strokes import build_stroke
from rigidfluid.core.scene.rows_over_time import StrokeTable
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.scene.vectors import Vector
from rigidfluid.errors import SceneError
from rigidfluid.mechanisms.components import ComponentTable, build_components
from rigidfluid.mechanisms.strokes import (
    MovingComponents,
    RigidDisplacement,
    Rotation,
    StrokedMechanism,
    Translation,
)

_AT = "mechanism"


class RelativeStrokeTable(StrokeTable):
    """Moves some components in the frame of their mechanism, by a length or an angle over time."""

    moves: Annotated[tuple[str, ...], Field(min_length=1)] = Field(description="Names of the components that it moves")
    along: Vector | None = Field(
        default=None, description="Direction of a translation, of any length; values are lengths"
    )
    about: Vector | None = Field(default=None, description="Point that the components turn about [length]")
    axis: Vector | None = Field(
        default=None, description="Axis that they turn about, in 3D; values are angles in radians"
    )


class ArticulatedOptions(PartOptions):
    """Keys of a ``[[mechanism]]`` table with type ``articulated``: its components, and the strokes that move them; it
    is rigid without strokes."""

    component: tuple[ComponentTable, ...] = Field(description="`name`, and the keys of a body")
    stroke: tuple[RelativeStrokeTable, ...] = Field(
        default=(), description="A later one is carried along by earlier ones that move the same components"
    )


class Articulated(StrokedMechanism):
    """Components that a scene lists, and strokes that translate or rotate some of them.

    No components, two of one name, and impossible shapes or strokes raise SceneError.
    """

    name: ClassVar[str] = "articulated"
    Options: ClassVar[type[PartOptions]] = ArticulatedOptions
    options: ArticulatedOptions

    def __init__(self, options: ArticulatedOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self.parts = build_components(options.component, f"{_AT}.component", dimension)
        self.rest = initial_pose(options.component, dimension)
        names = [part.name for part in self.parts]
        self.strokes = [
            _moving(table, f"{_AT}.stroke.{number}", names, dimension) for number, table in enumerate(options.stroke)
        ]
        self.driven = bool(self.strokes)


def _moving(table: RelativeStrokeTable, at: str, names: Sequence[str], dimension: int) -> MovingComponents:
    for name in table.moves:
        if name not in names:
            remedy = suggestion(name, names) or "Correct it."
            raise SceneError(f"{at}.moves", repr(name), f"components: {', '.join(names)}", remedy)
    moves = np.array([name in table.moves for name in names])
    return MovingComponents(moves, _displacement(table, at, dimension), build_stroke(table, at))


def _displacement(table: RelativeStrokeTable, at: str, dimension: int) -> RigidDisplacement:
    if (table.along is None) == (table.about is None):
        found = "neither along nor about" if table.along is None else "both along and about"
        raise SceneError(at, found, "one of them", "Give a direction to go along, or a point to turn about.")
    if table.about is None and table.axis is not None:
        raise SceneError(f"{at}.axis", list(table.axis), "no axis of a translation", "Leave it out.")
    if table.along is not None:
        return Translation(_unit(table.along, f"{at}.along", dimension))
    return Rotation(np.array(table.about), _axis(table, at, dimension))


def _axis(table: RelativeStrokeTable, at: str, dimension: int) -> FloatArray:
    assert table.about is not None
    check_length(table.about, f"{at}.about", dimension)
    if dimension == 2 and table.axis is not None:
        raise SceneError(f"{at}.axis", list(table.axis), "no axis in 2D", "Leave it out; angles are counter-clockwise.")
    if dimension == 2:
        return np.ones(1)
    if table.axis is None:
        raise SceneError(f"{at}.axis", "none", "three numbers", "Give the axis through the point.")
    return _unit(table.axis, f"{at}.axis", 3)


def _unit(vector: Sequence[float], at: str, dimension: int) -> FloatArray:
    check_length(vector, at, dimension)
    length = float(np.linalg.norm(vector))
    if length == 0.0:
        raise SceneError(at, list(vector), "a vector of length above 0", "Give a direction.")
    return np.array(vector) / length
