"""The march that carries the nearest facet along, so that each distance is exact. Arrays in, arrays out."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from numba import njit

from rigidfluid.marching.heap import lower, pop, push
from rigidfluid.marching.walk import try_around, walk_to_vertex
from rigidfluid.marching.workspace import FAR, KNOWN, TRIAL


@njit(cache=True, nogil=True)
def seed(surfaces, seeds, work):
    """Give the vertices of the facets ``seeds`` distance zero and put them into the heap; how many there are."""
    size = 0
    for facet in seeds:
        for i in range(surfaces.facets.shape[1]):
            vertex = surfaces.facets[facet, i]
            if work.state[vertex] == FAR:
                work.state[vertex], work.key[vertex], work.facet[vertex] = TRIAL, 0.0, facet
                work.touched[size] = vertex
                size = push(work.heap, work.heap_key, work.place, size, vertex, 0.0)
    return size


@njit(cache=True, nogil=True)
def march(points, neighbours, surfaces, wanted, limit, work, size, touched):
    """Spread the nearest facet from the ``size`` vertices in the heap; how many vertices are touched now.

    A vertex taken from the heap hands its facet to its neighbours, which walk on from there to a nearer one. A vertex
    that is KNOWN and yet gets a nearer facet goes back into the heap. Squared distances above ``limit`` are left FAR.
    """
    while size > 0:
        vertex = pop(work.heap, work.heap_key, work.place, size)
        size -= 1
        work.state[vertex] = KNOWN
        if work.concave[work.facet[vertex]] and work.key[vertex] > 0.0:
            square, facet = try_around(points, vertex, surfaces, wanted, work.key[vertex], work.facet[vertex])
            work.key[vertex], work.facet[vertex] = square, facet
        facet = work.facet[vertex]
        for k in range(neighbours.start[vertex], neighbours.start[vertex + 1]):
            other = neighbours.members[k]
            state = work.state[other]
            if state != FAR and (work.facet[other] == facet or work.key[other] == 0.0):
                continue
            square, nearest = walk_to_vertex(points, other, surfaces, wanted, facet)
            if square > limit or (state != FAR and square >= work.key[other]):
                continue
            work.key[other], work.facet[other] = square, nearest
            if state == TRIAL:
                lower(work.heap, work.heap_key, work.place, other, square)
                continue
            if state == FAR:
                work.touched[touched] = other
                touched += 1
            work.state[other] = TRIAL
            size = push(work.heap, work.heap_key, work.place, size, other, square)
    return touched


@njit(cache=True, nogil=True)
def accept(vertices, key, facet, limit, work, touched):
    """Put into the empty heap the vertices that others know to be nearer; its size, and how many are touched now."""
    size = 0
    for k in range(len(vertices)):
        vertex, state = vertices[k], work.state[vertices[k]]
        if key[k] > limit or (state != FAR and key[k] >= work.key[vertex]):
            continue
        if state == FAR:
            work.touched[touched] = vertex
            touched += 1
        work.state[vertex], work.key[vertex], work.facet[vertex] = TRIAL, key[k], facet[k]
        size = push(work.heap, work.heap_key, work.place, size, vertex, key[k])
    return size, touched


@njit(cache=True, nogil=True)
def reset(work, touched):
    """Make all touched vertices FAR again."""
    for k in range(touched):
        work.state[work.touched[k]] = FAR
