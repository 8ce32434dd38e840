"""A state in parts is that of the whole, to the last bit."""

import numpy as np
import pytest
from marching_meshes import stars

from rigidfluid.core.mesh.distribution import partition, parts_of
from rigidfluid.core.model.types import CurvedEdges, Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.pieces import cut, joined


def bent(mesh, rng):
    """Some of its edges are curved."""
    edges = rng.permutation(Numbering.from_mesh(mesh).edges)[:12]
    middles = mesh.points[edges].mean(axis=1) + 0.01
    curves = CurvedEdges(edges, np.zeros(len(edges), dtype=np.int64), middles)
    return Mesh(mesh.points, mesh.cells, mesh.facets, mesh.markers, curved=curves)


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("dimension", [2, 3])
def test_parts_of_a_state_make_it_again(dimension, count):
    rng = np.random.default_rng(0)
    mesh = bent(stars(dimension, 3)[0], rng)
    nodes = Numbering.from_mesh(mesh).nodes
    sizes = {"velocity": (nodes, dimension), "pressure": (len(mesh.points),), "twist": (2, 3), "position": (2, 2)}
    state = {name + age: rng.normal(size=size) for name, size in sizes.items() for age in ("", "_previous")}
    state["points_previous"] = mesh.geometry + 0.01 * rng.normal(size=mesh.geometry.shape)
    parts = parts_of(mesh, partition(mesh, count))
    again = joined(cut(state, mesh, parts), parts, mesh)
    assert again.keys() == state.keys()
    for name, values in state.items():
        np.testing.assert_array_equal(again[name], values, err_msg=name)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_part_has_the_values_of_its_points(dimension):
    mesh = bent(stars(dimension, 3)[0], np.random.default_rng(0))
    points = Numbering.from_mesh(mesh).node_points(mesh.geometry)
    fields = dict.fromkeys(("velocity", "velocity_previous"), points)
    heights = dict.fromkeys(("pressure", "pressure_previous"), mesh.points[:, 1])
    parts = parts_of(mesh, partition(mesh, 3))
    for part, state in zip(
        parts, cut({**fields, **heights, "points_previous": mesh.geometry}, mesh, parts), strict=True
    ):
        np.testing.assert_array_equal(state["velocity"], Numbering.from_mesh(part).node_points(part.geometry))
        np.testing.assert_array_equal(state["pressure"], part.points[:, 1])
        np.testing.assert_array_equal(state["points_previous"], part.geometry)
