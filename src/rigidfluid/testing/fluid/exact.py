"""Flows known in closed form, and the problems that they solve."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rigidfluid.core.fluid.conditions import BoundaryCondition, NoSlip, PrescribedVelocity, Value
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray

DENSITY, VISCOSITY = 1.3, 0.7

FACES = ("x0", "x1", "y0", "y1", "z0", "z1")
"""Names of the unit box's faces: the axis across a face, and its coordinate there."""

Kind = Callable[[int, str, FloatArray], BoundaryCondition]
"""A class of conditions, alone or with values: ``partial(PrescribedVelocity, value=velocity)``."""


def problem(
    dimension: int,
    kinds: Mapping[str, Kind] | None = None,
    bodies: int = 0,
    inertia: bool = True,
    source: Value | None = None,
) -> FluidProblem:
    """A box whose `FACES` are walls but for those with other ``kinds`` of conditions."""
    conditions = tuple(
        (kinds or {}).get(name, NoSlip)(bodies + face, name, inward_normal(face, dimension))
        for face, name in enumerate(FACES[: 2 * dimension])
    )
    return FluidProblem(dimension, bodies, DENSITY, Newtonian(VISCOSITY), inertia, conditions, source)


def enclosed(
    dimension: int, velocity: Value, source: Value | None = None, bodies: int = 0, inertia: bool = True
) -> FluidProblem:
    """Problem in a box with the velocity prescribed on all faces."""
    every = FACES[: 2 * dimension]
    given = partial(PrescribedVelocity, value=velocity)
    return problem(dimension, dict.fromkeys(every, given), bodies, inertia, source)


def inward_normal(face: int, dimension: int) -> FloatArray:
    """Unit normal (d,) of a face of the unit box, by its number, into the box."""
    return np.asarray((1.0 - 2.0 * (face % 2)) * np.eye(dimension)[face // 2])


@dataclass(frozen=True)
class LinearFlow:
    """u = g(t) (A x + b), p = k(t) c · (x - middle of the box), with A without trace: P2–P1 has it exactly.

    The source has no inertia at time 0, so that a steady step from rest, where u* = 0, gives this flow.
    """

    gradient: FloatArray
    drift: FloatArray
    slope: FloatArray
    factor: Callable[[float], float] = lambda time: 1.0
    rate: Callable[[float], float] = lambda time: 0.0
    """The derivative of ``factor``."""
    push: Callable[[float], float] = lambda time: 1.0

    @classmethod
    def steady(cls, dimension: int) -> LinearFlow:
        """One with all its components."""
        gradient = np.array([[0.8, -0.4, 0.3], [0.9, -0.5, 0.6], [-0.8, 0.2, -0.2]])[:dimension, :dimension]
        gradient = gradient - np.trace(gradient) / dimension * np.eye(dimension)
        return cls(gradient, np.array([0.6, -0.3, 0.4])[:dimension], np.array([1.1, -0.7, 0.5])[:dimension])

    @classmethod
    def shear(cls, dimension: int) -> LinearFlow:
        """All along the first axis, and the same all along it: what of it is extrapolated has no divergence either,
        and (v·∇)u = 0 for any such v."""
        along, across = np.array([1.0, 0.0, 0.0])[:dimension], np.array([0.0, 0.9, 0.6])[:dimension]
        return replace(cls.steady(dimension), gradient=np.outer(along, across), drift=0.3 * along)

    def velocity(self, time: float, points: FloatArray) -> FloatArray:
        """u at ``points`` (N, d)."""
        return np.asarray(self.factor(time) * self._shape(points))

    def pressure(self, time: float, points: FloatArray) -> FloatArray:
        """p (N,) at ``points`` (N, d), with zero mean over the box."""
        return np.asarray(self.push(time) * (points - 0.5) @ self.slope)

    def source(self, time: float, points: FloatArray) -> FloatArray:
        """ρ(∂u/∂t + (u·∇)u) + ∇p, (N, d)."""
        shape = self._shape(points)
        slope = np.tile(self.push(time) * self.slope, (len(points), 1))
        if time > 0.0:
            slope += DENSITY * (self.rate(time) * shape + self.factor(time) ** 2 * shape @ self.gradient.T)
        return slope

    def _shape(self, points: FloatArray) -> FloatArray:
        return np.asarray(points @ self.gradient.T + self.drift)


@dataclass(frozen=True)
class Waves:
    """A steady flow of sines in each plane of neighbouring axes, and a drift; the source as in `LinearFlow`."""

    dimension: int

    def velocity(self, time: float, points: FloatArray) -> FloatArray:
        """u at ``points`` (N, d): for each plane i, i + 1 the vortices sᵢ cᵢ₊₁ along i and -cᵢ sᵢ₊₁ along i + 1."""
        return self._vortices(points) + self._drift

    def pressure(self, time: float, points: FloatArray) -> FloatArray:
        """p (N,) at ``points`` (N, d), with zero mean over the box."""
        return np.asarray(np.cos(np.pi * points[:, 0]) * np.sin(2 * np.pi * points[:, 1]))

    def source(self, time: float, points: FloatArray) -> FloatArray:
        """ρ(u·∇)u - μΔu + ∇p, (N, d)."""
        load = 2 * np.pi**2 * VISCOSITY * self._vortices(points)
        load[:, 0] -= np.pi * np.sin(np.pi * points[:, 0]) * np.sin(2 * np.pi * points[:, 1])
        load[:, 1] += 2 * np.pi * np.cos(np.pi * points[:, 0]) * np.cos(2 * np.pi * points[:, 1])
        if time > 0.0:
            load += DENSITY * np.einsum("nij,nj->ni", self._gradient(points), self.velocity(time, points))
        return load

    @property
    def _drift(self) -> FloatArray:
        return np.array([1.0, 0.5, -0.4])[: self.dimension]

    def _vortices(self, points: FloatArray) -> FloatArray:
        s, c = np.sin(np.pi * points), np.cos(np.pi * points)
        u = np.zeros_like(points)
        for i in range(self.dimension - 1):
            u[:, i] += s[:, i] * c[:, i + 1]
            u[:, i + 1] -= c[:, i] * s[:, i + 1]
        return u

    def _gradient(self, points: FloatArray) -> FloatArray:
        """∂uᵢ/∂xⱼ, (N, d, d)."""
        s, c = np.sin(np.pi * points), np.cos(np.pi * points)
        slopes = np.zeros((*points.shape, self.dimension))
        for i in range(self.dimension - 1):
            j = i + 1
            slopes[:, i, i] += np.pi * c[:, i] * c[:, j]
            slopes[:, i, j] -= np.pi * s[:, i] * s[:, j]
            slopes[:, j, i] += np.pi * s[:, i] * s[:, j]
            slopes[:, j, j] -= np.pi * c[:, i] * c[:, j]
        return slopes
