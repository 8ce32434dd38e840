"""The wave that carries the nearest facet along, so that each distance is exact. Arrays in, arrays out.

A vertex starts from the nearest facet of a neighbour and walks over the surface. On a convex body that ends on the
nearest facet of all; on any other surface a tree of all facets is asked as well. So no vertex needs a second visit, and
the wave takes the vertices in the order in which it meets them, without a heap.

The trees of facets are those of `rigidfluid.core.geometry.facet_tree`.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from typing import NamedTuple

from numba import njit

from rigidfluid.core.geometry.facet_tree import build_tree, empty_tree, search_to_vertex
from rigidfluid.marching.band import square_in_band
from rigidfluid.marching.convex import is_convex
from rigidfluid.marching.topology import Target
from rigidfluid.marching.walk import local_search_to_vertex
from rigidfluid.marching.workspace import BEYOND, FAR, KNOWN


class Front(NamedTuple):
    """How far a march has come: it goes on from ``work.visited[first:touched]``, and has found so many ``beyond``."""

    first: int
    touched: int
    beyond: int


@njit(cache=True, nogil=True)
def seed(points, surfaces, seeds, work):
    """Give the vertices of the ``seeds``' facets distance zero; return their number and the target, with a tree if one
    is needed."""
    touched = 0
    for facet in seeds.facets:
        for vertex in surfaces.facets[facet]:
            if work.state[vertex] == FAR:
                work.state[vertex], work.key[vertex], work.facet[vertex] = KNOWN, 0.0, facet
                work.visited[touched] = vertex
                touched += 1
    convex = seeds.whole and is_convex(points, surfaces, seeds.facets)
    tree = empty_tree(surfaces.facets) if convex else build_tree(points, surfaces.facets, seeds.facets)
    return touched, Target(points, surfaces, seeds.wanted, tree)


@njit(cache=True, nogil=True)
def march(neighbours, target, band, work, front):
    """Spread the nearest facet from a `Front`; return numbers of vertices touched and beyond.

    Vertices outside the band are marked BEYOND, so that each is measured once, and listed at the end of
    ``work.visited``.
    """
    # names of their own spare the counting of references at each use
    state, key, nearest_facet, queue = work.state, work.key, work.facet, work.visited
    start, members = neighbours.start, neighbours.members
    points, surfaces, wanted, tree = target
    first, touched, beyond = front
    while first < touched:
        vertex = queue[first]
        facet = nearest_facet[vertex]
        first += 1
        for k in range(start[vertex], start[vertex + 1]):
            other = members[k]
            if state[other] != FAR:
                continue
            square, nearest = local_search_to_vertex(points, other, surfaces, wanted, facet)
            square, nearest = search_to_vertex(points, other, tree, square, nearest)
            if square_in_band(points, neighbours, other, square, band):
                state[other], key[other], nearest_facet[other] = KNOWN, square, nearest
                queue[touched] = other
                touched += 1
            else:
                beyond += 1
                state[other] = BEYOND
                queue[-beyond] = other
    return touched, beyond


@njit(cache=True, nogil=True)
def accept(vertices, key, facet, work, touched):
    """Take in the vertices that others have reached; return the number of vertices touched now."""
    for k in range(len(vertices)):
        vertex = vertices[k]
        if work.state[vertex] == FAR and facet[k] >= 0:
            work.state[vertex], work.key[vertex], work.facet[vertex] = KNOWN, key[k], facet[k]
            work.visited[touched] = vertex
            touched += 1
    return touched


@njit(cache=True, nogil=True)
def measure(target, work, touched):
    """Put the exact squared distance in place of any other key that the touched vertices have."""
    points, surfaces, wanted, tree = target
    for vertex in work.visited[:touched]:
        square, facet = local_search_to_vertex(points, vertex, surfaces, wanted, work.facet[vertex])
        square, facet = search_to_vertex(points, vertex, tree, square, facet)
        work.key[vertex], work.facet[vertex] = square, facet


@njit(cache=True, nogil=True)
def reset(work, touched, beyond):
    """Make all vertices FAR again."""
    for k in range(touched):
        work.state[work.visited[k]] = FAR
    for k in range(1, beyond + 1):
        work.state[work.visited[-k]] = FAR


@njit(cache=True, nogil=True)
def put_aside(work, touched, beyond):
    """Return the vertices, keys, facets and vertices beyond of a march, and free the workspace for another one."""
    vertices, outside = work.visited[:touched].copy(), work.visited[len(work.visited) - beyond :].copy()
    key, facet = work.key[vertices], work.facet[vertices]
    reset(work, touched, beyond)
    return vertices, key, facet, outside


@njit(cache=True, nogil=True)
def put_back(work, vertices, key, facet, outside):
    """Leave the workspace as it was before `put_aside`."""
    work.visited[: len(vertices)] = vertices
    for k in range(len(vertices)):
        vertex = vertices[k]
        work.state[vertex], work.key[vertex], work.facet[vertex] = KNOWN, key[k], facet[k]
    work.visited[len(work.visited) - len(outside) :] = outside
    for vertex in outside:
        work.state[vertex] = BEYOND
