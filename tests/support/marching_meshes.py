"""Meshes to march on, and the distances that a march must find."""

from itertools import combinations, permutations

import numpy as np
from scipy.spatial import Delaunay

from rigidfluid.core.topology import boundary_facets
from rigidfluid.core.types import Mesh
from rigidfluid.core.unit_sphere import unit_sphere_points

INNER, OUTER = 0, 1


def shell(dimension, inner, outer, size, seed=0):
    """Vertices on concentric circles or spheres, turned at random, and the Delaunay cells between them."""
    rng = np.random.default_rng(seed)
    radii = np.linspace(inner, outer, round((outer - inner) / (0.85 * size)) + 1)
    layers = [radius * _sphere(dimension, radius / size) @ _rotation(rng, dimension) for radius in radii]
    points, count = np.concatenate(layers), len(layers[0])
    cells = Delaunay(points).simplices.astype(np.int64)
    cells = cells[np.any(cells >= count, axis=1)]
    facets = boundary_facets(cells)
    return Mesh(points, cells, facets, np.where(np.all(facets < count, axis=1), INNER, OUTER))


def box(dimension, cells, seed=None):
    """The unit box of cubes cut along their diagonals, markers as in `generate_mesh`; jittered by a seed."""
    grid = np.stack(np.meshgrid(*[np.arange(cells + 1)] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    strides = (cells + 1) ** np.arange(dimension)[::-1]
    first = grid[np.all(grid < cells, axis=1)] @ strides
    paths = [np.cumsum([0, *order]) for order in permutations(strides)]
    simplices = np.concatenate([first[:, None] + path for path in paths]).astype(np.int64)
    points = grid / cells
    if seed is not None:
        inside = np.all((points > 0.0) & (points < 1.0), axis=1)
        points[inside] += np.random.default_rng(seed).uniform(-0.15, 0.15, (inside.sum(), dimension)) / cells
    facets = boundary_facets(simplices)
    centres = points[facets].mean(axis=1)
    faces = np.stack([centres[:, k] - side for k in range(dimension) for side in (0.0, 1.0)])
    return Mesh(points, simplices, facets, np.abs(faces).argmin(axis=0))


def naive_distances(points, targets, facets):
    """Distance of each point to the nearest of all facets, by quadratic minimisation over faces of every dimension."""
    best = np.full(len(points), np.inf)
    for corners in targets[facets]:
        for count in range(1, len(corners) + 1):
            for face in combinations(corners, count):
                np.minimum(best, _to_flat(points, np.array(face)), out=best)
    return best


def _to_flat(points, corners):
    """Distance to the flat through the corners where the foot lies between them, else infinite."""
    edges = (corners[1:] - corners[0]).T
    weights = (
        np.linalg.lstsq(edges, (points - corners[0]).T, rcond=None)[0] if edges.size else np.zeros((0, len(points)))
    )
    inside = np.all(weights >= 0.0, axis=0) & (weights.sum(axis=0) <= 1.0)
    distance = np.linalg.norm(points - corners[0] - (edges @ weights).T, axis=1)
    return np.where(inside, distance, np.inf)


def _sphere(dimension, radius):
    count = 2 * np.pi * radius if dimension == 2 else 4 * np.pi * radius**2 / 0.866
    return unit_sphere_points(round(count), dimension)


def _rotation(rng, dimension):
    return np.linalg.qr(rng.normal(size=(dimension, dimension)))[0]
