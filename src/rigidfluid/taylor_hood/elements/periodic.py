"""Nodes on periodic faces: those of one face of a pair are images of those of the other, and have no unknowns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry import images
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.taylor_hood.elements.face import Face


def originals(faces: Sequence[Face], node_points: FloatArray) -> tuple[IntArray, IntArray]:
    """Node that each node is an image of, (nodes,), and by how many periods of each of k pairs, (nodes, k); itself and
    by none, if it is none.

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
    by_surface = {face.condition.surface: face for face in faces}
    pairs = [(face.nodes, by_surface[face.condition.image].nodes) for face in faces if face.condition.image is not None]
    ways = [node_points[second].mean(axis=0) - node_points[first].mean(axis=0) for first, second in pairs]
    return images.originals(node_points, pairs, np.array(ways).reshape(-1, node_points.shape[1]))
