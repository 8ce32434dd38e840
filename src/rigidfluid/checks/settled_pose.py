"""Poses of the narrowest gaps: bodies fallen along their weights onto walls and each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.mechanics.rigid import rotate, rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of

_MOST_BODIES = 60
"""Greatest number of bodies that are followed one by one; with more, all stay where they start."""

_SLOW = "brute_force"
"""A detector that takes minutes for the gaps between shapes of facets and walls of any shape."""

_MOST_ADVANCES = 500
_TOLERANCE = 0.05
"""Relative tolerance of the gap asked for [1]."""
_ALONG = 1e-9
"""Cosine up to which a way leads along a surface and not to it."""

_EQUAL = 1e-6
"""Semi-axes that differ by less than this part of the least are one."""


def settled_pose(system: System, detector: type[Detector], gap: float) -> Pose:
    """Pose with each free body moved along its weight, the foremost first, until a ``gap`` [length] is left ahead.

    Other bodies than balls turn their flattest side to where they fall before, if there is room for it: so they come to
    rest, and their gap is narrow over the widest area. Bodies without weight, of given motion, and all that mechanisms
    or joints hold stay where they start; so do all where there are very many, or only a slow detector knows their gaps.
    The ``detector`` needs no mesh.
    """
    pose, weight = system.pose, system.weight
    count = len(system.bodies)
    together = bool(system.motions.names) or bool(system.joints.linked.any())
    if together or count > _MOST_BODIES or detector.name == _SLOW:
        return pose
    pulled = np.flatnonzero(~system.prescribed & np.any(weight != 0.0, axis=1))
    down = weight[pulled] / np.linalg.norm(weight[pulled], axis=1, keepdims=True)
    foremost = np.argsort(-np.sum(down * pose.position[pulled], axis=1))
    asked = detector(detector.Options(), system.bodies, surfaces_of(system.domain, count))
    for number, direction in zip(pulled[foremost].tolist(), down[foremost], strict=True):
        pose = _fallen(asked, _laid(asked, pose, number, direction, gap), number, direction, gap)
    return pose


def flattest_side(body: Body, ahead: FloatArray) -> FloatArray:
    """Outward unit normal (d,) of the tangent plane nearest to the centre of mass, in the body's frame [1].

    The normal of an ellipsoid is along the least semi-axis, of several equal ones as near to ``ahead`` (d,) as can be,
    and a shape of facets has that of a facet. ``ahead`` itself stands for other shapes.
    """
    if body.semi_axes is not None:
        least = body.semi_axes <= (1.0 + _EQUAL) * body.semi_axes.min()
        side = np.where(least, ahead, 0.0)
        side = side if np.any(np.abs(side) > _EQUAL) else np.eye(len(side))[np.argmax(least)]
    elif body.facets is not None:
        normals = area_vectors(body.facets.points, body.facets.vertices)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        side = normals[np.argmin((normals @ body.facets.points.T).max(axis=1))]
    else:
        side = ahead
    return np.asarray(side / np.linalg.norm(side))


def _laid(detector: Detector, pose: Pose, body: int, direction: FloatArray, gap: float) -> Pose:
    """The pose with the flattest side of a body turned to a ``direction`` (d,), unless it is nearer to others then."""
    shape, row = detector.bodies[body], slice(body, body + 1)
    if shape.radius is not None:
        return pose
    turned = rotation_matrices(pose.orientation[row])[0]
    side = turned @ flattest_side(shape, turned.T @ direction)
    orientation = pose.orientation.copy()
    orientation[row] = rotate(orientation[row], _turn(side, direction)[None])
    laid = replace(pose, orientation=orientation)
    found = detector.detect(laid, None, gap)
    mine = (found.body_a == body) | (found.body_b == body)
    return pose if np.any(found.gap[mine] < gap) else laid


def _turn(start: FloatArray, end: FloatArray) -> FloatArray:
    """Rotation vector (k,) of the shortest turn from one unit vector (d,) to another [rad]."""
    cosine = float(start @ end)
    if len(start) == 2:
        return np.array([np.arctan2(start[0] * end[1] - start[1] * end[0], cosine)])
    axis = np.cross(start, end)
    sine = float(np.linalg.norm(axis))
    if sine <= _ALONG:  # half a turn may go about any axis across
        axis, sine = np.cross(start, np.eye(3)[np.argmin(np.abs(start))]), 0.0
    return np.asarray(axis / np.linalg.norm(axis) * np.arctan2(sine, cosine))


def _fallen(detector: Detector, pose: Pose, body: int, direction: FloatArray, gap: float) -> Pose:
    """The pose with one body moved along a ``direction`` (d,) by what is free there, its nearest gap at a time: no way
    changes a gap by more than its length."""
    reach = gap + detector.bodies[body].bounding_radius
    for _ in range(_MOST_ADVANCES):
        ahead = _gap_ahead(detector, pose, body, direction, reach)
        if ahead <= (1.0 + _TOLERANCE) * gap:
            break
        position = pose.position.copy()
        position[body] += (ahead - gap) * direction
        pose = replace(pose, position=position)
    return pose


def _gap_ahead(detector: Detector, pose: Pose, body: int, direction: FloatArray, reach: float) -> float:
    """Least gap of one body to a surface that a way along the ``direction`` leads to, at most ``reach`` [length]."""
    found = detector.detect(pose, None, reach)
    mine = (found.body_a == body) | (found.body_b == body)
    away = np.where(found.body_a == body, 1.0, -1.0) * (found.normal @ direction)
    return float(np.min(found.gap[mine & (away < -_ALONG)], initial=reach))
