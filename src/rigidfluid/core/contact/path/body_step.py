"""Result of following the bodies through one step: where they are at its end, impulse and work of contacts."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.mechanics.motions import carried_bodies
from rigidfluid.core.mechanics.time_scheme import start_pose
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.state import LinkLoad, MotionState, State, unloaded
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import TangentialSprings
from rigidfluid.core.model.types import Pose, Twist, Wrench


@dataclass(frozen=True, slots=True)
class BodyStep:
    """Result of a path: the bodies at the end of a step, and the contacts' impulse and work in it.

    ``pose`` and ``twist`` of the bodies at the end, and there the ``motions`` that carry them; ``impulse`` of the
    contacts on the bodies [force·time | force·length·time]; ``dissipated``, the energy that contacts and dampers of
    joints take, and ``actuator_work``, that of what moves prescribed bodies, walls and drives [energy]; the number of
    ``substeps``; ``link``, the mean loads of joints, zero in a fluid, whose solution has them.

    In a fluid ``friction`` is the energy that drag takes in substeps, unresolved by the fluid solves, and ``coupling``
    the one with which the bodies were followed, None where nothing can touch. Without inertia of the fluid that energy
    is known for certain: it is ``drag_loss`` then, and ``friction`` zero. ``drag_left_out``: by how much the fluid
    solves take less than their flow dissipates, as velocities turn [energy].

    ``springs``: those along the surfaces of contacts at the end, None where there are none.
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
    drag_left_out: float = 0.0
    coupling: Coupling | None = None
    drag_loss: float = 0.0
    springs: TangentialSprings | None = None


def arrived(dynamics: BodyDynamics, impulse: Wrench, dissipated: float, actuator_work: float, count: int) -> BodyStep:
    """Result where ``dynamics`` is at the end of a step, or of a part of it, after ``count`` substeps."""
    motions = dynamics.motions(impulse)
    work = dissipated, actuator_work
    return BodyStep(dynamics.pose, dynamics.twist, motions, impulse, *work, count, unloaded(motions.pose))


def first_step_again(system: System, state: State, end_twist: Twist, end: float, size: float) -> BodyStep:
    """First step of bodies that touch nothing, repeated with the mean of the motions' twists at its start and at its
    ``end`` [time], where a first solution has found ``end_twist``."""
    pose = start_pose(state.motions.pose, state.motions.twist, end_twist, size)
    return undisturbed(system, pose, end_twist, end)


def undisturbed(system: System, pose: Pose, twist: Twist, end: float) -> BodyStep:
    """Result of a step without contacts, by the motions' ``pose`` and ``twist`` at its ``end`` [time]."""
    motions = MotionState(pose, twist, nothing(pose), nothing(pose))
    body_pose, body_twist = carried_bodies(system, pose, twist, end)
    return BodyStep(body_pose, body_twist, motions, nothing(body_pose), 0.0, 0.0, 1, unloaded(pose))


def add_wrench(total: Wrench, wrench: Wrench, factor: float) -> Wrench:
    """Add ``factor`` times a wrench to the total in place, and return it."""
    total.force[:] += factor * wrench.force
    total.torque[:] += factor * wrench.torque
    return total
