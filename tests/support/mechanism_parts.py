"""Mechanisms to be installed as a plug-in: rigid ones of two bodies, and two that change their shape."""

import numpy as np
from pydantic import Field

from rigidfluid.api import (
    Component,
    Ellipsoid,
    EllipsoidOptions,
    Mechanism,
    PartOptions,
    Pose,
    Sphere,
    SphereOptions,
    hookimpl,
)


class PairOptions(PartOptions):
    """Of all that are here; ``ratio``: density of the right one over that of the left one."""

    radius: float = Field(gt=0)
    length: float = Field(gt=0)
    density: float = Field(gt=0)
    ratio: float = Field(default=1.0, gt=0)
    stroke: float = 0.0


class Dumbbell(Mechanism):
    """Two balls on the first axis."""

    name = "dumbbell"
    Options = PairOptions

    @property
    def components(self):
        shapes = zip(("left", "right"), self.shapes(), (1.0, self.options.ratio), strict=True)
        return [Component(name, shape, ratio * self.options.density) for name, shape, ratio in shapes]

    def shapes(self):
        ball = Sphere(SphereOptions(radius=self.options.radius), self.dimension)
        return ball, ball

    def placement(self, time):
        position = np.zeros((2, self.dimension))
        position[1, 0] = self.length(time)
        return Pose(position, self.turned(0.0))

    def length(self, time):
        return self.options.length

    def turned(self, angle):
        """Neither, and the right one by an angle about the last axis."""
        if self.dimension == 2:
            return np.array([[0.0], [angle]])
        return np.array([[1.0, 0.0, 0.0, 0.0], [np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)]])


class Hammer(Dumbbell):
    """A ball, and an ellipse or ellipsoid that stands across."""

    name = "hammer"

    def shapes(self):
        axes = [0.8 * self.options.radius, 1.6 * self.options.radius, self.options.radius][: self.dimension]
        return super().shapes()[0], Ellipsoid(EllipsoidOptions(semi_axes=axes), self.dimension)

    def turned(self, angle):
        return super().turned(angle + 0.4)


class Ellipse(Hammer):
    """The head of the hammer alone."""

    name = "lone"

    @property
    def components(self):
        return super().components[1:]

    def placement(self, time):
        pose = super().placement(time)
        return Pose(pose.position[1:], self.turned(-0.4)[1:])


class Stroke(Hammer):
    """A hammer that is longer and shorter in turn, once in a unit of time, and wags its head."""

    name = "stroke"
    driven = True

    def placement(self, time):
        pose = super().placement(time)
        return Pose(pose.position, self.turned(0.5 * np.sin(2.0 * np.pi * time)))

    def length(self, time):
        return self.options.length + self.options.stroke * np.sin(2.0 * np.pi * time)

    def rate(self, time):
        rate, speed = super().rate(time), 2.0 * np.pi * np.cos(2.0 * np.pi * time)
        rate.velocity[1, 0] = self.options.stroke * speed
        rate.angular_velocity[1, -1] = 0.5 * speed
        return rate


@hookimpl
def rigidfluid_mechanisms():
    return [Dumbbell, Hammer, Ellipse, Stroke]
