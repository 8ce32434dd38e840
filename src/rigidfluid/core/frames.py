"""Where a body's own frame lies in the world: x = c + R ξ, with R from the orientation of the pose."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.interfaces import Body
from rigidfluid.core.types import FloatArray, Pose


def rotation_matrix(orientation: FloatArray) -> FloatArray:
    """Rotation of one body's frame, R(θ) in 2D (counter-clockwise), R(q) = (w² - v·v) I + 2 v vᵀ + 2 w [v]× in 3D.

    Parameters
    ----------
    orientation : (q,) array
        An angle (2D) [rad] or a scalar-first unit quaternion (3D).

    Returns
    -------
    (d, d) array
        Takes the body's frame to the world's.
    """
    if len(orientation) == 1:
        cos, sin = np.cos(orientation[0]), np.sin(orientation[0])
        return np.array([[cos, -sin], [sin, cos]])
    w, x, y, z = orientation
    v = np.array([x, y, z])
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: FloatArray = (w * w - v @ v) * np.eye(3) + 2.0 * np.outer(v, v) + 2.0 * w * cross
    return rotation


def to_body_frame(pose: Pose, body: int, points: FloatArray) -> FloatArray:
    """World points in the frame of one body, ξ = Rᵀ(x - c).

    Parameters
    ----------
    pose : Pose
        Where the bodies are.
    body : int
        Number of the body.
    points : (N, d) array
        World coordinates [length].

    Returns
    -------
    (N, d) array
        Coordinates in the body's frame [length].
    """
    local: FloatArray = (points - pose.position[body]) @ rotation_matrix(pose.orientation[body])
    return local


def to_world(pose: Pose, body: int, points: FloatArray) -> FloatArray:
    """Points of one body's frame in the world, x = c + R ξ; the inverse of :func:`to_body_frame`.

    Parameters
    ----------
    pose : Pose
        Where the bodies are.
    body : int
        Number of the body.
    points : (N, d) array
        Coordinates in the body's frame [length].

    Returns
    -------
    (N, d) array
        World coordinates [length].
    """
    world: FloatArray = pose.position[body] + points @ rotation_matrix(pose.orientation[body]).T
    return world


def distance_to_body(pose: Pose, body: int, shape: Body, points: FloatArray) -> FloatArray:
    """Signed distance of world points to one body's surface, (N,), > 0 in the fluid [length]."""
    return shape.signed_distance(to_body_frame(pose, body, points))
