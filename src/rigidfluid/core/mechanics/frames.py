"""Transformations between a body's own frame and the world: x = c + R ξ, R from the pose's orientation."""

from __future__ import annotations

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Pose


def to_body_frame(pose: Pose, body: int, points: FloatArray) -> FloatArray:
    """Coordinates ξ = Rᵀ(x - c) in the frame of one body (N, d), of world points (N, d) [length]."""
    local: FloatArray = (points - pose.position[body]) @ rotation_matrices(pose.orientation[body : body + 1])[0]
    return local


def to_world(pose: Pose, body: int, points: FloatArray) -> FloatArray:
    """World coordinates x = c + R ξ (N, d), of points (N, d) in one body's frame; the inverse of :func:`to_body_frame`
    [length]."""
    world: FloatArray = pose.position[body] + points @ rotation_matrices(pose.orientation[body : body + 1])[0].T
    return world


def distance_to_body(pose: Pose, body: int, shape: Body, points: FloatArray) -> FloatArray:
    """Signed distance of world points to one body's surface, (N,), > 0 in the fluid [length]."""
    if shape.radius is not None:  # a ball's does not depend on how it has turned
        return shape.signed_distance(points - pose.position[body])
    return shape.signed_distance(to_body_frame(pose, body, points))
