"""The march of the paper: the eikonal equation |∇u| = 1 with u linear on each cell. Arrays in, arrays out.

From k known corners of a cell at e_i = x_i - x with values u_i, the value t at x obeys (t - u)ᵀ Q (t - u) = 1 with
Q = (e_i·e_j)⁻¹, and counts where the wave comes from inside the face, Q (t - u) ≥ 0. Every face of the known corners is
tried down to the single corner, so that an obtuse or flat cell falls back on its edges.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from rigidfluid.marching.band import in_band
from rigidfluid.marching.heap import lower, pop, push
from rigidfluid.marching.workspace import KNOWN, TRIAL

FLAT = 1e-12
"""A face whose Gram determinant is below this fraction of its edges' squares is left to its own faces."""


@njit(cache=True, nogil=True)
def march_first_order(points, adjacency, band, work, touched):
    """Spread the distance from the first ``touched`` vertices of ``work.visited``; return how many are touched then.

    Each vertex also gets the facet of the corner that its wave comes from. Vertices outside the band are left FAR.
    """
    cells, cell_rows, neighbours = adjacency
    size = 0
    for k in range(touched):
        size = push(work.heap, size, work.visited[k], work.key[work.visited[k]])
    while size > 0:
        vertex = pop(work.heap, size)
        size -= 1
        work.state[vertex] = KNOWN
        for k in range(cell_rows.start[vertex], cell_rows.start[vertex + 1]):
            cell = cells[cell_rows.members[k]]
            for other in cell:
                state = work.state[other]
                if state == KNOWN:
                    continue
                value = _least_value(points, cell, other, vertex, work)
                is_nearer = state != TRIAL or value < work.key[other]
                if not is_nearer or not in_band(points, neighbours, other, value, band):
                    continue
                work.key[other], work.facet[other] = value, work.facet[vertex]
                if state == TRIAL:
                    lower(work.heap, other, value)
                else:
                    work.visited[touched] = other
                    touched += 1
                    work.state[other] = TRIAL
                    size = push(work.heap, size, other, value)
    return touched


@njit(cache=True, nogil=True)
def _least_value(points, cell, other, vertex, work):
    """The least value at ``other`` by any face of known corners with ``vertex``, which has just become known."""
    best = work.key[vertex] + sqrt(_dot(points, other, vertex, vertex))
    for i in range(len(cell)):
        second = cell[i]
        if second == vertex or work.state[second] != KNOWN:
            continue
        best = min(best, from_edge(points, other, vertex, second, work.key))
        for j in range(i):
            third = cell[j]
            if third != vertex and work.state[third] == KNOWN:
                best = min(best, from_triangle(points, other, vertex, second, third, work.key))
    return best


@njit(cache=True, nogil=True)
def from_edge(points, x, a, b, value):
    """Value at vertex ``x`` of the plane wave through vertices ``a`` and ``b``, infinite unless it comes from between
    them."""
    aa, bb, ab = _dot(points, x, a, a), _dot(points, x, b, b), _dot(points, x, a, b)
    det = aa * bb - ab * ab
    if det <= FLAT * aa * bb:
        return np.inf
    rise = value[b] - value[a]
    # t counts from the value at a, so that no large numbers cancel
    t = _larger_root((aa + bb - 2.0 * ab) / det, (aa - ab) * rise / det, aa * rise * rise / det - 1.0)
    if t < 0.0 or bb * t - ab * (t - rise) < 0.0 or aa * (t - rise) - ab * t < 0.0:
        return np.inf
    return value[a] + t


@njit(cache=True, nogil=True)
def from_triangle(points, x, a, b, c, value):
    """Value at vertex ``x`` of the plane wave through three vertices, infinite unless it comes from between them."""
    aa, bb, cc = _dot(points, x, a, a), _dot(points, x, b, b), _dot(points, x, c, c)
    ab, ac, bc = _dot(points, x, a, b), _dot(points, x, a, c), _dot(points, x, b, c)
    # the adjugate of the Gram matrix
    q_aa, q_bb, q_cc = bb * cc - bc * bc, aa * cc - ac * ac, aa * bb - ab * ab
    q_ab, q_ac, q_bc = ac * bc - ab * cc, ab * bc - ac * bb, ab * ac - aa * bc
    det = aa * q_aa + ab * q_ab + ac * q_ac
    if det <= FLAT * aa * bb * cc:
        return np.inf
    rise_b, rise_c = value[b] - value[a], value[c] - value[a]
    # det times the sums 1ᵀ Q 1, 1ᵀ Q r and rᵀ Q r over the rises r = u - u_a
    ones = q_aa + q_bb + q_cc + 2.0 * (q_ab + q_ac + q_bc)
    mixed = (q_ab + q_bb + q_bc) * rise_b + (q_ac + q_bc + q_cc) * rise_c
    squares = q_bb * rise_b * rise_b + 2.0 * q_bc * rise_b * rise_c + q_cc * rise_c * rise_c
    t = _larger_root(ones / det, mixed / det, squares / det - 1.0)
    from_b, from_c = t - rise_b, t - rise_c
    if (
        t < 0.0
        or q_aa * t + q_ab * from_b + q_ac * from_c < 0.0
        or q_ab * t + q_bb * from_b + q_bc * from_c < 0.0
        or q_ac * t + q_bc * from_b + q_cc * from_c < 0.0
    ):
        return np.inf
    return value[a] + t


@njit(cache=True, nogil=True)
def _larger_root(a, b, c):
    """Larger root t of a t² - 2 b t + c = 0, -1 where there is none."""
    discriminant = b * b - a * c
    return -1.0 if discriminant < 0.0 else (b + sqrt(discriminant)) / a


@njit(cache=True, nogil=True)
def _dot(points, x, a, b):
    """(x_a - x)·(x_b - x)."""
    total = 0.0
    for k in range(points.shape[1]):
        total += (points[a, k] - points[x, k]) * (points[b, k] - points[x, k])
    return total
