"""A mesh between two concentric circles or spheres, made in seconds."""

from __future__ import annotations

from math import pi

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.unit_sphere import unit_sphere_points
from rigidfluid.core.mesh.topology import boundary_facets
from rigidfluid.core.model.types import Mesh

INNER, OUTER = 0, 1
"""Markers of the two surfaces."""

LAYER = 0.85
"""Distance of two layers over that of two vertices in a layer."""


def shell(dimension: int, inner: float, outer: float, size: float) -> Mesh:
    """Build the Delaunay mesh of {x : inner < |x| < outer}, vertices on concentric layers ``size`` [length] apart.

    In 3D it keeps Delaunay's flat cells, so that bad cells are measured too.
    """
    from scipy.spatial import Delaunay

    rng = np.random.default_rng(0)
    radii = np.linspace(inner, outer, round((outer - inner) / (LAYER * size)) + 1)
    layers = [_layer(dimension, float(radius), size, rng) for radius in radii]
    points, count = np.concatenate(layers), len(layers[0])
    cells = Delaunay(points).simplices.astype(np.int64)
    cells = cells[np.any(cells >= count, axis=1)]
    facets = boundary_facets(cells)
    return Mesh(points, cells, facets, np.where(np.all(facets < count, axis=1), INNER, OUTER))


def _layer(dimension: int, radius: float, size: float, rng: np.random.Generator) -> FloatArray:
    """Evenly spread vertices, turned at random against the other layers; triangles of size² √3/4 on a sphere."""
    count = 2 * pi * radius / size if dimension == 2 else 4 * pi * (radius / size) ** 2 * 2 / 3**0.5
    rotation, _ = np.linalg.qr(rng.normal(size=(dimension, dimension)))
    turned: FloatArray = radius * unit_sphere_points(round(count), dimension) @ rotation
    return turned
