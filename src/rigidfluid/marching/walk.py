"""Steps from facet to facet of a surface until none near by is nearer. Arrays in, numbers out.

On the surface of a convex body, seen from outside, the facet where such a walk ends is the nearest of all; elsewhere
it is the nearest of its surroundings. A nearest point inside a facet is the end; from one on an edge or a corner the
other facets there are tried.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from numba import njit

from rigidfluid.core.geometry.simplices import facet_to_facet, vertex_to_facet


@njit(cache=True, nogil=True, forceinline=True)
def local_search_to_vertex(points, vertex, surfaces, wanted, facet):
    """Squared distance of a vertex to the surfaces ``wanted`` near ``facet``, and the facet it is found on."""
    facets, marker, start, members = surfaces.facets, surfaces.marker, surfaces.start, surfaces.members
    square, bits, _, _, _ = vertex_to_facet(points, vertex, facets, facet)
    inside = (1 << points.shape[1]) - 1
    while bits != inside:
        at, shared = facet, bits
        corner = _first_corner(facets, at, shared)
        for k in range(start[corner], start[corner + 1]):
            other = members[k]
            if other != at and wanted[marker[other]] and _holds(facets, at, shared, other):
                new_square, new_bits, _, _, _ = vertex_to_facet(points, vertex, facets, other)
                if new_square < square:
                    square, bits, facet = new_square, new_bits, other
        if facet == at:
            break
    return square, facet


@njit(cache=True, nogil=True)
def local_search_to_facet(points, target, surfaces, wanted, facet):
    """Squared distance of the facet ``target`` to the surfaces ``wanted`` near ``facet``, and where it is found."""
    facets, marker, start, members = surfaces.facets, surfaces.marker, surfaces.start, surfaces.members
    square, bits = _facet_to_facet(points, facets, target, facet)
    inside = (1 << points.shape[1]) - 1
    while bits != inside:
        at, shared = facet, bits
        corner = _first_corner(facets, at, shared)
        for k in range(start[corner], start[corner + 1]):
            other = members[k]
            if other != at and wanted[marker[other]] and _holds(facets, at, shared, other):
                new_square, new_bits = _facet_to_facet(points, facets, target, other)
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


@njit(cache=True, nogil=True, forceinline=True)
def _first_corner(facets, facet, bits):
    return facets[facet, 0 if bits & 1 else (1 if bits & 2 else 2)]


@njit(cache=True, nogil=True, forceinline=True)
def _holds(facets, facet, bits, other):
    """Tell whether ``other`` holds all corners of ``facet`` that ``bits`` name."""
    for i in range(facets.shape[1]):
        if bits >> i & 1:
            found = False
            for j in range(facets.shape[1]):
                found |= facets[other, j] == facets[facet, i]
            if not found:
                return False
    return True
