"""Momentum of fluid and bodies between seams alone, where nothing outside takes any.

Convection by u* - w that makes no energy gains momentum at the rate ½ρ∫(∇·u*)(u - V), since ∇·u* = 0 meant for discrete
pressures alone; moving and new meshes change it as well. One velocity of all takes the gain back.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import FluidState, Mesh, Step
from rigidfluid.taylor_hood.system.coupled import Solution
from rigidfluid.taylor_hood.system.discretisation import Discretisation

NAMES = ("momentum", "momentum_previous")
"""The state's arrays: momentum (d,) of the fluid alone at both times [mass·length/time]."""


class Moving(NamedTuple):
    """Fluid and motions in a ``step``, on a mesh of the geometry ``points`` (N + K, d) [length]."""

    discretisation: Discretisation
    step: Step
    points: FloatArray

    @property
    def free(self) -> bool:
        """Tell whether nothing holds one more velocity of all."""
        step, d = self.step, self.points.shape[1]
        linked = step.links.rows[:, :, :d].sum(axis=1)
        return self.discretisation.problem.keeps_momentum and not step.prescribed.any() and not linked.any()

    def mean_velocity(self, velocity: FloatArray, twist: FloatArray) -> FloatArray:
        """Velocity (d,) of the centre of mass, of a ``velocity`` (nodes, d) and the motions' ``twist`` (N, d+k)."""
        return np.asarray(self._inertia(velocity, twist) / self._mass(velocity, twist))

    def with_gain(self, solution: Solution, load: FloatArray) -> Solution:
        """A ``solution`` of the step whose momentum is what the ``load`` (d,) on the fluid and that on the motions have
        given: all move by one velocity more."""
        d = self.points.shape[1]
        gained = load + self.step.load[:, :d].sum(axis=0) - self._inertia(solution.velocity, solution.twist)
        shift = gained / self._mass(solution.velocity, solution.twist)
        along = np.concatenate([shift, np.zeros(solution.twist.shape[1] - d)])
        return replace(solution, velocity=solution.velocity + shift, twist=solution.twist + along)

    def _inertia(self, velocity: FloatArray, twist: FloatArray) -> FloatArray:
        """Momentum (d,) times the weight d₀ of the end of the step."""
        of_motions = np.einsum("nij,nj->i", self.step.mass_matrix, twist)[: len(self.points[0])]
        return np.asarray(self.step.derivative[0] * momentum(self.discretisation, self.points, velocity) + of_motions)

    def _mass(self, velocity: FloatArray, twist: FloatArray) -> FloatArray:
        """The same (d,) of a unit velocity of all along each axis."""
        translation = np.broadcast_to(np.arange(twist.shape[1]) < velocity.shape[1], twist.shape)
        return self._inertia(np.ones_like(velocity), translation.astype(float))


def momentum(discretisation: Discretisation, points: FloatArray, velocity: FloatArray) -> FloatArray:
    """Momentum (d,) of the fluid alone [mass·length/time]."""
    own = discretisation.problem.density * discretisation.mass_times(points, velocity).sum(axis=0)
    return np.asarray(discretisation.surfaces.ranks.sum(own))


def with_momentum(fluid: FluidState, discretisation: Discretisation, mesh: Mesh) -> FluidState:
    """The state of a flow that starts on a ``mesh``, with its momentum where that is kept."""
    if not discretisation.problem.keeps_momentum:
        return fluid
    return {**fluid, **dict.fromkeys(NAMES, momentum(discretisation, mesh.geometry, fluid["velocity"]))}


def past_load(fluid: FluidState, derivative: FloatArray) -> FloatArray:
    """Load (d,) of a step that is due to the fluid's momentum at earlier times [force]."""
    _, d1, d2 = derivative
    now, before = (fluid[name] for name in NAMES)
    return np.asarray(-d1 * now - d2 * before)
