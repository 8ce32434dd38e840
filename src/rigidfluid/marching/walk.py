"""Steps from facet to facet of a surface until none near by is nearer. Arrays in, numbers out.

On the surface of a convex body, seen from outside, the facet where such a walk ends is the nearest of all; elsewhere
it is the nearest of its surroundings. Where the nearest point is inside a facet it is nearest in its surroundings; where
it is on an edge or a corner, the other facets there are tried.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from numba import njit

from rigidfluid.marching.simplices import facet_to_facet, vertex_to_facet


@njit(cache=True, nogil=True)
def walk_to_vertex(points, vertex, surfaces, wanted, facet):
    """Squared distance of a vertex to the surfaces ``wanted`` near ``facet``, and the facet it is found on."""
    square, bits, _, _, _ = vertex_to_facet(points, vertex, surfaces.facets, facet)
    inside = (1 << points.shape[1]) - 1
    while bits != inside:
        at, shared = facet, bits
        corner = _first_corner(surfaces.facets, at, shared)
        for k in range(surfaces.start[corner], surfaces.start[corner + 1]):
            other = surfaces.members[k]
            if _goes_on(surfaces, wanted, at, shared, other):
                new_square, new_bits, _, _, _ = vertex_to_facet(points, vertex, surfaces.facets, other)
                if new_square < square:
                    square, bits, facet = new_square, new_bits, other
        if facet == at:
            break
    return square, facet


@njit(cache=True, nogil=True)
def walk_to_facet(points, target, surfaces, wanted, facet):
    """Squared distance of the facet ``target`` to the surfaces ``wanted`` near ``facet``, and where it is found."""
    square, bits = _facet_to_facet(points, surfaces.facets, target, facet)
    inside = (1 << points.shape[1]) - 1
    while bits != inside:
        at, shared = facet, bits
        corner = _first_corner(surfaces.facets, at, shared)
        for k in range(surfaces.start[corner], surfaces.start[corner + 1]):
            other = surfaces.members[k]
            if _goes_on(surfaces, wanted, at, shared, other):
                new_square, new_bits = _facet_to_facet(points, surfaces.facets, target, other)
                if new_square < square:
                    square, bits, facet = new_square, new_bits, other
        if facet == at:
            break
    return square, facet


@njit(cache=True, nogil=True)
def _facet_to_facet(points, facets, target, facet):
    """Squared distance of two facets, and bits of the corners of the second that carry weight."""
    square, _, _, _, p, q, r = facet_to_facet(points, facets, target, facet)
    return square, (p > 0.0) | (q > 0.0) << 1 | (r > 0.0) << 2


@njit(cache=True, nogil=True)
def _first_corner(facets, facet, bits):
    return facets[facet, 0 if bits & 1 else (1 if bits & 2 else 2)]


@njit(cache=True, nogil=True)
def _goes_on(surfaces, wanted, facet, bits, other):
    """Whether ``other`` is wanted and holds all corners of ``facet`` that ``bits`` name."""
    if other == facet or not wanted[surfaces.marker[other]]:
        return False
    for i in range(surfaces.facets.shape[1]):
        if bits >> i & 1:
            found = False
            for j in range(surfaces.facets.shape[1]):
                found |= surfaces.facets[other, j] == surfaces.facets[facet, i]
            if not found:
                return False
    return True
