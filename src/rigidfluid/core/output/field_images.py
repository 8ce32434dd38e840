"""Fields continued across periodic surfaces: cells of a mesh that is cut elsewhere, in their places in the domain."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
from scipy.spatial import cKDTree

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.model.types import Fields

_SAME = 1e-6
"""Distance over the period up to which a node is the image of another [1]."""


def continued(fields: Fields, lattice: Lattice) -> Fields:
    """The images, by a ``lattice`` whose first cell is the domain, of all cells of a mesh that reach into the domain;
    the fields themselves without vectors."""
    count = len(lattice.vectors)
    if count == 0:
        return fields
    where = lattice.coordinates(fields.points)[fields.cells]
    home = -np.floor(where.mean(axis=1)).astype(np.int64)
    moves = home + np.array(list(product((0, -1, 1), repeat=count)))[:, None]
    lowest, highest = moves + where.min(axis=1), moves + where.max(axis=1)
    image, cell = np.nonzero(np.all((lowest < 1.0 - _SAME) & (highest > _SAME), axis=2))
    ways, way = np.unique(moves[image, cell], axis=0, return_inverse=True)
    kept, cells = np.unique(way.reshape(-1, 1) * len(fields.points) + fields.cells[cell], return_inverse=True)
    node, move = kept % len(fields.points), ways[kept // len(fields.points)]
    images = fields.part(node, cells.reshape(-1, fields.cells.shape[1]))
    return replace(
        images,
        points=images.points + lattice.displacement(move),
        pressure=images.pressure + move @ _jumps(fields, lattice),
    )


def _jumps(fields: Fields, lattice: Lattice) -> FloatArray:
    """Change of the pressure from a node to its image by each vector of the lattice, (k,): those nodes that have theirs
    on the mesh show it."""
    tree, found = cKDTree(fields.points), np.zeros(len(lattice.vectors))
    for way, vector in enumerate(lattice.vectors):
        near = _SAME * float(np.linalg.norm(vector))
        distance, image = map(np.asarray, tree.query(fields.points + vector, distance_upper_bound=near))
        pairs = np.flatnonzero(np.isfinite(distance))
        if len(pairs):
            found[way] = np.mean(fields.pressure[image[pairs]] - fields.pressure[pairs])
    return found
