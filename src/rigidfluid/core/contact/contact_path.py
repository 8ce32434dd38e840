"""Path of the bodies through one step: their motion by contacts between two fluid solves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil
from typing import NamedTuple, TypeVar

import numpy as np

from rigidfluid.core.contact.coupled_dynamics import CoupledDynamics
from rigidfluid.core.contact.extrapolated_contacts import ExtrapolatedContacts
from rigidfluid.core.contact.implicit_contacts import KEPT, implicit_contact_step
from rigidfluid.core.contact.proximity import arms, detect, interacting, refuse_overlap
from rigidfluid.core.contact.substep import Plan, Reach, plan, relative_motion, relative_velocity
from rigidfluid.core.contact.tracked_pairs import TrackedPairs
from rigidfluid.core.mechanics.motions import (
    accelerations,
    body_accelerations,
    body_load,
    carried_bodies,
    mobility,
    outer_load,
)
from rigidfluid.core.mechanics.time_scheme import predict_pose, start_pose
from rigidfluid.core.mechanics.wrenches import contact_wrench, flat, nothing, power
from rigidfluid.core.model.contacts import middle, select
from rigidfluid.core.model.dynamics import BodyDynamics, PushedDynamics
from rigidfluid.core.model.interfaces import ForceLaw
from rigidfluid.core.model.reduced_model import Coupling, uncoupled
from rigidfluid.core.model.state import LinkLoad, MotionState, State, unloaded
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import BoolArray, Contacts, FloatArray, Pose, Twist, Wrench
from rigidfluid.errors import StepRejected

MOST_SUBSTEPS = 100_000
"""Largest number of substeps in one step; more reject it."""

HOPELESS = 1_000 * MOST_SUBSTEPS
"""A planned substep count above this rejects the step at once; separating bodies need fewer in the end, but not by so
much."""

IMPLICIT_PARTS = 8
"""Number of implicit steps of the bodies in one step of a fluid."""

RESOLVED = 8.0
"""Largest number of substeps with which a step resolves its contacts: all forces then vary within it."""

MOST_ALIKE = 1_000
"""Re-plan the substep length after this many equal substeps; separating bodies need fewer."""

SPRING_RESOLUTION = 0.2
"""A substep times the highest frequency of springs in joints: some thirty substeps in a period."""

ROUNDING = 1e-9
"""Remainder of a step, over the step, that is taken for the rounding of sums."""


M = TypeVar("M", bound=BodyDynamics)


@dataclass(frozen=True, slots=True)
class BodyStep:
    """Result of a path: the bodies at the end of a step, and the contacts' impulse and work in it.

    ``pose`` and ``twist`` at the end, and ``motions`` that carry the bodies; ``impulse`` of the contacts [force·time |
    force·length·time], ``dissipated`` by them, ``friction`` unresolved by the fluid solves, and ``actuator_work``
    against contacts of prescribed bodies and walls [energy]; the number of ``substeps``, and the ``coupling`` with the
    fluid that led here, None without contacts. ``link``: mean loads of joints; zero in a fluid, whose solution has
    them. ``drag_loss``: in a fluid without inertia ``friction`` is known for certain, and is given here instead.
    """

    pose: Pose
    twist: Twist
    motions: MotionState
    impulse: Wrench
    dissipated: float
    actuator_work: float
    substeps: int
    link: LinkLoad
    friction: float = 0.0
    coupling: Coupling | None = None
    drag_loss: float = 0.0


def advance_bodies(system: System, state: State, start: float, size: float, coupling: Coupling | None) -> BodyStep:
    """Follow the bodies through one step, from ``start`` over ``size`` [time], kicked by their contacts in velocity
    Verlet substeps, or with ``implicit`` contacts in implicit steps.

    The substeps are the whole motion without a fluid. Substeps in a fluid take the place of the fluid's own small
    steps: the bodies near contacts respond with the mass and the friction of the ``coupling``, and the fluid then
    responds to the impulse. Poses come from Adams–Bashforth 2 as one formula where the coupling is None, as nothing can
    touch (see `near_contacts`). StepRejected is raised if bodies overlap on the way, or a contact is too stiff to be
    followed.
    """
    if not system.has_fluid:
        return _advance_free(system, state, start, size)
    if coupling is None or system.law is None:
        pose = predict_pose(state.motions.pose, state.motions.twist, state.past_twist, size, state.past_step)
        return _undisturbed(system, pose, state.motions.twist, start + size)
    return _advance_coupled(system, system.law, state, start, size, coupling)


def first_step_again(system: System, state: State, end_twist: Twist, end: float, size: float) -> BodyStep:
    """First step of bodies that touch nothing, repeated with the mean of the motions' twists at its start and its
    ``end`` [time]."""
    pose = start_pose(state.motions.pose, state.motions.twist, end_twist, size)
    return _undisturbed(system, pose, end_twist, end)


def _undisturbed(system: System, pose: Pose, twist: Twist, end: float) -> BodyStep:
    """Result of a step of the motions alone, without contacts."""
    motions = MotionState(pose, twist, nothing(pose), nothing(pose))
    bodies = carried_bodies(system, pose, twist, end)
    return BodyStep(*bodies, motions, nothing(bodies[0]), 0.0, 0.0, 1, unloaded(pose))


def near_contacts(system: System, state: State, start: float, size: float) -> Contacts:
    """Contacts in range, or that may come into it in a step of this ``size`` from ``start`` on: by twice the present
    speed of their surfaces and the greatest acceleration."""
    contacts = state.contacts
    if system.law is None or len(contacts) == 0:
        return select(contacts, np.zeros(len(contacts), dtype=bool))
    speed = np.linalg.norm(relative_velocity(contacts, state.pose, state.twist), axis=1)
    rate, d = body_accelerations(system, state, start, size), system.dimension
    pull = np.linalg.norm(rate[:, :d], axis=1) + arms(system) * np.linalg.norm(rate[:, d:], axis=1)
    pull = np.append(pull, 0.0)
    both = pull[contacts.body_a] + pull[np.minimum(contacts.body_b, len(pull) - 1)]
    return select(contacts, contacts.gap <= system.law.range + 2.0 * size * (speed + size * both))


def _advance_free(system: System, state: State, start: float, size: float) -> BodyStep:
    movement = _dry(system, state, start)
    if system.law is None:
        path = _free_flight(system, movement, size)
    elif system.implicit:
        path, movement = _implicit_free(system, system.law, movement, size)
    else:
        reach, span = _horizon(system, movement, size)
        path = _resolve(system, system.law, movement, _detected(system, reach), size, span)
    done = movement.link_work
    dissipated, actuator_work = path.dissipated + done.damped, path.actuator_work + done.driven
    return replace(path, dissipated=dissipated, actuator_work=actuator_work, link=done.load(size))


def _dry(system: System, state: State, start: float) -> BodyDynamics:
    """Dynamics of the bodies without a fluid, on motions that joints may link."""
    linked = system.joints.over(_dry_motions(system, state, start), start)
    return system.motions.carry(linked, start, body_load(system, state))


def _dry_motions(system: System, state: State, start: float) -> PushedDynamics:
    def given(elapsed: float) -> FloatArray:
        return system.controlled_twist(start + elapsed)

    now, load = state.motions, body_load(system, state)
    return system.motions.dry_dynamics(now.pose, now.twist, load, arms(system), start, given)


def _advance_coupled(
    system: System, law: ForceLaw, state: State, start: float, size: float, coupling: Coupling
) -> BodyStep:
    motions, near = _coupled(system, state, coupling), near_contacts(system, state, start, size)
    movement = system.motions.carry(system.joints.over(motions, start), start)
    if system.quasi_steady or size <= RESOLVED * _planned(system, law, near, movement, size, size).substep:
        motions.vary_load(size)
    if system.implicit:
        path = _implicit_coupled(system, law, movement, near, size)
    else:
        contacts_at: Callable[[Pose], Contacts]
        if system.detector.needs_mesh:
            contacts_at, span = ExtrapolatedContacts(near, state.pose).extrapolate, size
        else:
            reach, span = _horizon(system, movement, size)
            contacts_at = _detected(system, reach)
        path = _resolve(system, law, movement, contacts_at, size, span)
        path = replace(path, friction=movement.friction_loss)
    if system.quasi_steady:
        path = replace(path, friction=0.0, drag_loss=path.friction)
    return replace(path, coupling=coupling)


def _implicit_free(system: System, law: ForceLaw, movement: BodyDynamics, size: float) -> tuple[BodyStep, BodyDynamics]:
    """Advance by one implicit step, or as many as springs need; return also the movement at the end."""
    parts = _parts(system, size)
    path, movement = _implicit_or_free(system, law, movement, size / parts)
    for _ in range(1, parts):
        before = path
        path, movement = _implicit_or_free(system, law, movement, size / parts)
        path = replace(
            path,
            impulse=_added(path.impulse, before.impulse, 1.0),
            dissipated=path.dissipated + before.dissipated,
            actuator_work=path.actuator_work + before.actuator_work,
            substeps=path.substeps + before.substeps,
        )
    return path, movement


def _implicit_or_free(
    system: System, law: ForceLaw, movement: BodyDynamics, size: float
) -> tuple[BodyStep, BodyDynamics]:
    contacts = _foreseen(system, law, movement, size, 0.0)
    if len(contacts.start) == 0:
        return _free_flight(system, movement, size), movement
    return _implicit_step(system, law, movement, contacts.start, contacts, size)


def _implicit_coupled(system: System, law: ForceLaw, movement: BodyDynamics, near: Contacts, size: float) -> BodyStep:
    """Advance by several implicit steps in one of the fluid's: an impact takes no time, and friction acts before and
    after it.

    The impact in a single one would last as long as the fluid's step and meet friction all the while, and the impulse
    be too great for the fluid's mass.
    """
    part, impulse, lost, actuator_work = size / IMPLICIT_PARTS, nothing(movement.pose), 0.0, 0.0
    on_mesh = ExtrapolatedContacts(near, movement.pose) if system.detector.needs_mesh else None
    reach = max(float(near.gap.max()), law.range + 4.0 * _fastest(system, movement, size) * size)
    for _ in range(IMPLICIT_PARTS):
        followed = on_mesh or _foreseen(system, law, movement, part, reach)
        start = followed.start if isinstance(followed, TrackedPairs) else followed.extrapolate(movement.pose)
        if len(start) == 0:
            _free_flight(system, movement, part)
            continue
        path, movement = _implicit_step(system, law, movement, start, followed, part)
        impulse = _added(impulse, path.impulse, 1.0)
        lost, actuator_work = lost + path.dissipated, actuator_work + path.actuator_work
    return _arrived(movement, impulse, lost, actuator_work, IMPLICIT_PARTS, movement.friction_loss)


def _implicit_step(
    system: System,
    law: ForceLaw,
    movement: M,
    start: Contacts,
    followed: TrackedPairs | ExtrapolatedContacts,
    size: float,
) -> tuple[BodyStep, M]:
    """Advance by one implicit step; return also the movement at its end."""
    crossing = implicit_contact_step(law, movement, start, followed.extrapolate, size, system.wall_velocity)
    end, wrench, lost, driven, stored = crossing
    if isinstance(followed, TrackedPairs):
        _refuse_unseen(law, followed, end.pose, KEPT * stored)
    impulse = Wrench(size * wrench.force, size * wrench.torque)
    before, after = (each.prescribed_twist(system.motions.controlled) for each in (movement, end))
    mean = Twist(
        0.5 * (before.velocity + after.velocity),
        0.5 * (before.angular_velocity + after.angular_velocity),
    )
    actuator_work = driven - float(power(impulse, mean)[_driven(system)].sum())
    return _arrived(end, impulse, lost, actuator_work, 1), end


def _foreseen(system: System, law: ForceLaw, movement: BodyDynamics, size: float, reach: float) -> TrackedPairs:
    """Contacts that a step of this ``size`` may bring into range, and at least those in ``reach`` [length].

    The speed allowed for is four times the fastest, as impacts may double that of both bodies, and twice the speed that
    bodies at rest, pressed together, may get from the energy of their contacts.
    """
    reach = max(reach, law.range + 4.0 * _fastest(system, movement, size) * size)
    contacts = TrackedPairs(system, movement.pose, reach)
    released = _released(system, law, movement, contacts.start)
    if released > 0.0:
        contacts = TrackedPairs(system, movement.pose, reach + 2.0 * released * size)
    return contacts


def _released(system: System, law: ForceLaw, movement: BodyDynamics, contacts: Contacts) -> float:
    """Greatest speed of a surface if a body had all energy that its contacts store [length/time]."""
    energy, stored = law.energy(contacts), np.zeros(len(system.surfaces))
    np.add.at(stored, contacts.body_a, energy)
    np.add.at(stored, contacts.body_b, energy)
    straight, turning = (np.linalg.eigvalsh(each)[:, -1] for each in (movement.mobility, movement.inverse_inertia))
    lightness = straight + arms(system) ** 2 * turning
    return float(np.sqrt(2.0 * np.max(stored[: len(lightness)] * lightness)))


def _refuse_unseen(law: ForceLaw, followed: TrackedPairs, end: Pose, allowed: float) -> None:
    """Raise StepRejected if contacts that came or went untracked hold more energy than ``allowed``."""
    missed = followed.missed(law, end)
    if abs(missed) > allowed:
        found = f"contacts of a pair that came or went within it, with an energy of {missed:.1e}"
        raise StepRejected("the implicit contact step", found, "contacts that last through it", "Shorten the step.")


def _horizon(system: System, movement: BodyDynamics, size: float) -> tuple[float, float]:
    """Gap up to which contacts are detected ahead [length], and the time for which that suffices [time]."""
    law_range = system.law.range if system.law else 0.0
    if system.substeps:
        return law_range, size
    largest = max(body.bounding_radius for body in system.bodies)
    fastest = _fastest(system, movement, size)
    ahead = min(2.0 * fastest * size, law_range + 2.0 * largest)
    return law_range + ahead, 0.5 * ahead / fastest if fastest > 0 else size


def _detected(system: System, reach: float) -> Callable[[Pose], Contacts]:
    """Function of the pose that detects the contacts, by a detector that needs no mesh."""

    def contacts_at(pose: Pose) -> Contacts:
        near = detect(system, pose, None, reach)
        chosen = interacting(system, near)
        return near if chosen.all() else select(near, chosen)

    return contacts_at


def _coupled(system: System, state: State, coupling: Coupling) -> CoupledDynamics:
    """Dynamics of the bodies in a fluid; those outside the model keep their acceleration, and respond with mass and
    added mass."""
    linear, angular = mobility(system, state)
    rate = accelerations(system, state)
    weight = None
    if system.quasi_steady:
        weight = flat(outer_load(system, state)).flat[coupling.model.velocities]
    return CoupledDynamics(state.motions.pose, state.motions.twist, rate, linear, angular, coupling, weight)


def _free_flight(system: System, movement: BodyDynamics, size: float) -> BodyStep:
    none, parts = nothing(movement.pose), _parts(system, size)
    for _ in range(parts):
        movement.kick(none, 0.5 * size / parts)
        movement.drift(size / parts)
        movement.kick(none, 0.5 * size / parts)
    return _arrived(movement, none, 0.0, 0.0, parts)


def _parts(system: System, size: float) -> int:
    """Number of parts of a step that resolve the springs of joints."""
    return max(1, ceil(size * system.joints.frequency / SPRING_RESOLUTION))


def _arrived(
    movement: BodyDynamics, impulse: Wrench, dissipated: float, actuator_work: float, count: int, friction: float = 0.0
) -> BodyStep:
    """Result at the end of a step, or of a part of it."""
    end = movement.pose, movement.twist, movement.motions(impulse), impulse
    return BodyStep(*end, dissipated, actuator_work, count, unloaded(end[2].pose), friction)


def _resolve(
    system: System,
    law: ForceLaw,
    movement: BodyDynamics,
    contacts_at: Callable[[Pose], Contacts],
    size: float,
    span: float,
) -> BodyStep:
    """Advance by velocity Verlet: half a kick, a drift, half a kick; the second is that of the new pose.

    Substeps are planned for a ``span`` [time] at a time, as far ahead as contacts are detected, and anew when the
    contacts are over.
    """
    contacts = contacts_at(movement.pose)
    impulse, dissipated, actuator_work, count, left = nothing(movement.pose), 0.0, 0.0, 0, size
    push = _contact_load(system, law, contacts, movement)
    planned, free_flight, substep, longest = 0.0, 0.0, 0.0, size / _parts(system, size)
    while left > 0.0:
        if planned <= 0.0 or contacts.gap.min(initial=np.inf) > law.range:
            planned = min(left, span)
            free_flight, substep = _plan(system, law, contacts, movement, size, planned)
            planned = min(planned, free_flight + MOST_ALIKE * substep)
        part = min(free_flight or substep, left, longest)
        movement.kick(push.wrench, 0.5 * part)
        movement.drift(part)
        contacts = contacts_at(movement.pose)
        _refuse_overlap(system, contacts)
        before, push = push, _contact_load(system, law, contacts, movement)
        movement.kick(push.wrench, 0.5 * part)
        push = push._replace(loss=_loss(system, contacts, movement, push.damping))
        impulse = _added(_added(impulse, before.wrench, 0.5 * part), push.wrench, 0.5 * part)
        dissipated += 0.5 * part * (before.loss + push.loss)
        actuator_work += 0.5 * part * (before.actuator_work + push.actuator_work)
        count, planned = count + 1, planned - part
        free_flight = free_flight - part if free_flight - part > ROUNDING * size else 0.0
        left = left - part if left - part > ROUNDING * size else 0.0
        if count == MOST_SUBSTEPS and left > 0.0:
            raise _too_stiff(system, contacts, part)
    return _arrived(movement, impulse, dissipated, actuator_work, count)


def _plan(system: System, law: ForceLaw, contacts: Contacts, movement: BodyDynamics, size: float, span: float) -> Plan:
    if system.substeps:
        return Plan(0.0, size / system.substeps)
    planned = _planned(system, law, contacts, movement, size, span)
    if contacts.gap.min(initial=np.inf) <= law.range and span - planned.free_flight > HOPELESS * planned.substep:
        raise _too_stiff(system, contacts, planned.substep)
    return planned


def _planned(
    system: System, law: ForceLaw, contacts: Contacts, movement: BodyDynamics, size: float, span: float
) -> Plan:
    return plan(law, contacts, movement, _surfaces(system), size, span, system.quasi_steady)


def _surfaces(system: System) -> Reach:
    """Reach of the surfaces: balls turn in their place, but not as components of a mechanism."""
    radii = np.array([body.bounding_radius for body in system.bodies])
    alone = np.bincount(system.motions.carrier)[system.motions.carrier] == 1
    return Reach(np.where(alone, arms(system), radii), system.leverage)


class _ContactLoad(NamedTuple):
    """Loads of the contacts at one moment: their ``wrench``, the forces of ``damping`` (m, d) in it, None without
    dampers, the power ``loss`` of these, and the power ``actuator_work`` of prescribed bodies and walls."""

    wrench: Wrench
    damping: FloatArray | None
    loss: float
    actuator_work: float


def contact_forces(system: System, state: State, time: float) -> FloatArray:
    """Force of each contact of a state on its first body, by all laws and their dampers (m, d), zero at the start
    [force]."""
    contacts, law = state.contacts, system.law
    if law is None or len(contacts) == 0 or state.count == 0:
        return np.zeros((len(contacts), system.dimension))
    if not law.dissipative:
        return law.force(contacts)
    motion = relative_motion(contacts, _bodies_now(system, state, time), system.wall_velocity)
    return np.asarray(law.force(contacts) + law.damping(contacts, motion))


def _bodies_now(system: System, state: State, time: float) -> BodyDynamics:
    """Dynamics of the bodies of a state as contacts see them, in a fluid by the coupling that its solution has shown;
    without joints."""
    if not system.has_fluid:
        motions = _dry_motions(system, state, time)
    else:
        motions = _coupled(system, state, state.coupling or uncoupled())
    return system.motions.carry(motions, time)


def _contact_load(system: System, law: ForceLaw, contacts: Contacts, movement: BodyDynamics) -> _ContactLoad:
    if len(contacts) == 0:
        return _ContactLoad(nothing(movement.pose), None, 0.0, 0.0)
    force, damping, loss = law.force(contacts), None, 0.0
    if law.dissipative:
        motion = relative_motion(contacts, movement, system.wall_velocity)
        damping = law.damping(contacts, motion)
        force, loss = force + damping, -float(np.sum(damping * motion.velocity))
    wrench, actuator_work = contact_wrench(contacts, force, movement.pose), 0.0
    driven = _driven(system)
    if driven.any():
        actuator_work = -float(power(wrench, movement.prescribed_twist(system.motions.controlled))[driven].sum())
    if system.wall_velocity is not None:
        actuator_work += float(np.sum(force * system.wall_velocity(contacts.body_b, middle(contacts))))
    return _ContactLoad(wrench, damping, loss, actuator_work)


def _loss(system: System, contacts: Contacts, movement: BodyDynamics, damping: FloatArray | None) -> float:
    """Power of the dampers half-way through their kick: times the substep it is the loss of the whole kick."""
    if damping is None:
        return 0.0
    return -float(np.sum(damping * relative_motion(contacts, movement, system.wall_velocity).velocity))


def _driven(system: System) -> BoolArray:
    """Whether the motion of a body is prescribed, in space or relatively to other bodies (n,)."""
    return np.ones_like(system.controlled) if system.motions.driven else system.controlled


def _refuse_overlap(system: System, contacts: Contacts) -> None:
    if len(contacts) == 0 or contacts.gap.min() > 0.0:
        return
    worst = int(np.argmin(contacts.gap))
    refuse_overlap(system, int(contacts.body_a[worst]), float(contacts.gap[worst]))


def _too_stiff(system: System, contacts: Contacts, part: float) -> StepRejected:
    subject = "the bodies"
    if len(contacts):
        subject = f"body {system.surfaces[contacts.body_a[int(np.argmin(contacts.gap))]]}"
    return StepRejected(
        subject,
        f"a contact that needs substeps of {part:.1e}",
        f"at most {MOST_SUBSTEPS} substeps in a step",
        "Soften the contact force: raise its epsilon, or widen its range.",
    )


def _fastest(system: System, movement: BodyDynamics, size: float) -> float:
    """Bound of the speed at which any surface can move in the step, contacts apart [length/time]."""
    twist = movement.twist
    turning = arms(system) * np.linalg.norm(twist.angular_velocity, axis=1)
    return float(np.max(np.linalg.norm(twist.velocity, axis=1) + turning + size * movement.max_acceleration(size)))


def _added(total: Wrench, wrench: Wrench, factor: float) -> Wrench:
    """Add ``factor`` times a wrench to the total in place, and return it."""
    total.force[:] += factor * wrench.force
    total.torque[:] += factor * wrench.torque
    return total
