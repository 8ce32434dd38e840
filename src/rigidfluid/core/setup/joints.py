"""A scene's joints, held directions and springs become a linkage of its motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.joints.joint import PlacedJoint
from rigidfluid.core.joints.linkage import JointLinkage
from rigidfluid.core.model.joints import GroundLink, NoJoints
from rigidfluid.core.scene.scene import SpringTable
from rigidfluid.core.setup.joint_checks import held_directions
from rigidfluid.core.setup.joint_kinds import joint_kinds
from rigidfluid.core.setup.quick_strokes import refuse_quick_drive
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.joints.joint import Joint
    from rigidfluid.core.model.joints import Joints
    from rigidfluid.core.model.motions import Motions
    from rigidfluid.core.model.types import FloatArray, IntArray, Pose
    from rigidfluid.core.scene.scene import BodyTable, JointTable, Scene

LONGEST_TURN = 0.5
"""Greatest product of a spring's frequency and the step [1]: Verlet's scheme then errs by a hundredth of the frequency.
The rate at which a spring relaxes in a fluid without inertia counts as its frequency: half of what is still stable."""


def build_joints(
    scene: Scene,
    pose: Pose,
    motions: Motions,
    controlled_twist: Callable[[float], FloatArray],
    resistance: FloatArray | None,
) -> Joints:
    """Joints and ground links between the motions of a scene at the start.

    ``pose`` is the bodies', ``controlled_twist`` the prescribed twists (N, d+k) of the N motions by time;
    ``resistance`` (n, d+k) is a lower bound of that of a fluid
    without inertia [force·time/length | force·length·time]. Raises SceneError if joints hold what is held already,
    nothing can move in one, or a spring is too stiff for the step.
    """
    ground = [_ground_link(body, number, scene.dimension) for number, body in enumerate(scene.body) if _is_held(body)]
    if not scene.joint and not ground:
        return NoJoints(len(motions.mass))
    joints = joints_of(scene, pose)
    linkage = JointLinkage(pose, joints, ground, motions, controlled_twist, resistance)
    _check_step(scene, linkage)
    return linkage


def joints_of(scene: Scene, pose: Pose) -> list[PlacedJoint]:
    """The joints of a scene, with the components of mechanisms among its bodies, that are at ``pose`` at the start."""
    return [_placed(scene, table, kind, pose) for table, kind in zip(scene.joint, joint_kinds(scene), strict=True)]


def joined_bodies(scene: Scene) -> IntArray:
    """Numbers of the two bodies of each joint that is not with the ground (p, 2)."""
    names = [body.name for body in scene.body]
    pairs = [sorted(map(names.index, joint.between)) for joint in scene.joint if len(joint.between) == 2]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _is_held(body: BodyTable) -> bool:
    return body.free is not None or body.spring is not None


def _ground_link(body: BodyTable, number: int, dimension: int) -> GroundLink:
    spring = body.spring or SpringTable()
    return GroundLink(
        name=body.name,
        body=number,
        held=held_directions(body, dimension),
        stiffness=_join_directions(dimension, spring.stiffness, spring.angular_stiffness),
        damping=_join_directions(dimension, spring.damping, spring.angular_damping),
        rest=None if spring.rest is None else np.array(spring.rest),
    )


def _join_directions(dimension: int, straight: Sequence[float] | None, turning: Sequence[float] | None) -> FloatArray:
    """Values of all directions (d+k,), zero where none are given."""
    k = 1 if dimension == 2 else 3
    return np.array([*(straight or [0.0] * dimension), *(turning or [0.0] * k)])


def _placed(scene: Scene, table: JointTable, kind: Joint, pose: Pose) -> PlacedJoint:
    names = [body.name for body in scene.body]
    first, *second = map(names.index, table.between)
    if kind.drive is not None:
        refuse_quick_drive(kind.drive, table.name, scene.time)
    point = pose.position[first].copy() if table.at is None else np.array(table.at)
    return PlacedJoint(table.name, kind, first, second[0] if second else None, point)


def _check_step(scene: Scene, linkage: JointLinkage) -> None:
    turn = linkage.frequency * scene.time.step
    if turn > LONGEST_TURN:
        found = f"{scene.time.step:g}, in which the stiffest spring turns by {turn:.3g} rad"
        allowed = f"at most {LONGEST_TURN / linkage.frequency:.3g}, {LONGEST_TURN:g} rad"
        raise SceneError("time.step", found, allowed, "Shorten it, or soften the spring.")
