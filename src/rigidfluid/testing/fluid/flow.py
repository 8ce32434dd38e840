"""A backend taken from step to step as the loop does, with the motion of mesh and bodies given beforehand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.time_scheme import derivative_weights, extrapolation_weights, newton_euler
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.types import Advance, FluidState, Mesh, Pose, Step, Twist, Wrench


@dataclass(frozen=True)
class Bodies:
    """Masses of n bodies: ``mass`` (n,), ``inertia`` (n, k, k); ``prescribed`` (n,), whether a twist is."""

    mass: FloatArray
    inertia: FloatArray
    prescribed: BoolArray

    @classmethod
    def uniform(cls, pose: Pose, mass: float = 1.0, prescribed: bool = True) -> Bodies:
        """Bodies of one mass, with an inertia that couples the axes in 3D."""
        count, dimension = pose.position.shape
        inertia = np.eye(1) if dimension == 2 else np.array([[1.0, 0.2, 0.1], [0.2, 1.5, 0.3], [0.1, 0.3, 2.0]])
        scale = 0.004 * mass
        return cls(np.full(count, mass), np.tile(scale * inertia, (count, 1, 1)), np.full(count, prescribed))


@dataclass(frozen=True)
class Flow:
    """Fluid and bodies at one time; ``after`` gives the next, and leaves this one as it is.

    ``reference``: the mesh that the motion of ``mesh`` starts from.
    """

    backend: FluidBackend
    reference: Mesh
    mesh: Mesh
    fluid: FluidState
    bodies: Bodies
    pose: Pose
    twist: Twist
    time: float = 0.0
    past: tuple[Pose, Twist, float] | None = None
    latest: tuple[Step, Advance] | None = None

    @classmethod
    def start(
        cls,
        backend: FluidBackend,
        mesh: Mesh,
        pose: Pose,
        bodies: Bodies | None = None,
        twist: FloatArray | None = None,
    ) -> Flow:
        """Fluid at rest until bodies are set in motion with ``twist`` (n, d+k)."""
        moving = twist_from_components(np.zeros((len(pose.position), size(pose))) if twist is None else twist, pose)
        fluid, _ = backend.initial(mesh, pose, moving)
        return cls(backend, mesh, mesh, fluid, bodies or Bodies.uniform(pose), pose, moving)

    def after(self, length: float | None, **changes: Any) -> Flow:
        """The flow a step later; see `step_after` for what may be given."""
        return self.taken(self.step_after(length, **changes), length)

    def taken(self, step: Step, length: float | None) -> Flow:
        """The flow after this step."""
        assert step.points is not None
        mesh = self.mesh.moved_to(step.points)
        assert np.all(cell_volumes(mesh.points, mesh.cells) > 0.0), "the test itself moves the mesh until it folds"
        advance = self.backend.advance(self.fluid, self.mesh, step)
        past = None if length is None else (self.pose, self.twist, length)
        return replace(
            self,
            mesh=mesh,
            fluid=advance.fluid,
            pose=step.pose,
            twist=advance.twist,
            time=step.time,
            past=past,
            latest=(step, advance),
        )

    @property
    def step(self) -> Step:
        """The step that led here."""
        assert self.latest is not None, "no step was taken"
        return self.latest[0]

    @property
    def advance(self) -> Advance:
        """Result of the step that led here, as the backend returned it."""
        assert self.latest is not None, "no step was taken"
        return self.latest[1]

    def step_after(
        self,
        length: float | None,
        points: FloatArray | None = None,
        pose: Pose | None = None,
        twist: FloatArray | None = None,
        push: FloatArray | None = None,
        impulse: FloatArray | None = None,
    ) -> Step:
        """The step from here.

        Parameters
        ----------
        length : float or None
            Its length [time]; None for a steady flow, all weights of the time derivative zero.
        points : (N, d) array, optional
            Points of the mesh at its end [length]; without them the mesh is at rest.
        pose : Pose, optional
            Pose of the bodies at its end; without it they stay.
        twist : (n, d+k) array, optional
            Twist of the prescribed bodies; without it they rest.
        push : (n, d+k) array, optional
            Force and torque on the bodies besides the fluid's [force | force·length].
        impulse : (n, d+k) array, optional
            Impulse of contacts, given at once [force·time | force·length·time].
        """
        pose = pose or self.pose
        weights, extrapolation = self._time_weights(length)
        nothing = np.zeros((len(pose.position), size(pose)))
        pushed, given = (nothing if each is None else each for each in (push, impulse))
        mass_matrix, load = self._newton_euler(pose, weights, pushed)
        return Step(
            time=self.time + (length or 0.0),
            derivative=weights,
            extrapolation=extrapolation,
            pose=pose,
            points=self.mesh.geometry if points is None else points,
            mass_matrix=mass_matrix,
            load=load + weights[0] * given,
            prescribed=self.bodies.prescribed,
            prescribed_twist=nothing if twist is None else twist,
            impulse=given,
            load_scale=0.0,
            turning=nothing,
        )

    def _time_weights(self, length: float | None) -> tuple[FloatArray, FloatArray]:
        """Weights of the time derivative (3,) and of the extrapolation (2,)."""
        if length is None:
            return np.zeros(3), np.array([1.0, 0.0])
        before = None if self.past is None else self.past[2]
        return derivative_weights(length, before), extrapolation_weights(length, before)

    def _newton_euler(self, pose: Pose, weights: FloatArray, pushed: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mass matrix and load of the bodies, under force and torque ``pushed`` (n, d+k)."""
        d, poses, twists = pose.position.shape[1], [self.pose], [self.twist]
        if self.past is not None:
            poses.append(self.past[0])
            twists.append(self.past[1])
        wrench = Wrench(pushed[:, :d], pushed[:, d:])
        return newton_euler(self.bodies.mass, self.bodies.inertia, pose, poses, twists, weights, wrench)

    def probe(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocity (N, d) and pressure (N,) at ``points`` (N, d)."""
        return self.backend.probe(self.fluid, self.mesh, points)


def size(pose: Pose) -> int:
    """Components of a twist, d + k."""
    return 3 if pose.position.shape[1] == 2 else 6


def twist_from_components(components: FloatArray, pose: Pose) -> Twist:
    """A twist from its components (n, d+k)."""
    d = pose.position.shape[1]
    return Twist(components[:, :d].copy(), components[:, d:].copy())


def components(record: Twist | Wrench) -> FloatArray:
    """Twists or wrenches as rows, (n, d+k)."""
    return flat(record)


def figures(advance: Advance) -> Mapping[str, FloatArray]:
    """All of a result that does not depend on how a backend lays out its state."""
    energies = [advance.kinetic_energy, advance.dissipation, advance.dissipation_midway, advance.boundary_power]
    return {
        "twist": components(advance.twist),
        "wrench": components(advance.hydrodynamic_wrench),
        "energies": np.array(energies),
    }
