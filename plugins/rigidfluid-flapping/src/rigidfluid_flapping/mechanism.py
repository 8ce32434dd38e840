"""A hub that flaps one or two plates."""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, cos, pi, sin
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from rigidfluid.api import Component, FloatArray, Mechanism, PartOptions, Pose, Sphere, SphereOptions, Twist
from rigidfluid_flapping.plate import Plate, PlateOptions


class FlappingPlateOptions(PlateOptions):
    """Keys of a `[[mechanism]]` table of type `flapping_plate`; length, thickness and width are of each plate."""

    hub_radius: float = Field(gt=0, description="Radius of the hub [length]")
    gap: float = Field(gt=0, description="Between the hub and each plate [length]")
    density: float = Field(gt=0, description="Of hub and plates [mass/length^d]")
    plates: Literal[1, 2] = Field(default=1, description="One behind the hub, or two that mirror each other [1]")
    rest_angle: float = Field(
        default=0.0, ge=0, description="Middle of the flapping, from the axis behind the hub; 0 of one plate [rad]"
    )
    amplitude: float = Field(gt=0, le=pi, description="Of the flapping angle [rad]")
    frequency: float = Field(gt=0, description="Of the flapping [1/time]")

    @model_validator(mode="after")
    def _plates_are_apart(self) -> FlappingPlateOptions:
        """Two plates must not meet on the axis between them, ahead of the hub or behind it."""
        if self.plates == 1:
            if self.rest_angle:
                raise ValueError(
                    f"rest_angle = {self.rest_angle:g} must be 0 with one plate: turn the whole by its angle"
                )
            return self
        least = asin(0.5 * self.thickness / (self.hub_radius + self.gap + 0.5 * self.thickness))
        lowest, highest = self.rest_angle - self.amplitude, self.rest_angle + self.amplitude
        if lowest <= least or highest >= pi - least:
            raise ValueError(
                f"rest_angle ± amplitude goes from {lowest:g} to {highest:g}, and two plates touch each other unless "
                f"it stays between {least:g} and {pi - least:g}: change rest_angle or amplitude"
            )
        return self


class FlappingPlate(Mechanism):
    """A ball with plates that turn about its centre by θ(t) = rest_angle + amplitude · cos(2π · frequency · t).

    In its own frame the hub is in the origin, and the plates lie towards the negative first axis, turned from there by
    θ, the second one by -θ; in 3D they turn about the third axis, which their width is along. It starts without speed.

    Parameters
    ----------
    options : FlappingPlateOptions
        Sizes [length], density [mass/length^d], and the flapping.
    dimension : int
        2 or 3.
    """

    name: ClassVar[str] = "flapping_plate"
    Options: ClassVar[type[PartOptions]] = FlappingPlateOptions
    driven = True
    options: FlappingPlateOptions

    @property
    def components(self) -> Sequence[Component]:
        """The hub and one or two plates."""
        given = self.options
        hub = Sphere(SphereOptions(radius=given.hub_radius), self.dimension)
        plate = Plate(
            PlateOptions(length=given.length, thickness=given.thickness, width=given.width), dimension=self.dimension
        )
        names = ("plate",) if given.plates == 1 else ("left", "right")
        return [Component("hub", hub, given.density), *(Component(name, plate, given.density) for name in names)]

    def placement(self, time: float) -> Pose:
        """The hub in the origin, plates ahead of and behind it by θ [length; rad | 1]."""
        turns = self._ways * self._angle(time)[0]
        position = -self._arm * self._along(np.cos(turns), np.sin(turns))
        position[0] = 0.0
        if self.dimension == 2:
            return Pose(position, turns[:, None])
        zero = np.zeros_like(turns)
        return Pose(position, np.stack([np.cos(0.5 * turns), zero, zero, np.sin(0.5 * turns)], axis=1))

    def rate(self, time: float) -> Twist:
        """Its derivative [length/time, rad/time]."""
        angle, speed = self._angle(time)
        turns, spins = self._ways * angle, self._ways * speed
        velocity = -self._arm * spins[:, None] * self._along(-np.sin(turns), np.cos(turns))
        velocity[0] = 0.0
        zero = np.zeros_like(spins)
        return Twist(velocity, np.stack([spins] if self.dimension == 2 else [zero, zero, spins], axis=1))

    @property
    def _ways(self) -> FloatArray:
        """How hub and plates turn with the angle."""
        return np.array([0.0, 1.0, -1.0])[: 1 + self.options.plates]

    @property
    def _arm(self) -> float:
        """From the hub's centre to that of a plate."""
        return self.options.hub_radius + self.options.gap + 0.5 * self.options.length

    def _angle(self, time: float) -> tuple[float, float]:
        """θ and its rate."""
        speed = 2.0 * pi * self.options.frequency
        angle = self.options.rest_angle + self.options.amplitude * cos(speed * time)
        return angle, -self.options.amplitude * speed * sin(speed * time)

    def _along(self, first: FloatArray, second: FloatArray) -> FloatArray:
        """Vectors (m, d) of two components (m,) in the plane of the flapping."""
        return np.stack([first, second, np.zeros_like(first)][: self.dimension], axis=1)
