"""Error of twists and wrenches by the mesh: what halved edges change in the same state."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import kinematics_now
from rigidfluid.core.mechanics.time_scheme import derivative_weights, generalised_mass, predict_pose
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.generation.refined_mesh import refined_mesh
from rigidfluid.core.model.flow_error import ErrorRate, FlowError, RefinedFlow
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose, Step, Twist

LEFT = 4.0 / 3.0
"""Error over what halved edges mend of it, where it is of second order: of a higher order it is less [1]."""


def refinement_error(
    system: System, state: State, time: float, deform: Callable[[State, Pose], Mesh]
) -> tuple[FloatArray, FlowError]:
    """Corrections of the twist and wrench of each body and mechanism (r, 2(d+k)), by which a ``state`` would be right,
    and what the next estimate has to know.

    The geometry is frozen, the fluid's ∂u/∂t is the latest step's, and errors follow from those of earlier estimates
    by BDF2, from none at the start, or from those that a steady flow had then. Raises StepRejected and MeshError
    where nothing can be told.
    """
    mesh, finer = state.mesh, refined_mesh(state.mesh, fluid_domain_at(system, state.pose).placed_on(state.mesh))
    assert state.past is not None, "no step has been taken"
    size = state.past.step
    before = state.flow_error
    growth = _growth(before, time, _started_steady(system))
    step = step_in_place(system, state, time, growth[0])
    rate = None if before is None else _known_rate(before, growth, step)

    def mesh_velocity(twist: FloatArray) -> FloatArray:
        motions = Twist(*np.split(twist, [system.dimension], axis=1))
        pose = predict_pose(state.motions.pose, motions, None, size, None)
        return (deform(state, system.motions.poses(pose, time)).geometry - mesh.geometry) / size

    flow = RefinedFlow(state.fluid, mesh, finer)
    twist, wrench, velocity = system.backend.refinement(flow, step, rate, mesh_velocity)
    now, change, d = flat(state.motions.twist), flat(twist), system.dimension
    corrected = Twist(*np.split(now + change, [d], axis=1))
    of_bodies = flat(step.kinematics.component_twist(corrected)) - flat(state.twist)
    of_motions = np.concatenate([change, flat(step.kinematics.motion_wrench(wrench))], axis=1)
    found = LEFT * moving_rows(system, np.concatenate([of_bodies, flat(wrench)], axis=1), of_motions)
    return found, FlowError(np.array([time]), velocity[None], change[None]).after(state.flow_error)


def moving_rows(system: System, bodies: FloatArray, motions: FloatArray) -> FloatArray:
    """Rows of the ``bodies`` (n, c), and of those of the ``motions`` (N, c) that are mechanisms, (r, c)."""
    return np.concatenate([bodies, motions[len(motions) - len(system.motions.names) :]])


def _growth(before: FlowError | None, time: float, steady: bool) -> FloatArray:
    """Weights (3,) of the error at a ``time`` and of those ``before`` it in its derivative, from none at time 0, or
    from the first estimate on in a flow that was ``steady`` until then."""
    times = [time, *(() if before is None else before.times), *(() if steady else (0.0,))]
    if len(times) == 1:
        return np.zeros(3)
    return derivative_weights(times[0] - times[1], times[1] - times[2] if len(times) > 2 else None)


def _known_rate(before: FlowError, growth: FloatArray, step: Step) -> ErrorRate:
    """Part of the derivative with the weights ``growth`` (3,) that errors ``before`` a ``step`` are."""
    weights = growth[1 : 1 + len(before.times)] / growth[0]
    of_motions = np.tensordot(weights, before.twist, axes=1)
    load = -np.einsum("nij,nj->ni", step.mass_matrix, of_motions)
    return ErrorRate(growth[0] * np.tensordot(weights, before.velocity, axes=1), load)


def step_in_place(system: System, state: State, time: float, grows: float) -> Step:
    """A step from a state to itself, which would be its solution if the mesh had no errors; where it has, they grow
    with the weight ``grows`` [1/time]."""
    assert state.past is not None, "no step has been taken"
    motions, kinematics, now = system.motions, kinematics_now(system, state), flat(state.motions.twist)
    last = 1.0 / state.past.step
    mass = grows * generalised_mass(motions.mass, motions.inertia(time), state.motions.pose)
    mass[motions.prescribed] = 0.0
    links = system.solved_joints.links(state.motions.pose, time)
    held = flat(state.motions.hydrodynamic)
    if len(links.rate):
        held = held + np.tensordot(state.link.force, links.rows, axes=1)
    return Step(
        time=time,
        derivative=np.array([grows, last - grows, -last]),
        extrapolation=np.array([1.0, 0.0]),
        pose=state.pose,
        points=state.mesh.geometry,
        mass_matrix=mass,
        load=np.einsum("nij,nj->ni", mass, now) - held,
        prescribed=motions.prescribed,
        prescribed_twist=now,
        impulse=np.zeros_like(now),
        load_scale=0.0,
        turning=np.zeros_like(now),
        kinematics=kinematics,
        links=links,
    )


def _started_steady(system: System) -> bool:
    """Tell whether the flow was steady at the start, with its error."""
    return system.fluid is not None and system.fluid.initial == "steady" and bool(system.motions.prescribed.all())
