"""The naive twin of `ellipsoid_touches`: one ellipsoid, in arrays of all facets, corners and edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_faces import unit
from rigidfluid.core.geometry.facet_surface import FacetSurface, Nearby
from rigidfluid.core.model.body import Body
from rigidfluid.detectors.facet_features import Features
from rigidfluid.detectors.placed_facets import Solid

_BISECTIONS = 60
_UPHILL = -1e-9
"""Slope of a distance along a straight line that is zero but for rounding [1]."""

_SAME = 1e-7
"""Distance of two places over the size of body and surface, below which they are one [1]."""


@dataclass(frozen=True)
class PlacedEllipsoid:
    """An ellipsoid at ``position`` (d,), turned by ``rotation`` (d, d)."""

    shape: Body
    position: FloatArray
    rotation: FloatArray

    def measured(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Signed distances (N,) of ``points`` (N, d), and outward normals (N, d) at their nearest points."""
        assert self.shape.semi_axes is not None
        local = (points - self.position) @ self.rotation
        foot = self.shape.closest_point(local)
        normal = foot / self.shape.semi_axes**2
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        distance = np.sum((local - foot) * normal, axis=1)
        return distance, normal @ self.rotation.T

    def farthest(self, directions: FloatArray) -> FloatArray:
        """Points (N, d) of the ellipsoid that are farthest in ``directions`` (N, d)."""
        assert self.shape.semi_axes is not None
        scaled = self.shape.semi_axes * (directions @ self.rotation)
        on_ball = scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
        return np.asarray(self.position + (self.shape.semi_axes * on_ball) @ self.rotation.T)


def minima_of_one(shape: Body, position: FloatArray, rotation: FloatArray, solid: Solid, reach: float) -> Nearby:
    """Places of a surface of facets at the local minima of the distance to one ellipsoid, the nearest first."""
    body, surface, features = PlacedEllipsoid(shape, position, rotation), solid.surface, solid.features
    centre = surface.nearby(body.position[None], np.inf, 0.0)
    towards = np.sum((body.farthest(-centre.normal) - centre.foot) * centre.normal, axis=1)
    overlap = centre._replace(distance=towards)
    if centre.distance[0] < 0:
        return overlap
    parts = [_facet_minima(body, surface), _corner_minima(body, surface, features, reach)]
    if len(body.position) == 3:
        parts.append(_edge_minima(body, surface, features, reach))
    found = Nearby(*(np.concatenate(each) for each in zip(*parts, strict=True)))
    if len(found.distance) == 0 and towards[0] < 0:
        return overlap  # so deep that the distance to the ellipsoid has a kink where it is least
    size = body.shape.bounding_radius + float(np.max(surface.bounds[1] - surface.bounds[0]))
    return _distinct_places(found, reach, _SAME * size)


def _distinct_places(found: Nearby, reach: float, same: float) -> Nearby:
    """The nearest first, and each place once: on the edge of two facets it may be found in both."""
    chosen: list[int] = []
    for row in np.argsort(found.distance, kind="stable").tolist():
        others = np.linalg.norm(found.foot[chosen] - found.foot[row], axis=1)
        if found.distance[row] <= reach and np.all(others > same):
            chosen.append(row)
    rows = np.array(chosen, dtype=np.int64)
    return found.select(rows)


def _facet_minima(body: PlacedEllipsoid, surface: FacetSurface) -> Nearby:
    normal = surface.facet_normals
    corners = surface.facets.points[surface.facets.vertices]
    before = np.flatnonzero(np.sum((body.position - corners[:, 0]) * normal, axis=1) > 0)
    normal, corners = normal[before], corners[before]
    nearest = body.farthest(-normal)
    height = np.sum((nearest - corners[:, 0]) * normal, axis=1)
    foot = nearest - height[:, None] * normal
    inside = _are_inside(foot, corners, normal)
    return _places(foot[inside], height[inside], normal[inside])


def _are_inside(points: FloatArray, corners: FloatArray, normals: FloatArray) -> BoolArray:
    """Which points (F, d) in the planes of facets (F, d, d) are inside them."""
    inside = np.ones(len(points), dtype=bool)
    dimension = corners.shape[1]
    for i in range(dimension):
        edge, away = corners[:, (i + 1) % dimension] - corners[:, i], points - corners[:, i]
        inwards = np.cross(normals, edge) if dimension == 3 else edge
        inside &= np.sum(inwards * away, axis=1) >= _UPHILL * np.sum(edge**2, axis=1)
    return inside


def _corner_minima(body: PlacedEllipsoid, surface: FacetSurface, features: Features, reach: float) -> Nearby:
    points = surface.facets.points
    within = np.linalg.norm(points - body.position, axis=1) - body.shape.bounding_radius <= reach
    near = np.flatnonzero(within & np.isin(np.arange(len(points)), features.corners))
    distance, normal = body.measured(points[near])
    outwards = np.zeros_like(points)
    outwards[near] = normal
    ahead = np.concatenate([features.all_edges, features.all_edges[:, ::-1]])
    along = unit(points[ahead[:, 1]] - points[ahead[:, 0]])
    slope = np.full(len(points), np.inf)
    np.minimum.at(slope, ahead[:, 0], np.sum(along * outwards[ahead[:, 0]], axis=1))
    lowest = slope[near] >= _UPHILL
    return _places(points[near][lowest], distance[lowest], -normal[lowest])


def _edge_minima(body: PlacedEllipsoid, surface: FacetSurface, features: Features, reach: float) -> Nearby:
    ends = surface.facets.points[features.edges]
    middle, half = ends.mean(axis=1), 0.5 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    near = np.linalg.norm(middle - body.position, axis=1) - half - body.shape.bounding_radius <= reach
    ends, down = ends[near], features.downhill[near]
    along = ends[:, 1] - ends[:, 0]
    low, high = np.zeros(len(ends)), np.ones(len(ends))
    for _ in range(_BISECTIONS):
        at = 0.5 * (low + high)
        rises = np.sum(body.measured(ends[:, 0] + at[:, None] * along)[1] * along, axis=1) > 0
        low, high = np.where(rises, low, at), np.where(rises, at, high)
    points = ends[:, 0] + (0.5 * (low + high))[:, None] * along
    distance, normal = body.measured(points)
    inside = (low > 0) & (high < 1)
    lowest = inside & np.all(np.einsum("mfk,mk->mf", down, normal) >= _UPHILL, axis=1)
    return _places(points[lowest], distance[lowest], -normal[lowest])


def _places(foot: FloatArray, distance: FloatArray, normal: FloatArray) -> Nearby:
    none: IntArray = np.zeros(len(foot), dtype=np.int64)
    return Nearby(none, none, foot, distance, normal)
