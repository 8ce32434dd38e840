"""Points are found in the cells that hold them."""

from types import SimpleNamespace

import numpy as np
from falling import falling_disk

from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.geometry.quadratic_cells import quadratic_basis
from rigidfluid.core.mesh.generation.inside import inside_mesh
from rigidfluid.core.mesh.location import CellFinder, locate
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.taylor_hood.elements.location import locate_on_curves, located
from rigidfluid.taylor_hood.elements.numbering import EDGES, Numbering


def test_points_are_found_in_a_graded_mesh():
    mesh = Simulation(falling_disk(mesh={"size": 0.4, "size_body": 0.02}), None, False).state.mesh
    targets = np.random.default_rng(0).uniform((0.0, 0.0), (2.0, 6.0), (500, 2))
    targets = targets[np.hypot(*(targets - (1.0, 4.0)).T) > 0.125]
    cell, coordinates = locate(mesh.points, mesh.cells, targets)
    np.testing.assert_allclose(np.einsum("ni,nid->nd", coordinates, mesh.points[mesh.cells[cell]]), targets, atol=1e-9)


def test_a_point_outside_gets_values_of_the_nearest_cell():
    mesh = Simulation(falling_disk(mesh={"size": 0.4, "size_body": 0.05}), None, False).state.mesh
    _, coordinates = locate(mesh.points, mesh.cells, np.array([[1.0, 4.0], [2.1, 3.0]]))
    assert np.all(coordinates >= 0.0)
    np.testing.assert_allclose(coordinates.sum(axis=1), 1.0)


def test_images_of_points_are_found_any_period_away():
    mesh = Simulation(falling_disk(mesh={"size": 0.4, "size_body": 0.02}), None, False).state.mesh
    ways, random = np.array([[2.0, 0.0], [0.0, 6.0]]), np.random.default_rng(0)
    held = random.dirichlet(np.ones(3), len(mesh.cells))
    periods = random.integers(-2, 3, (len(held), 2))
    targets = np.einsum("ni,nid->nd", held, mesh.points[mesh.cells]) - periods @ ways
    beside = np.array([[1.0, 4.0], [3.0, 4.0]])  # in the disk, so that its image is nearest: many cells are tried
    ahead = CellFinder(mesh.points, mesh.cells).periods_ahead(np.concatenate([targets, beside]), ways)
    np.testing.assert_array_equal(ahead, [*periods, [0, 0], [-1, 0]])


def test_points_just_beside_all_cells_are_looked_for_in_few():
    """Points on a ball are outside of all its straight cells; the many beyond the nearest hold none of them."""
    mesh, asked = inside_mesh(Sphere(Sphere.Options(radius=0.4), 3), Sizes(0.13, 0.13), 60.0), []
    targets = np.random.default_rng(0).normal(size=(200, 3))
    targets *= 0.4 / np.linalg.norm(targets, axis=1, keepdims=True)
    finder = CellFinder(mesh.points, mesh.cells, beside=-0.3)
    tree = finder._centres

    def query(points, k):
        asked.append(k)
        return tree.query(points, k=k)

    finder._centres = SimpleNamespace(query=query)
    cells, coordinates = finder.find(targets)
    all_cells, all_coordinates = CellFinder(mesh.points, mesh.cells).find(targets)
    assert len(mesh.cells) > 100
    assert max(asked) == 64
    np.testing.assert_array_equal(cells, all_cells)
    np.testing.assert_array_equal(coordinates, all_coordinates)


def test_points_in_a_cell_that_is_much_bent_stay_there():
    """Its map is inverted slowly, and the neighbour's reaches a little beyond their common edge."""
    edges = np.array(EDGES[2])
    corners = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0.0, 0.0], [0.0, 1.0], [-1.0, 1.0]]])
    middles = corners[:, edges].mean(axis=2)
    middles[0, np.flatnonzero((edges == [1, 2]).all(axis=1))] -= 0.17
    nodes = np.concatenate([corners, middles], axis=1)
    wanted = np.array([[0.02, 0.1, 0.88], [0.05, 0.2, 0.75], [0.1, 0.05, 0.85]])
    cell, coordinates = locate_on_curves(nodes, np.zeros(3, dtype=int), quadratic_basis(wanted) @ nodes[0])
    np.testing.assert_array_equal(cell, 0)
    np.testing.assert_allclose(coordinates, wanted, atol=1e-4)


def test_points_on_a_ball_are_found_in_the_curved_cells_beside_them():
    """In cells farther away the quadratic map seems to reach them, where its coordinates do not sum to 1."""
    mesh = inside_mesh(Sphere(Sphere.Options(radius=0.4), 3), Sizes(0.18, 0.18), 60.0)
    numbering = Numbering.from_mesh(mesh)
    targets = np.random.default_rng(0).normal(size=(500, 3))
    targets *= 0.4 / np.linalg.norm(targets, axis=1, keepdims=True)
    cell, coordinates = located(CellFinder(mesh.points, mesh.cells), numbering, mesh.geometry, targets)
    nodes = numbering.node_points(mesh.geometry)[numbering.cell_nodes[cell]]
    found = np.einsum("nb,nbd->nd", quadratic_basis(coordinates), nodes)
    np.testing.assert_allclose(found, targets, atol=1e-3)
