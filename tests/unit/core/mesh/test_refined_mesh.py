"""A mesh of halved edges fills the same domain, on the exact surfaces, and holds what the coarse one does."""

from __future__ import annotations

import numpy as np
import pytest
from mesh_tools import ball, upright

from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.curved_edges import with_curved_edges
from rigidfluid.core.mesh.generation.refined_mesh import refined_mesh
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.stepping.refined_flow import prolonged


@pytest.fixture(scope="module", params=[2, 3])
def around_a_ball(request):
    d = request.param
    box = Box(BoxOptions(lower=(-1.0,) * d, upper=(1.0,) * d), d)
    domain = FluidDomain([ball(0.4, d)], upright([0.1, 0.0, 0.0][:d]), box, ())
    return domain, initial_mesh(domain, Sizes(0.5, 0.25))


@pytest.mark.parametrize("curved", [False, True])
def test_vertices_are_the_nodes_of_the_coarse_mesh_and_those_on_a_body_on_its_surface(around_a_ball, curved) -> None:
    domain, straight = around_a_ball
    mesh = with_curved_edges(straight, domain) if curved else straight
    fine, numbering = refined_mesh(mesh, domain), Numbering.from_mesh(mesh)
    d = mesh.points.shape[1]
    assert len(fine.points) == numbering.nodes
    assert (len(fine.cells), len(fine.facets)) == (2**d * len(mesh.cells), 2 ** (d - 1) * len(mesh.facets))
    assert (cell_volumes(fine.points, fine.cells) > 0.0).all()
    on_body = fine.points[np.unique(fine.facets[fine.markers == 0])]
    np.testing.assert_allclose(np.linalg.norm(on_body - domain.pose.position, axis=1), 0.4, rtol=1e-12)
    assert (fine.curved is not None) == curved
    if d == 2:
        inside = np.setdiff1d(np.arange(numbering.nodes), numbering.on_curves if curved else fine.facets)
        np.testing.assert_allclose(fine.points[inside], numbering.node_points(mesh.geometry)[inside], atol=1e-14)


def test_quadratic_velocities_and_linear_pressures_are_the_same_on_it(around_a_ball) -> None:
    """On straight cells; on the refined ones vertices on the body are elsewhere, but have the same numbers."""
    domain, mesh = around_a_ball
    fine = refined_mesh(mesh, domain)
    here, there = Numbering.from_mesh(mesh), Numbering.from_mesh(fine)
    points, d = here.node_points(mesh.points), mesh.points.shape[1]
    nested = there.node_points(points)

    def velocity(at):
        return np.stack([1.0 + at[:, 0] * at[:, k] - at[:, 1] ** 2 for k in range(d)], axis=1)

    state = {"velocity": velocity(points), "velocity_previous": velocity(points), "points_previous": mesh.points - 0.1}
    state |= dict.fromkeys(("pressure", "pressure_previous"), mesh.points[:, 1])
    found = prolonged(state, here, mesh, there, fine)
    np.testing.assert_allclose(found["velocity"], velocity(nested), atol=1e-13)
    np.testing.assert_allclose(found["pressure"], points[:, 1], atol=1e-14)
    np.testing.assert_allclose(found["points_previous"], fine.points - 0.1, atol=1e-14)
