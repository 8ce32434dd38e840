"""Poses of the narrowest gaps: bodies fallen along their weights onto walls and each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.model.interfaces import Detector
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FloatArray, Pose
from rigidfluid.core.setup.boundary import surfaces_of

_MOST_BODIES = 60
"""Greatest number of bodies that are followed one by one; with more, all stay where they start."""

_SLOW = "brute_force"
"""A detector that takes minutes for the gaps between shapes of facets and walls of any shape."""

_MOST_ADVANCES = 500
_TOLERANCE = 0.05
"""Relative tolerance of the gap asked for [1]."""
_ALONG = 1e-9
"""Cosine up to which a way leads along a surface and not to it."""


def settled_pose(system: System, detector: type[Detector], gap: float) -> Pose:
    """Pose with each free body moved along its weight, the foremost first, until a ``gap`` [length] is left ahead.

    Bodies without weight, of given motion, and all that mechanisms or joints hold stay where they start; so do all
    where there are very many, or only a slow detector knows their gaps. The ``detector`` needs no mesh.
    """
    pose, weight = system.pose, system.weight
    count = len(system.bodies)
    together = system.mechanisms is not None or system.linkage is not None
    if together or count > _MOST_BODIES or detector.name == _SLOW:
        return pose
    pulled = np.flatnonzero(~system.controlled & np.any(weight != 0.0, axis=1))
    down = weight[pulled] / np.linalg.norm(weight[pulled], axis=1, keepdims=True)
    foremost = np.argsort(-np.sum(down * pose.position[pulled], axis=1))
    asked = detector(detector.Options(), system.bodies, surfaces_of(system.domain, count))
    for number, direction in zip(pulled[foremost].tolist(), down[foremost], strict=True):
        pose = _fallen(asked, pose, number, direction, gap)
    return pose


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
