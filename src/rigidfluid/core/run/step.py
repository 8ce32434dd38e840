"""Attempts one step along the bodies' path: move the mesh, find contacts, advance. State in, candidate out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps, refuse_overlap
from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.coupling.scheme import Scheme
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.actuators import BodiesAfter, actuator_work
from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.kinematics import prescribed_part
from rigidfluid.core.mechanics.motions import applied_wrench, kinematics_now
from rigidfluid.core.mechanics.rigid import kinetic_energy, rotation_between
from rigidfluid.core.mechanics.wrenches import flat, power, wrench_of, wrench_sum
from rigidfluid.core.mesh.adaptation.updater import Updater
from rigidfluid.core.model.energy import Ledger, Power, Work
from rigidfluid.core.model.part_results import refuse_lost_pose
from rigidfluid.core.model.state import LinkLoad, MotionState, Past, State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import spring_energy
from rigidfluid.core.model.types import Advance, Contacts, Mesh, Pose, Step, Twist, Wrench
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.stopwatch import Stopwatch


@dataclass(frozen=True)
class Tools:
    """Means by which the states of a ``system`` are attempted: ``scheme`` of its steps, the run's ``clock``, its
    ``mesh_updater``, and ``watch``, which times the stages."""

    system: System
    scheme: Scheme
    clock: Clock
    mesh_updater: Updater
    watch: Stopwatch


class _Place(NamedTuple):
    """Mesh, contacts and nearest gaps (n,) where a path ends."""

    mesh: Mesh
    contacts: Contacts
    gaps: FloatArray


def attempt(tools: Tools, state: State, level: int, path: BodyStep, provisional: bool) -> tuple[State, Step]:
    """Attempt one step of this level, the bodies to the end of ``path``: the candidate state there, and the step that
    led there.

    A ``provisional`` candidate shows where another path leads, and is not to be accepted. Raises StepRejected where
    bodies overlap, a cell is tangled, the backend fails, or a part gives what is no number.
    """
    system, clock = tools.system, tools.clock
    refuse_lost_pose(system.surfaces, path.pose)
    place = _placed(tools, state, path.pose)
    end = StepEnd(
        clock.time(state.tick + clock.ticks(level)),
        clock.size(level),
        path.motions.pose,
        _pushed(path, clock.size(level)),
    )
    with tools.watch("advance"), system.backend.ranks.raise_on_all():
        step = tools.scheme.prepare(step_to(system, state, end, place.mesh.geometry), state, path)
        step = replace(step, provisional=True) if provisional else step
        advance = system.backend.advance(state.fluid, state.mesh, step)
    twist = step.kinematics.component_twist(advance.twist)
    after = BodiesAfter(path.pose, twist, end.size)
    candidate = replace(
        state,
        tick=state.tick + clock.ticks(level),
        count=state.count + 1,
        level=level,
        pose=path.pose,
        twist=twist,
        past=Past(state.motions.pose, state.motions.twist, end.size, _applied(system, state, step)),
        mesh=place.mesh,
        fluid=advance.fluid,
        coupling=None,
        contacts=place.contacts,
        springs=path.springs,
        gaps=place.gaps,
        hydrodynamic_wrench=advance.hydrodynamic_wrench,
        stresslet=advance.stresslet,
        boundary_forces=advance.boundary_forces,
        scalar=advance.scalar,
        cell_errors=advance.cell_errors,
        contact_wrench=_mean(path.impulse, end.size),
        motions=_motions(path, step, advance, end.size),
        link=_link_load(system, path, step, advance),
        ledger=_ledger_after(system, state, path, _Solved(step, advance, after, place.contacts)),
        estimate=None,
    )
    return candidate, step


def _placed(tools: Tools, state: State, pose: Pose) -> _Place:
    """Mesh, contacts and gaps at a ``pose``; raises StepRejected where bodies overlap."""
    with tools.watch("move mesh"):
        mesh = tools.mesh_updater.deform(state, pose)
    with tools.watch("detect"):
        contacts, gaps = detect_contacts_and_gaps(tools.system, pose, mesh)
        if len(gaps):
            nearest = int(np.argmin(gaps))
            refuse_overlap(tools.system, nearest, float(gaps[nearest]))
    return _Place(mesh, contacts, gaps)


class _Solved(NamedTuple):
    """A step and its solution, the bodies ``after`` it and their contacts."""

    step: Step
    advance: Advance
    after: BodiesAfter
    contacts: Contacts


def _ledger_after(system: System, state: State, path: BodyStep, solved: _Solved) -> Ledger:
    """Ledger after the step along a ``path``."""
    step, advance, after, contacts = solved
    ledger = _ledger_at_start(system, state, advance, step, step.time - after.size)
    power = _power(system, advance, step, path.motions.pose)
    if system.quasi_steady:
        midway = _dissipation_midway(state, ledger.power, advance, after.twist, power)
        power = replace(power, dissipation_midway=midway)
    return ledger.after(
        after.size,
        power,
        _work(system, state, path, actuator_work(system, state, after, step.kinematics)),
        advance.kinetic_energy + bodies_energy(system, after.pose, after.twist),
        stored_energy(system, contacts, path.motions.pose, step.time) + spring_energy(path.springs),
    )


def _pushed(path: BodyStep, size: float) -> Wrench:
    """The impulse of contacts, and without a fluid of joints, on the motions."""
    return wrench_sum(path.motions.contact, wrench_of(size * path.link.wrench, path.pose.position.shape[1]))


def _applied(system: System, state: State, step: Step) -> Wrench | None:
    return None if state.applied is None else applied_wrench(system, state, step.kinematics)


def _link_load(system: System, path: BodyStep, step: Step, advance: Advance) -> LinkLoad:
    """Load of the joints: in a fluid their forces follow from its solution, else from the path."""
    if not system.has_fluid:
        return path.link
    return system.joints.load(step.links, advance.link_force, path.motions.pose, step.time)


def _motions(path: BodyStep, step: Step, advance: Advance, size: float) -> MotionState:
    by_fluid = step.kinematics.motion_wrench(advance.hydrodynamic_wrench)
    return MotionState(path.motions.pose, advance.twist, _mean(path.motions.contact, size), by_fluid)


def _mean(impulse: Wrench, size: float) -> Wrench:
    return Wrench(impulse.force / size, impulse.torque / size)


def bodies_energy(system: System, pose: Pose, twist: Twist) -> float:
    """Kinetic energy of the free bodies; what is driven has no energy of its own in the balance."""
    free = ~system.prescribed
    return kinetic_energy(system.mass * free, system.inertia * free[:, None, None], pose, twist)


def stored_energy(system: System, contacts: Contacts, motions: Pose, time: float) -> float:
    """Energy stored in contacts and springs [energy]."""
    return system.joints.spring_energy(motions, time) + contact_energy(system, contacts)


def contact_energy(system: System, contacts: Contacts) -> float:
    """Energy stored in the contacts [energy]."""
    if system.law is None or len(system.acting(contacts)) == 0:
        return 0.0
    return float(np.sum(system.law.energy(contacts)))


def _power(system: System, advance: Advance, step: Step, motions: Pose) -> Power:
    """Power of a step [energy/time]: that which enters by the boundary, drives bodies and joints in the fluid, or is
    dissipated by fluid and dampers."""
    twist, where = prescribed_part(step)
    control = float(advance.link_force @ step.links.rate)
    if where.any():
        control -= float(power(advance.hydrodynamic_wrench, twist)[where].sum())
    control += system.solved_joints.spring_power(motions, step.time)
    return Power(
        boundary=advance.boundary_power,
        control=control,
        dissipation=advance.dissipation,
        dissipation_midway=advance.dissipation_midway,
        damping=float(step.links.compliance @ advance.link_force**2),
        spurious_flux=advance.spurious_flux,
        grad_div=advance.grad_div,
        source=advance.source_power,
        stress_power=advance.stress_power,
    )


def _dissipation_midway(state: State, before: Power | None, advance: Advance, twist: Twist, after: Power) -> float:
    """Dissipation in a fluid without inertia by the mean force on the bodies at their mean velocity: the mean of the
    flows at both ends is no flow on the mesh midway, and dissipates more [energy/time].

    The dissipation at the end stands for it if the flow before is unknown.
    """
    if before is None:
        return after.dissipation
    force = 0.5 * (flat(state.hydrodynamic_wrench) + flat(advance.hydrodynamic_wrench))
    velocity = 0.5 * (flat(state.twist) + flat(twist))
    to_fluid = 0.5 * sum(power.boundary + power.source - power.grad_div for power in (before, after))
    return to_fluid - float(np.sum(force * velocity))


def _ledger_at_start(system: System, state: State, advance: Advance, step: Step, time: float) -> Ledger:
    """Ledger before a step. If the step restarts at a corner of a stroke, it has the power of the step's own forces
    at its start: half of an impulse acts on the rates before the corner, half on those after it, and nothing of it on
    later steps. Without inertia there is no impulse, and the rates after the corner are unknown until the step is
    made."""
    ledger = state.ledger
    if state.tick == 0 or state.past is not None or ledger.power is None:
        return ledger
    if system.quasi_steady:
        return replace(ledger, power=None)
    motions, prescribed = state.motions.pose, system.prescribed_twist(time)
    links = system.solved_joints.links(motions, time)
    before = replace(step, kinematics=kinematics_now(system, state), prescribed_twist=prescribed, links=links)
    return replace(ledger, power=replace(ledger.power, control=_power(system, advance, before, motions).control))


def _work(system: System, state: State, path: BodyStep, by_actuators: float) -> Work:
    """Work of a step [energy]: of the free bodies' weight, of what drives bodies and walls against contacts and
    inertia, of wrenches from outside, and of dampers."""
    fallen = np.sum(system.weight * (path.pose.position - state.pose.position), axis=1)
    free = float(fallen[~system.prescribed].sum())
    supplied = path.actuator_work + by_actuators + _applied_work(state, path.pose)
    return Work(free, supplied, path.dissipated, path.friction, path.drag_loss)


def _applied_work(state: State, pose: Pose) -> float:
    """Work of wrenches from outside, on the way from a state to a ``pose`` of the bodies [energy]."""
    if state.applied is None:
        return 0.0
    turned = rotation_between(state.pose.orientation, pose.orientation)
    moved = state.applied.force * (pose.position - state.pose.position)
    return float(np.sum(moved) + np.sum(state.applied.torque * turned))
