"""Where a body's own frame lies in the world: x = c + R ξ, R from the pose's orientation."""

from __future__ import annotations

from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import FloatArray, Pose


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
    local: FloatArray = (points - pose.position[body]) @ rotation_matrices(pose.orientation[body : body + 1])[0]
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
    world: FloatArray = pose.position[body] + points @ rotation_matrices(pose.orientation[body : body + 1])[0].T
    return world


def distance_to_body(pose: Pose, body: int, shape: Body, points: FloatArray) -> FloatArray:
    """Signed distance of world points to one body's surface, (N,), > 0 in the fluid [length]."""
    return shape.signed_distance(to_body_frame(pose, body, points))
