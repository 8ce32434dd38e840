"""A model's joints, held directions and springs become a linkage of its motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.joints.joint import PlacedJoint
from rigidfluid.core.joints.linkage import JointLinkage
from rigidfluid.core.model.joints import GroundLink, NoJoints
from rigidfluid.core.scene.joint_tables import SpringTable
from rigidfluid.core.setup.pair_forces import pair_springs
from rigidfluid.core.setup.quick_strokes import refuse_quick_drive
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.geometry.arrays import FloatArray, IntArray
    from rigidfluid.core.model.joints import Joints
    from rigidfluid.core.model.motions import Motions
    from rigidfluid.core.model.types import Pose
    from rigidfluid.core.setup.model import Model
    from rigidfluid.core.setup.rigid_body import JoinedBodies, RigidBody

LONGEST_TURN = 0.5
"""Greatest product of a spring's frequency and the step [1]: Verlet's scheme then errs by a hundredth of the frequency.
The rate at which a spring relaxes in a fluid without inertia counts as its frequency: half of what is still stable."""


def build_joints(
    model: Model,
    pose: Pose,
    motions: Motions,
    prescribed_twist: Callable[[float], FloatArray],
    resistance: FloatArray | None,
) -> Joints:
    """Joints, ground links and long-range forces between the motions of a model at the start.

    ``pose`` is the bodies', ``prescribed_twist`` the prescribed twists (N, d+k) of the N motions by time;
    ``resistance`` (n, d+k) is a lower bound of that of a fluid
    without inertia [force·time/length | force·length·time]. Raises SceneError if joints hold what is held already,
    nothing can move in one, or a spring is too stiff for the step.
    """
    ground = [_ground_link(body, number) for number, body in enumerate(model.bodies) if body.linked_to_ground]
    forces = pair_springs(model)
    if not (model.joints or ground or forces):
        return NoJoints(len(motions.mass))
    joints = placed_joints(model, pose)
    for joint in joints:
        if joint.kind.drive is not None:
            refuse_quick_drive(joint.kind.drive, joint.name, model.time)
    linkage = JointLinkage(pose, joints, ground, motions, prescribed_twist, resistance, forces)
    _check_step(model.time.step, linkage)
    return linkage


def placed_joints(model: Model, pose: Pose) -> list[PlacedJoint]:
    """Joints of a model, whose bodies are at ``pose`` at the start."""
    names = [body.name for body in model.all_bodies]
    return [_placed(joint, names, pose) for joint in model.joints]


def joined_bodies(model: Model) -> IntArray:
    """Numbers of the two bodies of each joint that is not with the ground (p, 2)."""
    names = [body.name for body in model.all_bodies]
    pairs = [sorted(map(names.index, joint.between)) for joint in model.joints if len(joint.between) == 2]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _ground_link(body: RigidBody, number: int) -> GroundLink:
    spring, dimension = body.spring or SpringTable(), body.shape.dimension
    return GroundLink(
        name=body.name,
        body=number,
        held=body.held_directions,
        stiffness=_join_directions(dimension, spring.stiffness, spring.angular_stiffness),
        damping=_join_directions(dimension, spring.damping, spring.angular_damping),
        rest=None if spring.rest is None else np.array(spring.rest),
    )


def _join_directions(dimension: int, straight: Sequence[float] | None, turning: Sequence[float] | None) -> FloatArray:
    """Values of all directions (d+k,), zero where none are given."""
    k = 1 if dimension == 2 else 3
    return np.array([*(straight or [0.0] * dimension), *(turning or [0.0] * k)])


def _placed(joint: JoinedBodies, names: Sequence[str], pose: Pose) -> PlacedJoint:
    first, *second = map(names.index, joint.between)
    point = pose.position[first].copy() if joint.at is None else np.array(joint.at)
    return PlacedJoint(joint.name, joint.kind, first, second[0] if second else None, point)


def _check_step(step: float, linkage: JointLinkage) -> None:
    turn = linkage.frequency * step
    if turn > LONGEST_TURN:
        found = f"{step:g}, in which the stiffest spring turns by {turn:.3g} rad"
        allowed = f"at most {LONGEST_TURN / linkage.frequency:.3g}, {LONGEST_TURN:g} rad"
        raise SceneError("time.step", found, allowed, "Shorten it, or weaken the spring or long-range force.")
