"""Meshes to march on, and the distances that a march must find."""

from itertools import combinations, permutations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

from rigidfluid.core.geometry.unit_sphere import unit_sphere_points
from rigidfluid.core.mesh.topology import boundary_facets
from rigidfluid.core.model.types import Mesh

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


def stars(dimension, seed):
    """A squeezed box around one to three star-shaped holes with ragged, concave edges, and what to measure from.

    Delaunay cells whose centres are in a star are left out. Vertices on surfaces are moved at random as well, but none
    so far that a cell turns over. Returns the mesh and the markers of some of its surfaces.
    """
    rng = np.random.default_rng(seed)
    points = _box_points(rng, dimension, 400)
    cells = Delaunay(points).simplices.astype(np.int64)
    middle = rng.uniform(0.25, 0.75, (rng.integers(1, 4), dimension))
    waves = rng.normal(size=(len(middle), 5, dimension)) * 4
    used, cells = np.unique(
        cells[_depth(points[cells].mean(axis=1), middle, waves).max(axis=0) < 0], return_inverse=True
    )
    points, cells = points[used], cells.reshape(-1, dimension + 1)
    facets = boundary_facets(cells)
    faces = [np.all(points[facets, k] == side, axis=1) for k in range(dimension) for side in (0.0, 1.0)]
    star = _depth(points[facets].mean(axis=1), middle, waves).argmax(axis=0)
    markers = np.where(np.any(faces, axis=0), len(middle) + np.argmax(faces, axis=0), star)
    squeeze = _rotation(rng, dimension) * 10 ** rng.uniform(-1, 0, dimension)
    chosen = rng.permutation(len(middle) + 2 * dimension)[: rng.integers(0, 3)]
    return Mesh(_jittered(rng, points, cells) @ squeeze, cells, facets, markers), [0, *chosen]


def _box_points(rng, dimension, count):
    """Random points in the unit box, as many as a third of them on its sides, and its corners."""
    inside, on_side = rng.uniform(size=(2, count, dimension))
    on_side = on_side[: count // 3]
    on_side[np.arange(len(on_side)), rng.integers(0, dimension, len(on_side))] = rng.integers(0, 2, len(on_side))
    corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * dimension), axis=-1).reshape(-1, dimension)
    return np.concatenate([inside, on_side, corners])


def _depth(points, middle, waves):
    """How far points are inside each star, (stars, points), along the ray from its middle."""
    away = points - middle[:, None]
    length = np.linalg.norm(away, axis=2)
    bumps = np.sin(np.einsum("spk,swk->spw", away / length[:, :, None], waves)).mean(axis=2)
    return 0.22 * (1 + 0.9 * bumps) - length


def _jittered(rng, points, cells):
    """Vertices moved at random; those of cells that would turn over or become flat go back."""
    before = np.linalg.det(_edges(points, cells))
    moved = points + rng.uniform(-0.03, 0.03, points.shape)
    while np.any(bad := np.linalg.det(_edges(moved, cells)) / before < 1e-3):
        moved[cells[bad]] = points[cells[bad]]
    return moved


def _edges(points, cells):
    return points[cells[:, 1:]] - points[cells[:, :1]]


def reachable(mesh, surfaces, inside):
    """Vertices that edges between vertices that are ``inside`` join to the surfaces, ascending."""
    edges = mesh.cells[:, list(combinations(range(mesh.cells.shape[1]), 2))].reshape(-1, 2)
    edges = edges[inside[edges].all(axis=1)]
    graph = coo_matrix((np.ones(len(edges)), edges.T), (len(mesh.points),) * 2)
    _, piece = connected_components(graph, directed=False)
    seeds = mesh.facets[np.isin(mesh.markers, surfaces)]
    return np.flatnonzero(inside & np.isin(piece, piece[seeds]))
