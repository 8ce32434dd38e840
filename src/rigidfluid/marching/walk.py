"""Steps from facet to facet of a surface until none near by is nearer. Arrays in, numbers out.

On a convex surface seen from outside the facet where such a walk ends is the nearest of all; elsewhere it is the
nearest of its surroundings, and the march compares the walks that arrive from all sides.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from numba import njit

from rigidfluid.marching.simplices import boxes_apart, facet_to_facet, vertex_to_facet


@njit(cache=True, nogil=True)
def walk_to_vertex(points, vertex, surfaces, wanted, facet):
    """Squared distance of a vertex to the surfaces ``wanted`` near ``facet``, and the facet it is found on.

    Where the nearest point is inside a facet it is nearest in its surroundings; where it is on an edge or a corner, the
    other facets there are tried.
    """
    square, bits, _, _, _ = vertex_to_facet(points, vertex, surfaces.facets, facet)
    inside = (1 << points.shape[1]) - 1
    while bits != inside:
        shared = bits
        corner = surfaces.facets[facet, 0 if bits & 1 else (1 if bits & 2 else 2)]
        at = facet
        for k in range(surfaces.start[corner], surfaces.start[corner + 1]):
            other = surfaces.members[k]
            if other == at or not wanted[surfaces.marker[other]] or not _holds(surfaces.facets, at, shared, other):
                continue
            new_square, new_bits, _, _, _ = vertex_to_facet(points, vertex, surfaces.facets, other)
            if new_square < square:
                square, bits, facet = new_square, new_bits, other
        if facet == at:
            break
    return square, facet


@njit(cache=True, nogil=True)
def try_around(points, vertex, surfaces, wanted, square, facet):
    """What `walk_to_vertex` found, or what is nearer among all facets that touch ``facet``, and so on from there.

    Seen from a concave side a walk ends on every facet that faces the vertex, so that the next must be tried as well.
    """
    while True:
        at = facet
        for i in range(points.shape[1]):
            corner = surfaces.facets[at, i]
            for k in range(surfaces.start[corner], surfaces.start[corner + 1]):
                other = surfaces.members[k]
                if other == at or not wanted[surfaces.marker[other]]:
                    continue
                new_square = vertex_to_facet(points, vertex, surfaces.facets, other)[0]
                if new_square < square:
                    square, facet = new_square, other
        if facet == at:
            return square, facet


@njit(cache=True, nogil=True)
def walk_to_facet(points, target, surfaces, wanted, facet):
    """Squared distance of the facet ``target`` to the surfaces ``wanted`` near ``facet``, and where it is found."""
    square = facet_to_facet(points, surfaces.facets, target, facet)[0]
    while True:
        at = facet
        for i in range(points.shape[1]):
            corner = surfaces.facets[at, i]
            for k in range(surfaces.start[corner], surfaces.start[corner + 1]):
                other = surfaces.members[k]
                if other == at or not wanted[surfaces.marker[other]]:
                    continue
                if boxes_apart(points, surfaces.facets, target, other) >= square:
                    continue
                new_square = facet_to_facet(points, surfaces.facets, target, other)[0]
                if new_square < square:
                    square, facet = new_square, other
        if facet == at:
            return square, facet


@njit(cache=True, nogil=True)
def _holds(facets, facet, bits, other):
    """Whether ``other`` holds all corners of ``facet`` that ``bits`` name."""
    for i in range(facets.shape[1]):
        if bits >> i & 1:
            found = False
            for j in range(facets.shape[1]):
                found |= facets[other, j] == facets[facet, i]
            if not found:
                return False
    return True
