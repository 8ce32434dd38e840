"""Nodes of a mesh in parts are those of the whole."""

import numpy as np
import pytest
from marching_meshes import box
from threaded_ranks import on_ranks

from rigidfluid.core.mesh.distribution import distributed
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering


def places(mesh):
    """Places of all nodes, and of those on the boundary, as sets."""
    numbering = Numbering(mesh.cells, len(mesh.points))
    points = numbering.node_points(mesh.points)
    return set(map(tuple, points)), set(map(tuple, points[numbering.surface_nodes(mesh, mesh.facets)]))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_part_knows_all_nodes_on_a_surface_and_no_others(dimension):
    """In the corners of the box edges cross the fluid from one vertex of the boundary to another."""
    made = box(dimension, 3, seed=0)
    mesh = Mesh(made.points, made.cells, made.facets, np.zeros_like(made.markers))
    _, surface = places(mesh)
    parts = on_ranks(9, lambda ranks: places(distributed(mesh if ranks.is_root else None, ranks)))
    for nodes, found in parts:
        assert found == surface & nodes
