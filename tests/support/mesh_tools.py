"""Small helpers of the mesh tests."""

from itertools import combinations

import numpy as np

from rigidfluid.bodies.ellipsoid import Ellipsoid
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.core.model.types import Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.domains.box import Box


def ball(radius, dimension=2):
    return Sphere(Sphere.Options(radius=radius), dimension)


def ellipsoid(*semi_axes):
    return Ellipsoid(Ellipsoid.Options(semi_axes=list(semi_axes)), len(semi_axes))


def upright(*positions):
    """Bodies at positions, not turned."""
    position = np.array(positions, dtype=float)
    turn = [0.0] if position.shape[1] == 2 else [1.0, 0.0, 0.0, 0.0]
    return Pose(position, np.tile(turn, (len(position), 1)))


def nobody(dimension):
    return Pose(np.zeros((0, dimension)), np.zeros((0, 1 if dimension == 2 else 4)))


def box(lower, upper):
    return Box(Box.Options(lower=tuple(map(float, lower)), upper=tuple(map(float, upper))), len(lower))


def box_walls(lower, upper, bodies):
    return list(surfaces_of(box(lower, upper), bodies))


def random_ellipsoids(dimension, seed):
    """Ellipsoids of all shapes and tilts in the cells of a grid, their mesh, and the walls of the box around them."""
    rng = np.random.default_rng(seed)
    cells = np.stack(np.meshgrid(*[np.arange(2 if dimension == 3 else 3)] * dimension), axis=-1).reshape(-1, dimension)
    bodies = [ellipsoid(*rng.uniform(0.15, 0.45, dimension)) for _ in cells]
    position = cells + 0.5 + rng.uniform(-0.04, 0.04, cells.shape)
    turn = rng.uniform(0, 3, (len(cells), 1)) if dimension == 2 else rng.normal(size=(len(cells), 4))
    pose = Pose(position, turn if dimension == 2 else turn / np.linalg.norm(turn, axis=1, keepdims=True))
    lower, upper = np.zeros(dimension), np.full(dimension, 1.0 + cells.max())
    size = 0.04 if dimension == 2 else 0.2
    mesh = generate_mesh(FluidDomain(bodies, pose, box(lower, upper), ()), Sizes(0.3, size, 0.5))
    return bodies, box_walls(lower, upper, len(bodies)), pose, mesh


def edges_of(simplices):
    pairs = list(combinations(range(simplices.shape[1]), 2))
    return np.unique(np.sort(np.concatenate([simplices[:, pair] for pair in pairs]), axis=1), axis=0)


def edge_lengths(points, edges):
    return np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)


def assert_valid(mesh, bodies, pose, lower, upper):
    """Positive cells closed by the marked facets, which lie on their surfaces."""
    check_mesh(mesh, quality=0.0)
    assert np.all(cell_volumes(mesh.points, mesh.cells) > 0)
    assert np.array_equal(np.unique(mesh.markers), np.arange(len(bodies) + 2 * len(lower)))
    assert np.array_equal(np.unique(mesh.cells), np.arange(len(mesh.points)))
    for i, body in enumerate(bodies):
        points = mesh.points[np.unique(mesh.facets[mesh.markers == i])]
        assert np.abs(distance_to_body(pose, i, body, points)).max() < 1e-9
    for face in range(2 * len(lower)):
        coordinates = mesh.points[mesh.facets[mesh.markers == len(bodies) + face], face // 2]
        assert np.all(coordinates == (lower, upper)[face % 2][face // 2])


def body_facets(mesh, bodies):
    """Facets of the bodies as sets of exact coordinates with their marker."""
    kept = mesh.markers < bodies
    return {
        (int(marker), frozenset(map(tuple, mesh.points[facet].tolist())))
        for facet, marker in zip(mesh.facets[kept], mesh.markers[kept], strict=True)
    }
