"""Simplices that halved edges cut a simplex into: an edge into two, a triangle into four, a tetrahedron into eight."""

from __future__ import annotations

EDGES = {1: ((0, 1),), 2: ((0, 1), (1, 2), (0, 2)), 3: ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))}
"""Edges of a simplex as pairs of its vertices, in the order of the nodes of VTK's quadratic cells."""

CHILDREN = {
    1: ((0, 2), (2, 1)),
    2: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    3: ((0, 4, 6, 7), (4, 1, 5, 8), (6, 5, 2, 9), (7, 8, 9, 3), (4, 6, 7, 8), (4, 6, 5, 8), (6, 7, 8, 9), (6, 5, 8, 9)),
}
"""Nodes of a simplex, its vertices and then its edges' middles, that are the vertices of each simplex in it (Bey 1995,
doi:10.1007/BF02238487)."""
