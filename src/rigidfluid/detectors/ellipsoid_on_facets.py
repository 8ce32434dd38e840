"""Places of a surface of facets that are nearest to ellipsoids: inside facets, at corners, and in space along edges."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import Nearby
from rigidfluid.detectors.in_space import axes_in_space, in_space, rotations_in_space
from rigidfluid.detectors.placed_facets import Solid

_SAME = 1e-7
"""Distance of two places over the size of body and surface, below which they are one [1]."""


class PlacedEllipsoids(NamedTuple):
    """Ellipsoids with ``semi_axes`` (n, d) [length] at ``position`` (n, d) [length], turned by ``rotation``
    (n, d, d)."""

    semi_axes: FloatArray
    position: FloatArray
    rotation: FloatArray

    def farthest(self, body: IntArray, directions: FloatArray) -> FloatArray:
        """Points (m, d) of these ellipsoids (m,) that are farthest in ``directions`` (m, d)."""
        axes, rotation = self.semi_axes[body], self.rotation[body]
        scaled = axes * np.einsum("nij,ni->nj", rotation, directions)
        on_ball = scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
        return np.asarray(self.position[body] + np.einsum("nij,nj->ni", rotation, axes * on_ball))


def ellipsoid_touches(bodies: PlacedEllipsoids, solid: Solid, reach: float) -> Nearby:
    """Places of a surface of facets, by their distance to each of n ellipsoids, at its local minima.

    Inside a facet the nearest point of the ellipsoid is that farthest against the facet's normal. The distance to the
    ellipsoid, which is convex, must not fall from a corner or an edge along any edge or facet that begins there. An
    ellipsoid with its centre behind the surface, or deep in it, has one place, that nearest to the centre.

    ``bodies`` are in the frame of the surface, ``reach`` the largest distance [length]. ``point`` is the row of the
    ellipsoid, ``facet`` 0 in all rows of the result, ``foot`` on the surface, ``distance`` and ``normal`` from there to
    the ellipsoid.
    """
    from rigidfluid.detectors.ellipsoid_minima import distance_minima

    count, d = bodies.position.shape
    centre = solid.surface.nearby(bodies.position, np.inf, 0.0)
    towards = np.sum((bodies.farthest(centre.point, -centre.normal) - centre.foot) * centre.normal, axis=1)
    lower, upper = solid.surface.bounds
    same = _SAME * (bodies.semi_axes.max(axis=1) + float(np.max(upper - lower)))
    placed = in_space(bodies.position), rotations_in_space(bodies.rotation), axes_in_space(bodies.semi_axes)
    body, foot, distance, normal, has_place = distance_minima(*placed, solid.triples, reach, same)
    # none is found so deep that the distance to the ellipsoid has a kink where it is least
    inside = (centre.distance[:count] < 0) | (~has_place & (towards[:count] < 0))
    apart = Nearby(body, np.zeros_like(body), foot[:, :d], distance, normal[:, :d]).select(~inside[body])
    overlap = centre._replace(facet=np.zeros_like(centre.facet), distance=towards).select(inside[centre.point])
    return Nearby(*(np.concatenate(both) for both in zip(overlap, apart, strict=True)))
