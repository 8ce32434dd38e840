"""Constraints and springs of joints and ground links."""

from __future__ import annotations

from math import remainder, tau

import numpy as np

from rigidfluid.core.joints.constraints import (
    Constraint,
    DrivenAngle,
    GroundDamper,
    HingeDamper,
    SameAxis,
    SameOrientation,
    SamePoint,
)
from rigidfluid.core.joints.link_parts import LinkParts
from rigidfluid.core.joints.markers import MarkerPair, axes_about, marker
from rigidfluid.core.joints.springs import GroundSpring, HingeSpring, Spring
from rigidfluid.core.model.linkage import GroundLink, Joint
from rigidfluid.core.model.types import FloatArray, Pose
from rigidfluid.errors import SceneError

_ROUNDING = 1e-9


def joint_parts(joint: Joint, pose: Pose) -> LinkParts:
    """Constraints and springs of a joint between bodies whose initial poses are ``pose``; raises SceneError as they
    do."""
    rows, springs = joint_constraints(joint, pose), joint_springs(joint, pose)
    return LinkParts(joint.name, joint.first, joint.second, rows, springs, joint.type == "hinge")


def ground_parts(link: GroundLink, pose: Pose) -> LinkParts:
    """Constraints and springs of a ground link to a body whose initial pose is in ``pose``; raises SceneError as they
    do."""
    rows, springs = ground_constraints(link, pose), ground_springs(link, pose)
    return LinkParts(link.name, link.body, None, rows, springs, has_angle=False)


def joint_constraints(joint: Joint, pose: Pose) -> list[Constraint]:
    """Constraints of a joint between bodies whose initial poses are ``pose``; raises SceneError if its drive does not
    start at the angle zero."""
    markers, name = _joint_markers(joint, pose), f"joint {joint.name!r}"
    d = len(joint.at)
    parts: list[Constraint] = [SamePoint(name, markers, np.eye(d))]
    if joint.type == "rod":
        return [*parts, SameOrientation(name, markers)]
    if d == 3:
        parts.append(SameAxis(name, markers))
    if joint.drive is not None:
        _refuse_offset(name, joint.drive(0.0)[0])
        parts.append(DrivenAngle(name, markers, joint.drive))
    if joint.damping > 0.0:
        parts.append(HingeDamper(name, markers, joint.damping))
    return parts


def joint_springs(joint: Joint, pose: Pose) -> list[Spring]:
    """Spring of a joint's hinge, if there is one."""
    if joint.stiffness == 0.0:
        return []
    return [HingeSpring(_joint_markers(joint, pose), joint.stiffness, joint.rest_angle)]


def ground_constraints(link: GroundLink, pose: Pose) -> list[Constraint]:
    """Held directions and dampers of a ground link to a body whose initial pose is in ``pose``; raises SceneError if
    one rotation of three is held, which leaves no path to fit to."""
    name, d = f"body {link.name!r}", pose.position.shape[1]
    straight, turning = link.held[:d], link.held[d:]
    markers, parts = _ground_markers(link, pose, np.eye(d)), list[Constraint]()
    if straight.any():
        parts.append(SamePoint(name, markers, np.eye(d)[straight]))
    if turning.all():
        parts.append(SameOrientation(name, markers))
    elif turning.sum() == 2:
        free = int(np.argmin(turning))
        about_free = np.roll(np.eye(3), -free - 1, axis=1)
        parts.append(SameAxis(name, _ground_markers(link, pose, about_free)))
    elif turning.any():
        found, allowed = "one rotation of three that is held", "none, two or all three"
        raise SceneError(name, found, allowed, "Hold two rotations and leave one free, or hold none.")
    damped = (link.damping > 0.0) & ~link.held
    if damped.any():
        parts.append(GroundDamper(name, markers, np.eye(len(link.held))[damped], link.damping[damped]))
    return parts


def ground_springs(link: GroundLink, pose: Pose) -> list[Spring]:
    """Springs of a ground link on the directions that are not held; ``pose`` has the body's initial pose."""
    stiffness = np.where(link.held, 0.0, link.stiffness)
    if not stiffness.any():
        return []
    rest = pose.position[link.body] if link.rest is None else link.rest
    return [GroundSpring(link.body, stiffness, rest, pose.orientation[link.body])]


def _joint_markers(joint: Joint, pose: Pose) -> MarkerPair:
    axes = np.eye(len(joint.at)) if joint.axis is None else axes_about(joint.axis)
    return MarkerPair(marker(joint.first, joint.at, axes, pose), marker(joint.second, joint.at, axes, pose))


def _ground_markers(link: GroundLink, pose: Pose, axes: FloatArray) -> MarkerPair:
    centre = pose.position[link.body]
    return MarkerPair(marker(link.body, centre, axes, pose), marker(None, centre, axes, pose))


def _refuse_offset(name: str, angle: float) -> None:
    if abs(remainder(angle, tau)) > _ROUNDING:
        found, allowed = f"a drive that starts at the angle {angle:g}", "0, since the bodies are placed at the start"
        raise SceneError(name, found, allowed, "Let the drive start at 0, or turn the body by its angle.")
