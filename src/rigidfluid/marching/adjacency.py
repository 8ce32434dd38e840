"""Which cells, vertices and facets meet at a vertex, as compressed rows. Arrays in, arrays out."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def rows_of(simplices, count):
    """Simplices at each vertex: those of vertex v are ``members[start[v]:start[v + 1]]``; start (count + 1,)."""
    start = np.zeros(count + 1, np.int32)
    for simplex in range(simplices.shape[0]):
        for i in range(simplices.shape[1]):
            start[simplices[simplex, i] + 1] += 1
    for row in range(count):
        start[row + 1] += start[row]
    members = np.empty(start[count], np.int32)
    fill = start[:-1].copy()
    for simplex in range(simplices.shape[0]):
        for i in range(simplices.shape[1]):
            vertex = simplices[simplex, i]
            members[fill[vertex]] = simplex
            fill[vertex] += 1
    return start, members


@njit(cache=True, nogil=True)
def neighbours_of(cells, cell_start, cell_members):
    """Vertices that share a cell with each vertex, as `rows_of` gives them."""
    count = len(cell_start) - 1
    seen = np.full(count, -1, np.int32)
    start = np.zeros(count + 1, np.int32)
    members = np.empty(len(cell_members) * (cells.shape[1] - 1), np.int32)
    total = 0
    for vertex in range(count):
        seen[vertex] = vertex
        for k in range(cell_start[vertex], cell_start[vertex + 1]):
            for i in range(cells.shape[1]):
                other = cells[cell_members[k], i]
                if seen[other] != vertex:
                    seen[other] = vertex
                    members[total] = other
                    total += 1
        start[vertex + 1] = total
    return start, members[:total].copy()


@njit(cache=True, nogil=True)
def inner_vertices(facets, cells, cell_start, cell_members):
    """The vertex across from each boundary facet in its cell, (F,): it tells the fluid's side; -1 without a cell."""
    across = np.full(len(facets), -1, np.int32)
    for facet in range(len(facets)):
        first = facets[facet, 0]
        for k in range(cell_start[first], cell_start[first + 1]):
            cell = cells[cell_members[k]]
            shared, other = 0, -1
            for vertex in cell:
                if vertex in facets[facet]:
                    shared += 1
                else:
                    other = vertex
            if shared == facets.shape[1]:
                across[facet] = other
    return across


@njit(cache=True, nogil=True)
def facets_beside(facets, marker, start, members):
    """The facet of the same surface beyond each ridge, (F, d), -1 unless it is just one; ridge i is across corner i."""
    neighbours = np.full(facets.shape, -1, np.int32)
    for facet in range(len(facets)):
        for i in range(facets.shape[1]):
            corner, found = facets[facet, i - 1], 0  # a corner on ridge i
            for k in range(start[corner], start[corner + 1]):
                other = members[k]
                if other != facet and marker[other] == marker[facet] and _share_ridge(facets, facet, i, other):
                    neighbours[facet, i] = other
                    found += 1
            if found != 1:
                neighbours[facet, i] = -1
    return neighbours


@njit(cache=True, nogil=True)
def _share_ridge(facets, facet, i, other):
    shared = 1
    for k in range(facets.shape[1]):
        for corner in facets[other]:
            shared += k != i and corner == facets[facet, k]
    return shared == facets.shape[1]


@njit(cache=True, nogil=True)
def is_whole(neighbours, chosen):
    """Tell whether the facets ``chosen`` are one closed piece, in which each has one other beyond each ridge."""
    seen = np.zeros(len(neighbours), np.bool_)
    waiting = [chosen[0]]
    seen[chosen[0]] = True
    count = 0
    while len(waiting) > 0:
        count += 1
        for other in neighbours[waiting.pop()]:
            if other < 0:
                return False
            if not seen[other]:
                seen[other] = True
                waiting.append(other)
    return count == len(chosen)
