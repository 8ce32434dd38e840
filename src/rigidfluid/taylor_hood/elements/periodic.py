"""Nodes on periodic faces: those of one face of a pair are images of those of the other, and have no unknowns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.errors import MeshError
from rigidfluid.taylor_hood.elements.face import Face

_APART = 1e-9
"""A node and its image may be so much nearer or farther than the faces, over the size of the domain."""


def originals(faces: Sequence[Face], node_points: FloatArray) -> IntArray:
    """Node that each node is an image of, (nodes,); itself if it is none.

    Parameters
    ----------
    faces : sequence of Face
        All faces; of a periodic pair the first has the other as its ``image``.
    node_points : (nodes, d) array
        Coordinates of the nodes [length].

    Raises
    ------
    MeshError
        If the facets of a pair do not match.
    """
    found = np.arange(len(node_points))
    by_surface = {face.condition.surface: face for face in faces}
    for face in faces:
        if face.condition.image is None:
            continue
        images, normal = by_surface[face.condition.image].nodes, face.condition.normal
        assert normal is not None
        way = normal * float((node_points[images[0]] - node_points[face.nodes[0]]) @ normal)
        distance, place = scipy.spatial.cKDTree(node_points[face.nodes] + way).query(node_points[images])
        if len(images) != len(face.nodes) or np.max(distance) > _APART * np.ptp(node_points, axis=0).max():
            name = f"surfaces {face.condition.name!r} and {by_surface[face.condition.image].condition.name!r}"
            message = f"{len(face.nodes)} and {len(images)} nodes, up to {np.max(distance):.3g} apart"
            raise MeshError(name, message, "the same facets on both", "Let the mesh be made for periodic surfaces.")
        found[images] = face.nodes[place]
    while np.any(found[found] != found):  # where pairs meet, an image has an image
        found = found[found]
    return found
