"""Way of the bodies through one step, and what contacts gave them on it."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.mechanics.motions import carried_bodies
from rigidfluid.core.mechanics.time_scheme import start_pose
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.state import LinkLoad, MotionState, State, unloaded
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist, Wrench


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


def arrived(
    movement: BodyDynamics, impulse: Wrench, dissipated: float, actuator_work: float, count: int, friction: float = 0.0
) -> BodyStep:
    """Result at the end of a step, or of a part of it."""
    end = movement.pose, movement.twist, movement.motions(impulse), impulse
    return BodyStep(*end, dissipated, actuator_work, count, unloaded(end[2].pose), friction)


def first_step_again(system: System, state: State, end_twist: Twist, end: float, size: float) -> BodyStep:
    """First step of bodies that touch nothing, repeated with the mean of the motions' twists at its start and its
    ``end`` [time]."""
    pose = start_pose(state.motions.pose, state.motions.twist, end_twist, size)
    return undisturbed(system, pose, end_twist, end)


def undisturbed(system: System, pose: Pose, twist: Twist, end: float) -> BodyStep:
    """Result of a step of the motions alone, without contacts."""
    motions = MotionState(pose, twist, nothing(pose), nothing(pose))
    bodies = carried_bodies(system, pose, twist, end)
    return BodyStep(*bodies, motions, nothing(bodies[0]), 0.0, 0.0, 1, unloaded(pose))


def add_wrench(total: Wrench, wrench: Wrench, factor: float) -> Wrench:
    """Add ``factor`` times a wrench to the total in place, and return it."""
    total.force[:] += factor * wrench.force
    total.torque[:] += factor * wrench.torque
    return total
