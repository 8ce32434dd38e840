"""Common base of polygons and polyhedra: a shape that its facets define."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facet_moments import facet_moments, unit_inertia
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, area_vectors, enclosed_volume
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import PartOptions
from rigidfluid.errors import SceneError

_LEAST_VOLUME = 1e-9
"""Volume over that of the cube around the body, below which a shape is flat [1]."""

_R2_STEPS = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps, modulo 1, of the sequence R₂, which fills a square evenly (M. Roberts, 2018)."""


class FacetBody(Body):
    """The inside of a closed surface of facets, moved so that its centre of mass is the origin.

    ``facets`` are closed, in any frame, with normals all outwards or all inwards; ``key`` is the option that they come
    from, for messages. A surface that crosses itself or encloses nothing raises SceneError.
    """

    def __init__(self, options: PartOptions, facets: Facets, key: str) -> None:
        super().__init__(options, facets.points.shape[1])
        _refuse_crossings(facets, f"body.{key}")
        _refuse_flat(facets, f"body.{key}")
        moments = facet_moments(facets)
        outwards = facets.vertices if moments.volume > 0 else facets.vertices[::-1, ::-1]
        own = Facets(facets.points - moments.centre, np.ascontiguousarray(outwards), np.zeros_like(facets.markers))
        self._surface = FacetSurface(own)
        self._given_centre = moments.centre
        self._volume, self._unit_inertia = abs(moments.volume), unit_inertia(moments.second)

    @property
    def facets(self) -> Facets:
        """The facets, normals outwards, about the centre of mass."""
        return self._surface.facets

    @property
    def given_centre(self) -> FloatArray:
        """Centre of mass of the facets as they were given, (d,) [length]."""
        return self._given_centre

    @property
    def volume(self) -> float:
        """Σ det(x_i)/d! over all facets [length^d]."""
        return self._volume

    @property
    def unit_inertia(self) -> FloatArray:
        """∫ (|r|² I - r rᵀ) / volume by `facet_moments`, (k, k) [length²]."""
        return self._unit_inertia

    @property
    def bounding_radius(self) -> float:
        """Distance of the farthest vertex from the centre of mass [length]."""
        return float(np.linalg.norm(self.facets.points, axis=1).max())

    def closest_point(self, points: FloatArray) -> FloatArray:
        """Nearest points of the facets, (N, d) for ``points`` (N, d) [length]."""
        return self._surface.closest_point(points)

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """Distance to the nearest facet, (N,), < 0 inside, for ``points`` (N, d) [length]."""
        return self._surface.signed_distance(points)

    def normal(self, points: FloatArray) -> FloatArray:
        """Unit normals outwards (N, d) at the closest points, see `FacetSurface.normal`."""
        return self._surface.normal(points)

    def sample_surface(self, count: int) -> FloatArray:
        """``count`` points spread evenly over the area, and before them the vertices if these are no more [length]."""
        vertices = self.facets.points
        area = np.linalg.norm(area_vectors(vertices, self.facets.vertices), axis=1)
        ends = np.cumsum(area)  # of the facets laid end to end, each as long as its area
        place = (np.arange(count) + 0.5) * ends[-1] / count
        facet = np.searchsorted(ends, place)
        if self.dimension == 2:
            share = (ends[facet] - place) / np.diff(ends, prepend=0.0)[facet]
            weights = np.stack([share, 1.0 - share], axis=1)
        else:
            u, v = ((np.arange(count)[:, None] + 0.5) * _R2_STEPS % 1.0).T
            weights = np.stack([1.0 - np.sqrt(u), np.sqrt(u) * (1.0 - v), np.sqrt(u) * v], axis=1)
        points: FloatArray = np.einsum("ni,nij->nj", weights, vertices[self.facets.vertices[facet]])
        return np.concatenate([vertices, points]) if len(vertices) <= count else points


def _refuse_crossings(facets: Facets, field: str) -> None:
    from rigidfluid.core.geometry.crossings import first_crossing

    crossing = first_crossing(facets.points, facets.vertices)
    if crossing is not None:
        one, other = facets.points[facets.vertices[list(crossing)]].tolist()
        found = f"a surface that crosses itself, where the facets {one} and {other} meet"
        remedy = "Move the corners, or make it several bodies."
        raise SceneError(field, found, "facets that meet at their edges alone", remedy)


def _refuse_flat(facets: Facets, field: str) -> None:
    size = float(np.max(np.ptp(facets.points, axis=0)))
    if not abs(enclosed_volume(facets.points, facets.vertices)) > _LEAST_VOLUME * size ** facets.points.shape[1]:
        raise SceneError(field, "facets that enclose nothing", "a shape of some volume", "Check the corners.")
