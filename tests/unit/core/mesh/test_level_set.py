"""The first mesh by MMG's cuts along a level set."""

import numpy as np
import pytest
from dish import dish, rim
from mesh_tools import ball, ellipsoid, nobody, upright

from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.adaptation import level_set
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.level_set import level_set_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.inserter import Inserter
from rigidfluid.core.mesh.generation.surface_mesh import surface_mesh
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.errors import MeshError


def in_a_dish(dimension, number=2):
    bodies = [ball(0.2, dimension), ellipsoid(0.25, 0.1) if dimension == 2 else ball(0.15, 3)][:number]
    pose = upright(*np.array([[0.45, 0.4, 0.1], [-0.4, -0.2, 0.0]])[:number, :dimension])
    sizes = Sizes(0.25, 0.05) if dimension == 2 else Sizes(0.4, 0.15, 0.5)
    return FluidDomain(bodies, pose, dish(1.0, dimension), [rim(number, dimension=dimension)]), sizes


@pytest.mark.long
@pytest.mark.parametrize("dimension", [2, 3])
def test_cut_vertices_are_on_the_shapes_and_the_walls_facets_stay(dimension):
    around, sizes = in_a_dish(dimension)
    bodies, pose, domain = around.bodies, around.pose, around.domain
    mesh = level_set_mesh(around, sizes, timeout=60.0)
    check_mesh(mesh, quality=0.1)
    assert np.unique(mesh.markers).tolist() == [0, 1, 2]
    for i, body in enumerate(bodies):
        on_body = mesh.points[np.unique(mesh.facets[mesh.markers == i])]
        assert np.abs(distance_to_body(pose, i, body, on_body)).max() < 1e-14
    given = surface_mesh(around, sizes)
    rims = [set(map(tuple, m.points[np.unique(m.facets[m.markers == 2])].tolist())) for m in (mesh, given)]
    assert rims[0] == rims[1]
    expected = domain.volume - sum(body.volume for body in bodies)
    assert np.sum(cell_volumes(mesh.points, mesh.cells)) == pytest.approx(expected, rel=0.05)


def test_a_surface_may_have_the_number_that_mmg_takes_for_cuts():
    """MMG marks the facets of a cut with 10, which is surface 9."""
    positions = 0.6 * np.stack([np.cos(angles := 0.7 * np.arange(9)), np.sin(angles)], axis=1)
    bodies = [ball(0.1)] * 9
    mesh = level_set_mesh(FluidDomain(bodies, upright(*positions), dish(), [rim(9)]), Sizes(0.2, 0.05), timeout=60.0)
    assert np.unique(mesh.markers).tolist() == list(range(10))
    on_rim = mesh.points[np.unique(mesh.facets[mesh.markers == 9])]
    np.testing.assert_allclose(np.linalg.norm(on_rim, axis=1), 1.0, atol=1e-14)


def test_it_is_graded_like_every_mesh():
    mesh = initial_mesh(*in_a_dish(2), Inserter("level_set"))
    assert cell_quality(mesh.points, mesh.cells).min() > 0.3


def test_no_body_makes_no_cut():
    mesh = level_set_mesh(FluidDomain([], nobody(2), dish(), []), Sizes(0.25, 0.05), timeout=60.0)
    assert np.unique(mesh.markers).tolist() == [0]


def test_vertices_that_do_not_come_onto_their_shape_are_refused(monkeypatch):
    monkeypatch.setattr(level_set, "ROUNDS", 1)
    monkeypatch.setattr(level_set, "_move_within_quality", lambda mesh, _: mesh.points)
    with pytest.raises(MeshError, match=r"body.[01]: found vertices up to .* off the shape"):
        level_set_mesh(*in_a_dish(2), timeout=60.0)


def test_vertices_stop_where_they_would_invert_a_cell():
    mesh = level_set_mesh(FluidDomain([], nobody(2), dish(), []), Sizes(0.5, 0.05), timeout=60.0)
    target = mesh.points.copy()
    target[0] += 5.0
    moved = level_set._move_within_quality(mesh, target)
    assert cell_quality(moved, mesh.cells).min() >= min(0.1, cell_quality(mesh.points, mesh.cells).min())
    assert not np.array_equal(moved[0], target[0])
