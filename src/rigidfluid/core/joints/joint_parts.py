"""Constraints and springs of joints and ground links."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.constraints import Constraint, GroundDamper, SameAxis, SameOrientation, SamePoint
from rigidfluid.core.joints.joint import PlacedJoint
from rigidfluid.core.joints.link_parts import LinkParts
from rigidfluid.core.joints.markers import MarkerPair, marker
from rigidfluid.core.joints.springs import GroundSpring, Spring
from rigidfluid.core.model.joints import GroundLink
from rigidfluid.core.model.types import Pose
from rigidfluid.errors import PluginError, SceneError


def joint_parts(joint: PlacedJoint, pose: Pose) -> LinkParts:
    """Constraints and springs of a joint between bodies whose initial poses are ``pose``; raises SceneError as they
    do, PluginError if there are none."""
    kind, markers = joint.kind, joint_markers(joint, pose)
    rows, springs = kind.constraints(f"joint {joint.name!r}", markers), kind.springs(markers)
    if not rows:
        remedy = "Mend the joint; JointContract in rigidfluid.testing shows more."
        raise PluginError(f"joint {joint.name!r}", f"no constraints by type {kind.name!r}", "one or more", remedy)
    return LinkParts(joint.name, joint.first, joint.second, rows, springs, kind.coordinate)


def joint_markers(joint: PlacedJoint, pose: Pose) -> MarkerPair:
    """Markers of a joint on its bodies, whose initial poses are ``pose``."""
    ends = [marker(body, joint.at, joint.kind.axes, pose) for body in (joint.first, joint.second)]
    return MarkerPair(*ends)


def ground_parts(link: GroundLink, pose: Pose) -> LinkParts:
    """Constraints and springs of a ground link to a body whose initial pose is in ``pose``; raises SceneError as they
    do."""
    rows, springs = ground_constraints(link, pose), ground_springs(link, pose)
    return LinkParts(link.name, link.body, None, rows, springs, coordinate=None)


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


def _ground_markers(link: GroundLink, pose: Pose, axes: FloatArray) -> MarkerPair:
    centre = pose.position[link.body]
    return MarkerPair(marker(link.body, centre, axes, pose), marker(None, centre, axes, pose))
