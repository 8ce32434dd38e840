"""The bodies' way through one step: where their contacts take them between two solutions of the fluid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rigidfluid.core.contacts import select
from rigidfluid.core.followed import FollowedContacts
from rigidfluid.core.interfaces import ForceLaw
from rigidfluid.core.movement import CarriedMovement, FreeMovement, Movement
from rigidfluid.core.proximity import arms, may_repel, refuse_overlap
from rigidfluid.core.rigid import lab_inertia, rotation_matrices
from rigidfluid.core.state import State
from rigidfluid.core.substep import Plan, plan, relative_motion
from rigidfluid.core.system import System
from rigidfluid.core.time_scheme import predict_pose
from rigidfluid.core.types import BoolArray, Contacts, FloatArray, Pose, Twist, Wrench
from rigidfluid.core.wrenches import contact_wrench, nothing, power
from rigidfluid.errors import StepRejected

MOST_SUBSTEPS = 100_000
"""More of them in one step are refused."""

MOST_INERT = 20.0
"""A body in a film of fluid answers to a blow as if it had at most so many times its mass."""

MOST_ALIKE = 1_000
"""After so many substeps of one length they are planned anew: what leaves a stiff contact needs ever fewer."""

ROUNDING = 1e-9
"""What is left of a step below this part of it is the rounding of sums."""


@dataclass(frozen=True, slots=True)
class BodiesPath:
    """Where the bodies are at the end of a step, and what the contacts did to them on the way.

    ``pose`` and ``twist`` at the end, ``impulse`` of the contacts [force·time | force·length·time], ``dissipated`` by
    them and ``held`` against them by what drives bodies [energy], and the number of ``substeps``.
    """

    pose: Pose
    twist: Twist
    impulse: Wrench
    dissipated: float
    held: float
    substeps: int


def follow(system: System, state: State, start: float, size: float) -> BodiesPath:
    """Follow the bodies through one step, kicked by their contacts in velocity Verlet substeps.

    Without a fluid the substeps are the whole motion. In a fluid the bodies go on with their latest acceleration,
    contacts taken out of it, and the contacts act on their masses and what is known of the added mass; the fluid then
    answers to the impulse. Where nothing can touch in the step, poses come from Adams–Bashforth 2 as one formula.

    Parameters
    ----------
    system : System
        Bodies, law, detector.
    state : State
        At the start of the step.
    start, size : float
        When it starts and how long it is [time].

    Returns
    -------
    BodiesPath
        Of all bodies.

    Raises
    ------
    StepRejected
        If bodies overlap on the way, or a contact is too stiff to be followed.
    """
    if system.backend.problem is None:
        return _follow_free(system, state, start, size)
    return _follow_carried(system, state, size)


def _follow_free(system: System, state: State, start: float, size: float) -> BodiesPath:
    movement = FreeMovement(
        state.pose,
        state.twist,
        system.mass,
        system.inertia,
        system.weight,
        system.controlled,
        lambda elapsed: system.controlled_twist(start + elapsed),
    )
    if system.law is None:
        return _coast(movement, size)
    reach, span = _horizon(system, movement, size)
    return _resolve(system, system.law, movement, _detected(system, reach), size, span)


def _follow_carried(system: System, state: State, size: float) -> BodiesPath:
    pose = predict_pose(state.pose, state.twist, state.past_twist, size, state.past_step)
    if system.law is None:
        return BodiesPath(pose, state.twist, nothing(pose), 0.0, 0.0, 1)
    movement = _carried(system, state)
    near = select(state.contacts, _may_touch(system.law.range, state.contacts, movement, size))
    if len(near) == 0:
        return BodiesPath(pose, state.twist, nothing(pose), 0.0, 0.0, 1)
    if system.detector.needs_mesh:
        return _resolve(system, system.law, movement, FollowedContacts(near, state.pose).at, size, size)
    reach, span = _horizon(system, movement, size)
    return _resolve(system, system.law, movement, _detected(system, reach), size, span)


def _horizon(system: System, movement: Movement, size: float) -> tuple[float, float]:
    """Up to which gap contacts are foreseen [length], and for how long that is enough [time]."""
    law_range = system.law.range if system.law else 0.0
    if system.substeps:
        return law_range, size
    largest = max(body.bounding_radius for body in system.bodies)
    fastest = _fastest(system, movement, size)
    ahead = min(2.0 * fastest * size, law_range + 2.0 * largest)
    return law_range + ahead, 0.5 * ahead / fastest if fastest > 0 else size


def _detected(system: System, reach: float) -> Callable[[Pose], Contacts]:
    """The contacts of any pose, as a detector finds them that needs no mesh."""

    def contacts_at(pose: Pose) -> Contacts:
        near = system.detector.detect(pose, None, reach)
        chosen = may_repel(system, near)
        return near if chosen.all() else select(near, chosen)

    return contacts_at


def _carried(system: System, state: State) -> CarriedMovement:
    """The acceleration of the latest step without that of its contacts, which now act on their own."""
    linear, angular = _mobility(system, state)
    if state.past is None:
        return CarriedMovement(state.pose, state.twist, np.zeros_like(_flat(state.twist)), linear, angular)
    wrench = state.contact_wrench
    by_contact = Twist(np.einsum("nij,nj->ni", linear, wrench.force), np.einsum("nij,nj->ni", angular, wrench.torque))
    rate = (_flat(state.twist) - _flat(state.past.twist)) / state.past.step - _flat(by_contact)
    return CarriedMovement(state.pose, state.twist, rate, linear, angular)


def _mobility(system: System, state: State) -> tuple[FloatArray, FloatArray]:
    """Inverse mass (n, d, d) and inverse inertia (n, k, k) of bodies and added mass in the lab frame."""
    orientation, eye = state.pose.orientation, np.eye(system.dimension)
    rotation = rotation_matrices(orientation)
    own = system.mass[:, None, None] * eye
    mass = own + rotation @ system.added_mass @ np.swapaxes(rotation, -1, -2)
    inertia = lab_inertia(system.inertia + system.added_inertia, orientation)
    free = ~system.controlled[:, None, None] / state.inertness[:, None, None]
    return free * np.linalg.inv(mass), free * np.linalg.inv(inertia)


def _coast(movement: FreeMovement, size: float) -> BodiesPath:
    none = nothing(movement.pose)
    movement.kick(none, 0.5 * size)
    movement.drift(size)
    return BodiesPath(movement.pose, movement.twist, none, 0.0, 0.0, 1)


def _resolve(
    system: System, law: ForceLaw, movement: Movement, contacts_at: Callable[[Pose], Contacts], size: float, span: float
) -> BodiesPath:
    """Velocity Verlet: half a kick, a drift, half a kick; the second is that of the new pose.

    Substeps are planned for a ``span`` [time] at a time, as far as contacts can be foreseen, and anew when the contacts
    are over.
    """
    contacts = contacts_at(movement.pose)
    impulse, dissipated, held, count, left = nothing(movement.pose), 0.0, 0.0, 0, size
    push = _push(system, law, contacts, movement)
    planned, coast, substep = 0.0, 0.0, 0.0
    while left > 0.0:
        if planned <= 0.0 or contacts.gap.min(initial=np.inf) > law.range:
            planned = min(left, span)
            coast, substep = _plan(system, law, contacts, movement, size, planned)
            planned = min(planned, coast + MOST_ALIKE * substep)
        part = min(coast or substep, left)
        movement.kick(push.wrench, 0.5 * part)
        movement.drift(part)
        contacts = contacts_at(movement.pose)
        _refuse_overlap(system, contacts)
        before, push = push, _push(system, law, contacts, movement)
        movement.kick(push.wrench, 0.5 * part)
        impulse = _added(_added(impulse, before.wrench, 0.5 * part), push.wrench, 0.5 * part)
        dissipated += 0.5 * part * (before.loss + push.loss)
        held += 0.5 * part * (before.held + push.held)
        count, coast, planned = count + 1, 0.0, planned - part
        left = left - part if left - part > ROUNDING * size else 0.0
        if count == MOST_SUBSTEPS and left > 0.0:
            raise _too_stiff(system, contacts, part)
    return BodiesPath(movement.pose, movement.twist, impulse, dissipated, held, count)


def _plan(system: System, law: ForceLaw, contacts: Contacts, movement: Movement, size: float, span: float) -> Plan:
    if system.substeps:
        return Plan(0.0, size / system.substeps)
    return plan(law, contacts, movement, arms(system), size, span)


class _Push(NamedTuple):
    """What the contacts do at one moment: their ``wrench``, the power that their dampers take and that hands give."""

    wrench: Wrench
    loss: float
    held: float


def _push(system: System, law: ForceLaw, contacts: Contacts, movement: Movement) -> _Push:
    if len(contacts) == 0:
        return _Push(nothing(movement.pose), 0.0, 0.0)
    force, loss = law.force(contacts), 0.0
    if law.dissipative:
        motion = relative_motion(contacts, movement)
        damping = law.damping(contacts, motion)
        force, loss = force + damping, -float(np.sum(damping * motion.velocity))
    wrench, held = contact_wrench(contacts, force, movement.pose), 0.0
    if system.controlled.any():
        held = -float(power(wrench, movement.twist)[system.controlled].sum())
    return _Push(wrench, loss, held)


def _refuse_overlap(system: System, contacts: Contacts) -> None:
    if len(contacts) == 0 or contacts.gap.min() > 0.0:
        return
    worst = int(np.argmin(contacts.gap))
    refuse_overlap(system.surfaces[contacts.body_a[worst]], float(contacts.gap[worst]))


def _too_stiff(system: System, contacts: Contacts, part: float) -> StepRejected:
    worst = int(np.argmin(contacts.gap))
    return StepRejected(
        f"body {system.surfaces[contacts.body_a[worst]]}",
        f"a contact that needs substeps of {part:.1e}",
        f"at most {MOST_SUBSTEPS} substeps in a step",
        "Soften the contact force: raise contact.epsilon, or widen contact.range.",
    )


def _may_touch(law_range: float, contacts: Contacts, movement: CarriedMovement, size: float) -> BoolArray:
    """Which contacts are in range or may come into it, at twice the speed at which their surfaces move now."""
    speed = np.linalg.norm(relative_motion(contacts, movement).velocity, axis=1)
    return np.asarray(contacts.gap <= law_range + 2.0 * size * speed)


def _fastest(system: System, movement: Movement, size: float) -> float:
    """Bound of the speed at which any surface can move in the step, contacts apart [length/time]."""
    twist = movement.twist
    turning = arms(system) * np.linalg.norm(twist.angular_velocity, axis=1)
    return float(np.max(np.linalg.norm(twist.velocity, axis=1) + turning + size * movement.pull(size)))


def _added(total: Wrench, wrench: Wrench, factor: float) -> Wrench:
    """The total with so much of a wrench added in place."""
    total.force[:] += factor * wrench.force
    total.torque[:] += factor * wrench.torque
    return total


def _flat(twist: Twist) -> FloatArray:
    return np.concatenate([twist.velocity, twist.angular_velocity], axis=1)


def answered(system: System, state: State, path: BodiesPath, twist: Twist) -> FloatArray:
    """How many times its mass and known added mass each body showed in the step, (n,) [1].

    With that ``inertness`` the path would have ended at the twist that the fluid allowed: walls add to the added mass,
    and so does a film of fluid. Learnt from blows that turn a body back; after a weaker push the fluid's own forces
    would be taken for inertia.

    Parameters
    ----------
    system : System
        Bodies and backend.
    state : State
        At the start of the step.
    path : BodiesPath
        That was followed, with the state's ``inertness``.
    twist : Twist
        At the end, with fluid and bodies solved together.

    Returns
    -------
    (n,) array
        The state's own where nothing was learnt.
    """
    if system.backend.problem is None or not path.impulse.force.any():
        return state.inertness
    linear, _ = _mobility(system, state)
    strength = np.linalg.norm(path.impulse.force, axis=1)
    direction = path.impulse.force / np.where(strength > 0.0, strength, 1.0)[:, None]
    gained = np.einsum("ni,nij,nj->n", direction, linear, path.impulse.force)
    closing = -np.sum(direction * state.twist.velocity, axis=1)
    blow = (closing > 0.0) & (gained > closing)
    excess = np.sum(direction * (path.twist.velocity - twist.velocity), axis=1)
    allowed = 1.0 - np.divide(excess, gained, out=np.zeros_like(gained), where=blow)
    return np.asarray(np.clip(state.inertness / np.maximum(allowed, 1.0 / MOST_INERT), 1.0, MOST_INERT))
