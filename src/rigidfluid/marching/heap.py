"""A binary heap of vertices, smallest key on top, in which a vertex's key can fall. Arrays in, new size out."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray


class Heap(NamedTuple):
    """``vertices`` in the heap, their ``keys``, and the ``place`` (N,) in the heap of each vertex."""

    vertices: NDArray[np.int32]
    keys: FloatArray
    place: NDArray[np.int32]


@njit(cache=True, nogil=True)
def push(heap, size, vertex, key):
    """Add a vertex; return the new size."""
    heap.place[vertex] = size
    heap.vertices[size] = vertex
    lower(heap, vertex, key)
    return size + 1


@njit(cache=True, nogil=True)
def lower(heap, vertex, key):
    """Give a vertex in the heap a smaller key."""
    at = heap.place[vertex]
    while at > 0:
        parent = (at - 1) >> 1
        if heap.keys[parent] <= key:
            break
        _put(heap, at, heap.vertices[parent], heap.keys[parent])
        at = parent
    _put(heap, at, vertex, key)


@njit(cache=True, nogil=True)
def pop(heap, size):
    """Take out the vertex on top and return it; the size falls by one."""
    top = heap.vertices[0]
    last = size - 1
    vertex, key = heap.vertices[last], heap.keys[last]
    at = 0
    while True:
        child = 2 * at + 1
        if child >= last:
            break
        if child + 1 < last and heap.keys[child + 1] < heap.keys[child]:
            child += 1
        if heap.keys[child] >= key:
            break
        _put(heap, at, heap.vertices[child], heap.keys[child])
        at = child
    _put(heap, at, vertex, key)
    return top


@njit(cache=True, nogil=True)
def _put(heap, at, vertex, key):
    heap.vertices[at], heap.keys[at], heap.place[vertex] = vertex, key, at
