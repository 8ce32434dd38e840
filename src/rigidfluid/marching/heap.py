"""A binary heap of vertices, smallest key on top, in which a vertex's key can fall. Arrays in, new size out.

``heap`` holds vertices, ``heap_key`` their keys beside them, ``place`` (N,) where in the heap each vertex is.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from numba import njit


@njit(cache=True, nogil=True)
def push(heap, heap_key, place, size, vertex, key):
    """Add a vertex; the new size."""
    place[vertex] = size
    heap[size] = vertex
    lower(heap, heap_key, place, vertex, key)
    return size + 1


@njit(cache=True, nogil=True)
def lower(heap, heap_key, place, vertex, key):
    """Give a vertex in the heap a smaller key."""
    at = place[vertex]
    while at > 0:
        parent = (at - 1) >> 1
        if heap_key[parent] <= key:
            break
        _put(heap, heap_key, place, at, heap[parent], heap_key[parent])
        at = parent
    _put(heap, heap_key, place, at, vertex, key)


@njit(cache=True, nogil=True)
def pop(heap, heap_key, place, size):
    """Take out the vertex on top; that vertex. The size falls by one."""
    top = heap[0]
    last = size - 1
    vertex, key = heap[last], heap_key[last]
    at = 0
    while True:
        child = 2 * at + 1
        if child >= last:
            break
        if child + 1 < last and heap_key[child + 1] < heap_key[child]:
            child += 1
        if heap_key[child] >= key:
            break
        _put(heap, heap_key, place, at, heap[child], heap_key[child])
        at = child
    _put(heap, heap_key, place, at, vertex, key)
    return top


@njit(cache=True, nogil=True)
def _put(heap, heap_key, place, at, vertex, key):
    heap[at], heap_key[at] = vertex, key
    place[vertex] = at
