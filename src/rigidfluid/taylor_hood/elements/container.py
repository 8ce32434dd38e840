"""The frame in which convection keeps energy: that of the container."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.elements.surfaces import Surfaces

_ROUND_OFF = 1e-9
"""Relative rounding error: a container slower than this times the fastest prescribed velocity rests, since walls may
slide and turn in themselves."""


def container_velocity(surfaces: Surfaces, time: float, node_points: FloatArray) -> FloatArray:
    r"""Velocity V (d,) of the walls as one rigid container: Σ ∫ (n·(u - V))² over them is least [length/time].

    The slowest V is taken where several are least: zero for walls at rest, and without walls.

    Parameters
    ----------
    surfaces : Surfaces
        The faces and the velocities prescribed there.
    time : float
        The time [time].
    node_points : (nodes, d) array
        Coordinates of the nodes [length].
    """
    d = node_points.shape[1]
    faces = [face for face in surfaces.faces if face.condition.is_wall]
    if all(face.condition.rests for face in faces):
        return np.zeros(d)
    normals, outflow, fastest = np.zeros((d, d)), np.zeros(d), 0.0
    with surfaces.ranks.raise_on_all():
        for face in faces:
            area = face.area_vectors(node_points).reshape(-1, d)
            size = np.maximum(np.linalg.norm(area, axis=1, keepdims=True), np.finfo(float).tiny)
            normals += (area / size).T @ area
            if not face.condition.rests:
                velocity = face.condition.velocity(time, node_points[face.facet_nodes.ravel()])
                outflow += (area / size).T @ np.sum(area * velocity, axis=1)
                fastest = max(fastest, float(np.abs(velocity).max(initial=0.0)))
    whole = surfaces.ranks.sum(np.concatenate([normals.ravel(), outflow]))
    found = np.linalg.pinv(whole[: d * d].reshape(d, d), hermitian=True, rcond=_ROUND_OFF) @ whole[d * d :]
    return found if np.abs(found).max() > _ROUND_OFF * float(surfaces.ranks.greatest(fastest)) else np.zeros(d)
