"""Vertices in the fluid that give way to bad cells."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
from scipy.spatial import Delaunay

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.generation.curved_cells import CurvedCells
from rigidfluid.core.mesh.generation.smooth_fluid import GOOD_QUALITY, smooth_fluid
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.topology import boundary_facets, orient, share_no_cell
from rigidfluid.core.model.types import CurvedEdges, Mesh


def delaunay(points: FloatArray) -> Mesh:
    """Their convex hull; all of its facets on one surface."""
    cells = Delaunay(points).simplices.astype(np.int64)
    facets = boundary_facets(cells)
    return orient(Mesh(points, cells, facets, np.zeros(len(facets), dtype=np.int64)))


def around_a_vertex(height: float) -> Mesh:
    """An octahedron of edges √2 and one vertex in it, nearer to its upper facets the higher it is."""
    return delaunay(np.concatenate([np.eye(3), -np.eye(3), [[0.0, 0.0, height]]]))


def worst(mesh: Mesh) -> float:
    cells = CurvedCells(mesh)
    return float(min(cell_quality(mesh.points, mesh.cells).min(), cells.quality(mesh.geometry).min(initial=1.0)))


def test_a_vertex_leaves_the_facet_that_it_is_close_to() -> None:
    given = around_a_vertex(0.9)
    assert worst(given) < 0.6 * GOOD_QUALITY
    made = smooth_fluid(given)
    assert worst(made) > GOOD_QUALITY
    np.testing.assert_array_equal(made.points[:-1], given.points[:-1])
    assert given.points[-1, 2] == 0.9


def test_a_vertex_gives_way_to_edges_that_bend_towards_it() -> None:
    """Straight cells are good where it is; it stays there without the bent edges."""
    straight = around_a_vertex(0.2)
    np.testing.assert_array_equal(smooth_fluid(straight).points, straight.points)
    upper = np.array([[a, 2] for a in (0, 1, 3, 4)])
    middles = 0.8 * straight.points[np.sort(upper, axis=1)].mean(axis=1)
    bent = replace(straight, curved=CurvedEdges(np.sort(upper, axis=1), np.zeros(4, dtype=np.int64), middles))
    assert worst(bent) < GOOD_QUALITY
    made = smooth_fluid(bent)
    assert worst(made) > GOOD_QUALITY
    assert made.curved is not None
    np.testing.assert_array_equal(made.curved.middles, middles)


def test_no_cell_gets_worse_than_the_worst_before() -> None:
    """In a cube of random vertices, full of slivers."""
    points = np.random.default_rng(3).random((30, 3))
    given = delaunay(np.concatenate([np.array(list(product((0.0, 1.0), repeat=3))), points]))
    made = smooth_fluid(given)
    before, after = (cell_quality(mesh.points, mesh.cells) for mesh in (given, made))
    assert after.min() > 0.1 > 5.0 * before.min()


def test_vertices_of_one_cell_do_not_move_at_a_time() -> None:
    cells = np.array([[0, 1, 2, 3], [3, 4, 5, 6], [6, 7, 8, 9]])
    assert share_no_cell(cells, np.array([2, 3, 1, 6, 9, 4]), 10).tolist() == [True, False, False, False, False, False]
    assert share_no_cell(cells, np.array([2, 4, 9]), 10).tolist() == [True, True, True]
