"""The three-sphere swimmer of Najafi and Golestanian."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from rigidfluid.core.mechanics.strokes import Stroke
from rigidfluid.core.model.mechanism import Component
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Pose
from rigidfluid.core.scene.table import Positive
from rigidfluid.errors import SceneError
from rigidfluid.mechanisms.strokes import MovingComponents, StrokedMechanism, Translation
from rigidfluid.registry import BODY, Registry

Phase = Literal["left in", "right in", "left out", "right out"]

_FORWARD: tuple[Phase, ...] = ("left in", "right in", "left out", "right out")


class ThreeSphereSwimmerOptions(PartOptions):
    """Keys of a ``[[mechanism]]`` table with type ``three_sphere_swimmer``: three equal balls in a row along the first
    axis of its frame, ``left``, ``middle`` and ``right``, on two arms that shorten and lengthen in turn."""

    radius: Positive = Field(description="Radius of the balls [length]")
    density: Positive = Field(description="Density of the balls [mass/length^d]")
    arms: Positive | tuple[Positive, Positive] = Field(
        description="Distance between the centres of neighbours with the arms extended; a number, or one for each arm "
        "[length]"
    )
    amplitude: Positive = Field(description="Length by which an arm shortens [length]")
    speed: Positive = Field(description="Rate at which an arm shortens and lengthens [length/time]")
    order: Annotated[tuple[Phase, ...], Field(min_length=4, max_length=4)] = Field(
        default=_FORWARD, description="The four phases of a cycle; reversed, it swims back"
    )


class ThreeSphereSwimmer(StrokedMechanism):
    """Balls at -L₁ + s₁(t), 0 and L₂ - s₂(t) on the first axis; in each phase one s goes at constant speed from 0
    to the amplitude or back, so that a cycle takes 4 amplitude/speed.

    A phase that comes twice, and balls that would touch, raise SceneError.

    References
    ----------
    A. Najafi, R. Golestanian, Simple swimmer at low Reynolds number: three linked spheres, Phys. Rev. E 69, 062901
    (2004).
    """

    name: ClassVar[str] = "three_sphere_swimmer"
    Options: ClassVar[type[PartOptions]] = ThreeSphereSwimmerOptions
    driven = True
    options: ThreeSphereSwimmerOptions

    def __init__(self, options: ThreeSphereSwimmerOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        if set(options.order) != set(_FORWARD):
            allowed = f"each of {', '.join(_FORWARD)} once"
            raise SceneError("mechanism.order", list(options.order), allowed, "Correct it.")
        left, right = options.arms if isinstance(options.arms, tuple) else (options.arms, options.arms)
        if min(left, right) - options.amplitude <= 2.0 * options.radius:
            raise SceneError(
                "mechanism.amplitude",
                f"{options.amplitude:g}, at which arms of {left:g} and {right:g} make balls overlap",
                f"less than {min(left, right) - 2.0 * options.radius:g}",
                "Shorten the stroke, or lengthen the arms.",
            )
        ball = Registry.load().get(BODY, "sphere")
        shape = ball(ball.Options.model_validate({"radius": options.radius}), dimension)
        self.parts = [Component(name, shape, options.density) for name in ("left", "middle", "right")]
        self.rest = _row_pose((-left, 0.0, right), dimension)
        axis = np.eye(dimension)[0]
        self.strokes = [
            MovingComponents(np.array([True, False, False]), Translation(axis), self._stroke("left")),
            MovingComponents(np.array([False, False, True]), Translation(-axis), self._stroke("right")),
        ]

    def _stroke(self, arm: str) -> Stroke:
        """Shortening of this arm over time [length]: at first the whole, if it lengthens before it shortens."""
        order: Sequence[str] = self.options.order
        goes_in, goes_out = order.index(f"{arm} in"), order.index(f"{arm} out")
        amplitude = self.options.amplitude
        phase, values = amplitude / self.options.speed, [amplitude if goes_out < goes_in else 0.0]
        for number in range(4):
            values.append(amplitude if number == goes_in else 0.0 if number == goes_out else values[-1])
        return Stroke([(number * phase, value) for number, value in enumerate(values)], period=4.0 * phase)


def _row_pose(places: Sequence[float], dimension: int) -> Pose:
    position = np.zeros((len(places), dimension))
    position[:, 0] = places
    orientation = np.zeros((1, 1)) if dimension == 2 else np.eye(1, 4)
    return Pose(position, np.tile(orientation, (len(places), 1)))
