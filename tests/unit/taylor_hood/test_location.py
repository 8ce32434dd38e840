"""Points are found in the cells that hold them."""

import numpy as np
from falling import falling_disk

from rigidfluid.core.mesh.location import locate
from rigidfluid.core.run.simulation import Simulation


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
