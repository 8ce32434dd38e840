"""Projections along velocities without divergence against those by a step's own solver; and the matrices they need."""

from types import SimpleNamespace

import numpy as np
import pytest
from falling import falling_disk
from scenes import wet_tables
from scipy import sparse
from throat import SLIPPERY, throat

from rigidfluid.backends.scikit_fem import kernels
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.mesh.topology import boundary_facets, distinct_edges
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver import projection as module
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.coupled_projection import CoupledProjection

BALL = wet_tables(
    {"type": "sphere", "radius": 0.4, "density": 1.5, "position": [1.0, 1.1, 1.0], "velocity": [1.0, 0.5, 0.0]},
    end=0.1,
    step=0.02,
    domain={"lower": [0.0, 0.0, 0.0], "upper": [2.0, 2.0, 2.0]},
    boundary=[{"on": "left", "type": "periodic", "pressure_drop": 3.0}, {"on": "right", "type": "periodic"}],
    mesh={"size": 0.8, "size_body": 0.3},
    output={"every": 0.02},
)
COARSE = {"time": {"step": 0.004, "end": 0.016}, "mesh": {"size": 0.3, "size_body": 0.05}, "output": {"every": 0.008}}
SCENES = {
    "closed": lambda: falling_disk(body={"angular_velocity": 30.0, "velocity": [0.0, -4.0]}, **COARSE),
    "open, and slip along curves": lambda: throat(SLIPPERY),
    "periodic, 3D": lambda: scene_from_dict(BALL),
}


@pytest.fixture(scope="module", params=SCENES.values(), ids=SCENES.keys())
def given(request):
    """A discretisation, its geometry and pose, and a velocity with divergence."""
    simulation = Simulation(request.param(), None, False)
    state = simulation.step()
    target = simulation.system.backend._projecting_discretisation(state.mesh).inner
    noise = np.random.default_rng(0).normal(size=state.fluid["velocity"].shape)
    return target, state.mesh.geometry, state.fluid["position"], state.fluid["velocity"] + 0.1 * noise


def test_the_nearest_velocity_is_that_of_a_step_of_masses(given):
    target, points, position, velocity = given
    projection, coupled = target.projection(points, position), CoupledProjection(target, points, position)
    found = projection.nearest(velocity, 1e-12, velocity)
    expected = coupled.nearest(velocity, 1e-12, velocity)
    assert np.abs(found - velocity).max() > 1e-2
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())
    assert projection.product(found, velocity) == pytest.approx(coupled.product(found, velocity))


@pytest.mark.parametrize("tolerance", [1e-1, 1e-9])
def test_divergence_is_round_off_whatever_the_tolerance(given, tolerance):
    target, points, position, velocity = given
    projection = target.projection(points, position)
    found = projection.nearest(velocity, tolerance, np.zeros_like(velocity))
    divergence = projection._whole_divergence
    terms = np.abs(divergence) @ np.abs(found).ravel()
    assert np.abs(divergence @ found.ravel()).max() < 1e-14 * terms.max()


def test_a_gradient_much_larger_than_the_flow_is_taken_out_to_round_off(given):
    """Single precision with too few refinements left so much of it that small residuals were never reached."""
    target, points, position, velocity = given
    at = target.numbering.node_points(points)
    steep = velocity + 2e2 * (at - at.mean(axis=0))
    found = target.projection(points, position).nearest(steep, 1e-11, velocity, velocity)
    assert np.isfinite(found).all()


def test_a_solution_is_refined_to_round_off_and_not_on_beyond_it(given):
    target, points, position, velocity = given
    projection = target.projection(points, position)
    factors, solved = projection._factors, []

    def counted(divergence):
        solved.append(divergence)
        return factors.solve(divergence)

    projection._factors = SimpleNamespace(solve=counted)
    divergence = projection._whole_divergence @ velocity.ravel()
    left = divergence - projection._divergence @ (projection._force(divergence, refined=True) / projection._diagonal)
    assert np.linalg.norm(left) < 2e-13 * np.linalg.norm(divergence)
    assert 2 <= len(solved) <= 4


def test_a_projection_that_does_not_converge_rejects_the_step(given, monkeypatch):
    monkeypatch.setattr(module, "_MOST", 2)
    target, points, position, velocity = given
    with pytest.raises(StepRejected, match=r"does not converge to 1\.0e-09 in 2 iterations"):
        target.projection(points, position).nearest(velocity, 1e-9, velocity)


def test_masses_and_divergence_are_those_of_the_whole_matrix(given):
    target, points, *_ = given
    assembly, d = target._assembly, target.numbering.dimension
    still, none = np.zeros((target.numbering.nodes, d)), np.zeros(len(target.numbering.cells))
    whole, velocities = assembly.matrix(points, Coefficients(1.0, 0.0, still, still, none)), still.size
    masses = assembly.masses(points)
    for found, expected in (
        (masses.mass, whole[:velocities:d, :velocities:d]),
        (masses.divergence, whole[velocities:, :velocities]),
    ):
        assert abs(found - expected).max() < 1e-14 * abs(expected).max()


def test_neighbours_are_found_as_by_a_sparse_product(given):
    numbering = given[0].numbering
    nodes, width = numbering.cell_nodes, numbering.cell_nodes.shape[1]
    indptr, indices, ranks = kernels.neighbours(nodes, numbering.nodes)
    rows, columns = np.repeat(nodes, width, axis=1).ravel(), np.tile(nodes, (1, width)).ravel()
    pattern = sparse.coo_array((np.ones(len(rows)), (rows, columns)), shape=(numbering.nodes,) * 2).tocsr()
    np.testing.assert_array_equal(indptr, pattern.indptr)
    np.testing.assert_array_equal(indices, pattern.sorted_indices().indices)
    np.testing.assert_array_equal(
        indices[indptr[nodes][:, :, None] + ranks], np.broadcast_to(nodes[:, None], ranks.shape)
    )


def test_facets_and_edges_are_found_as_by_sorting_rows(given):
    cells = given[0].numbering.cells
    corners, last = np.sort(cells, axis=1), cells.shape[1] - 1
    sides = [np.delete(corners, corner, axis=1) for corner in range(last + 1)]
    facets, count = np.unique(np.concatenate(sides), axis=0, return_counts=True)
    np.testing.assert_array_equal(boundary_facets(cells), facets[count == 1])
    pairs = [corners[:, [a, b]] for a in range(last + 1) for b in range(a + 1, last + 1)]
    np.testing.assert_array_equal(distinct_edges(cells), np.unique(np.concatenate(pairs), axis=0))
