"""Points that move with their bodies; those on walls stay."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray


def body_arms(body: IntArray, point: FloatArray, position: FloatArray, turned_back: FloatArray) -> FloatArray:
    """Arms Rᵀ(x - X) (m, d) of points x (m, d) of bodies at ``position`` X (n, d), with Rᵀ (n, d, d) of each; of walls
    the points themselves [length]."""
    arm, on_body = point.copy(), body < len(position)
    index = body[on_body]
    arm[on_body] = np.einsum("nij,nj->ni", turned_back[index], point[on_body] - position[index])
    return arm


def placed_points(body: IntArray, arm: FloatArray, position: FloatArray, rotation: FloatArray) -> FloatArray:
    """Points X + R a (m, d) with the arms a (m, d) of `body_arms`, where bodies are at ``position`` X (n, d), with R
    (n, d, d) of each [length]."""
    point, on_body = arm.copy(), body < len(position)
    index = body[on_body]
    point[on_body] = position[index] + np.einsum("nij,nj->ni", rotation[index], arm[on_body])
    return point
