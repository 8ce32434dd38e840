"""Error of twists and wrenches by the mesh: what halved edges change in the same state."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import kinematics_now
from rigidfluid.core.mechanics.time_scheme import generalised_mass
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.generation.refined_mesh import refined_mesh
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Step, Twist

LEFT = 4.0 / 3.0
"""Error over what halved edges mend of it, where it is of second order: of a higher order it is less [1]."""


def mesh_error(system: System, state: State, time: float) -> FloatArray:
    """Corrections of the twist and wrench of each body and mechanism (r, 2(d+k)), by which a ``state`` would be right.

    The geometry is frozen, the fluid's ∂u/∂t is the latest step's, and from there errors have grown evenly since the
    start; not at all in a flow that was steady then. Raises StepRejected and MeshError where nothing can be told.
    """
    finer = refined_mesh(state.mesh, fluid_domain_at(system, state.pose).placed_on(state.mesh))
    step = _step_in_place(system, state, time)
    twist, wrench = system.backend.refinement(state.fluid, state.mesh, finer, step)
    now, change, d = flat(state.motions.twist), flat(twist), system.dimension
    corrected = Twist(*np.split(now + change, [d], axis=1))
    of_bodies = flat(step.kinematics.component_twist(corrected)) - flat(state.twist)
    of_motions = np.concatenate([change, flat(step.kinematics.motion_wrench(wrench))], axis=1)
    return LEFT * moving_rows(system, np.concatenate([of_bodies, flat(wrench)], axis=1), of_motions)


def moving_rows(system: System, bodies: FloatArray, motions: FloatArray) -> FloatArray:
    """Rows of the ``bodies`` (n, c), and of those of the ``motions`` (N, c) that are mechanisms, (r, c)."""
    return np.concatenate([bodies, motions[len(motions) - len(system.motions.names) :]])


def _step_in_place(system: System, state: State, time: float) -> Step:
    """A step from a state to itself, which would be its solution if the mesh had no errors."""
    assert state.past is not None, "no step has been taken"
    motions, kinematics, now = system.motions, kinematics_now(system, state), flat(state.motions.twist)
    last, grows = 1.0 / state.past.step, 0.0 if _is_steady(system) else 1.0 / time
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


def _is_steady(system: System) -> bool:
    """Tell whether the flow was steady from the start, with its error."""
    return system.fluid is not None and system.fluid.initial == "steady" and bool(system.motions.prescribed.all())
