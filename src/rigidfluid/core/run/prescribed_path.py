"""Poses at the end of a path that are evaluated, not integrated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose


def with_prescribed(system: System, path: BodyStep, end: float) -> BodyStep:
    """The path with poses at its ``end`` [time] evaluated, not integrated: of prescribed motions, and of all bodies;
    and with joints that fit."""
    motions, prescribed = path.motions.pose, system.motions.prescribed[:, None]
    if prescribed.any():
        pose = system.prescribed_pose(end)
        position = np.where(prescribed, pose.position, motions.position)
        motions = Pose(position, np.where(prescribed, pose.orientation, motions.orientation))
    motions = system.joints.closed(motions, end)
    bodies = system.motions.poses(motions, end)
    if motions is path.motions.pose and bodies is path.pose:
        return path
    return replace(path, pose=bodies, motions=replace(path.motions, pose=motions))
