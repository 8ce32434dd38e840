"""One attempted step: predict, move the mesh, find contacts, push, advance. State in, candidate out."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.clock import Clock
from rigidfluid.core.energy import Power, kinetic_energy
from rigidfluid.core.mesh_adaptation import Mover
from rigidfluid.core.proximity import surroundings
from rigidfluid.core.state import Past, State
from rigidfluid.core.stopwatch import Stopwatch
from rigidfluid.core.system import System
from rigidfluid.core.time_scheme import derivative_weights, extrapolation_weights, newton_euler, predict_pose
from rigidfluid.core.types import Advance, Contacts, FloatArray, Mesh, Pose, Step, Twist, Wrench
from rigidfluid.core.wrenches import contact_wrench
from rigidfluid.errors import StepRejected

CLOSEST_APPROACH = 0.5
"""A step may close a gap to this fraction of it, no further: a gap is met by many steps, not jumped over."""


def predicted(state: State, size: float) -> Pose:
    """Where the bodies are after a step of this size [time]."""
    return predict_pose(state.pose, state.twist, state.past_twist, size, state.past_step)


def attempt(system: System, clock: Clock, mover: Mover, watch: Stopwatch, state: State, level: int) -> State:
    """The candidate state one step of this level later.

    Raises
    ------
    StepRejected
        When bodies overlap, a cell is tangled or the backend fails.
    """
    size = clock.size(level)
    time = clock.time(state.tick + clock.ticks(level))
    pose = predicted(state, size)
    with watch("move mesh"):
        mesh = mover.moved(state, pose)
    with watch("detect"):
        contacts, gaps = surroundings(system, pose, mesh)
        _refuse_overlap(system, gaps)
        pushed = _contact_wrench(system, contacts, pose)
    with watch("advance"):
        step = _step(system, state, time, size, pose, mesh, pushed)
        advance = system.backend.advance(state.fluid, state.mesh, step)
    return State(
        tick=state.tick + clock.ticks(level),
        count=state.count + 1,
        level=level,
        pose=pose,
        twist=advance.twist,
        past=Past(state.pose, state.twist, size),
        mesh=mesh,
        reference=state.reference,
        fluid=advance.fluid,
        contacts=contacts,
        gaps=gaps,
        hydrodynamic_wrench=advance.hydrodynamic_wrench,
        contact_wrench=pushed,
        ledger=state.ledger.after(
            size,
            _power(system, advance, pushed),
            advance.kinetic_energy + bodies_energy(system, pose, advance.twist),
            contact_energy(system, contacts),
        ),
    )


def bodies_energy(system: System, pose: Pose, twist: Twist) -> float:
    """Kinetic energy of the free bodies; what a hand drives has no energy of its own in the balance."""
    free = ~system.controlled
    return kinetic_energy(system.mass * free, system.inertia * free[:, None, None], pose, twist)


def contact_energy(system: System, contacts: Contacts) -> float:
    """Stored in the contacts [energy]."""
    return float(np.sum(system.law.energy(contacts))) if system.law and len(contacts) else 0.0


def _contact_wrench(system: System, contacts: Contacts, pose: Pose) -> Wrench:
    """Zero without any work where nothing is near."""
    if system.law is None or len(contacts) == 0:
        return Wrench(np.zeros_like(system.twist.velocity), np.zeros_like(system.twist.angular_velocity))
    return contact_wrench(contacts, system.law.force(contacts), pose)


def _step(
    system: System, state: State, time: float, size: float, pose: Pose, mesh: Mesh | None, pushed: Wrench
) -> Step:
    derivative = derivative_weights(size, state.past_step)
    poses, twists = [state.pose], [state.twist]
    if state.past is not None:
        poses.append(state.past.pose)
        twists.append(state.past.twist)
    wrench = Wrench(pushed.force + system.weight, pushed.torque)
    mass_matrix, load = newton_euler(system.mass, system.inertia, pose, poses, twists, derivative, wrench)
    return Step(
        time=time,
        derivative=derivative,
        extrapolation=extrapolation_weights(size, state.past_step),
        pose=pose,
        points=None if mesh is None else mesh.points,
        mass_matrix=mass_matrix,
        load=load,
        controlled=system.controlled,
        controlled_twist=system.controlled_twist(time),
    )


def _power(system: System, advance: Advance, pushed: Wrench) -> Power:
    """The hands that drive controlled bodies work against the fluid and the contacts."""
    twist, fluid = advance.twist, advance.hydrodynamic_wrench
    driven = _rate(fluid, twist) + _rate(pushed, twist)
    return Power(
        gravity=gravity_power(system, twist),
        boundary=advance.boundary_power,
        control=-float(driven[system.controlled].sum()),
        dissipation=advance.dissipation,
    )


def gravity_power(system: System, twist: Twist) -> float:
    """Of the submerged weight of the free bodies [energy/time]."""
    return float(np.sum((system.weight * twist.velocity)[~system.controlled]))


def _rate(wrench: Wrench, twist: Twist) -> FloatArray:
    return np.asarray(
        np.sum(wrench.force * twist.velocity, axis=1) + np.sum(wrench.torque * twist.angular_velocity, axis=1)
    )


def _refuse_overlap(system: System, gaps: FloatArray) -> None:
    body = int(np.argmin(gaps))
    if gaps[body] <= 0.0:
        raise StepRejected(
            f"body {system.surfaces[body]}",
            f"a gap of {gaps[body]:.3e}",
            "a positive gap to every other surface",
            "Strengthen the contact force, widen contact.range or refine mesh.size_body.",
        )
