"""Contacts of polygons and polyhedra with each other, with ellipsoids and with walls, exact and without a mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from rigidfluid.core.contact.pairs.broad_phase import near_pairs, near_walls
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface, Nearby, nearby
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wall import Wall, is_round, radius_of
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.mechanics.shapes import shape_key
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import in_order, select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.ellipsoid_on_facets import PlacedEllipsoid, ellipsoid_touches
from rigidfluid.detectors.facet_features import Features, features_of
from rigidfluid.detectors.round_pieces import is_whole
from rigidfluid.detectors.smooth_contacts import SmoothContacts
from rigidfluid.errors import SceneError

SPREAD = 0.5
"""Greatest difference of gap between contacts of a pair, over the smaller bounding radius [1]; others are left out."""


class Touches(NamedTuple):
    """Places at which two surfaces are near each other: ``point_a``, ``point_b``, ``normal`` (m, d) from b to a,
    ``gap`` (m,)."""

    point_a: FloatArray
    point_b: FloatArray
    normal: FloatArray
    gap: FloatArray

    def select(self, chosen: BoolArray) -> Touches:
        """Places that are ``chosen`` (m,)."""
        return Touches(*(each[chosen] for each in self))

    def turned(self) -> Touches:
        """The same places with a and b exchanged."""
        return Touches(self.point_b, self.point_a, -self.normal, self.gap)


class FacetDetector(Detector):
    """One contact for each corner of a pair that faces the other's surface, so that a box lies on all its corners.

    A corner at x with the nearest points p of the other surface has gap = |x - p| and normal = (x - p)/|x - p|; in
    space the same holds between edges that pass each other. A ball or an ellipsoid has a contact with each place that
    is nearer to it than all around. Overlap is the depth of the deepest corner, or that of the shallowest edge that
    goes through a facet. Bodies other than ellipsoids and bodies of facets, and walls neither flat, round nor of
    facets, raise SceneError.
    """

    name: ClassVar[str] = "facets"
    cost: ClassVar[float] = 5e3

    def __init__(self, options: PartOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        super().__init__(options, bodies, walls)
        for index, body in enumerate(bodies):
            if body.facets is None and body.semi_axes is None:
                _refuse(self.name, f'body.{index} of type "{body.name}"', "ellipsoids, and bodies of facets")
        for wall in walls:
            if not is_known(wall.shape):
                _refuse(self.name, f"the wall {wall.name!r}", "walls that are flat, round or of facets")
        self._bounds = np.array([body.bounding_radius for body in bodies], dtype=float)
        self._radii = np.array([radius_of(body) for body in bodies], dtype=float)
        solids = {shape_key(body): _Solid(FacetSurface(body.facets)) for body in bodies if body.facets is not None}
        self._solids = [solids.get(shape_key(body)) for body in bodies]
        self._wall_radii = {wall.surface: float(radius_of(wall.shape)) for wall in walls}
        self._fixed = {wall.surface: _fixed(wall.shape) for wall in walls}
        smooth = [index for index, body in enumerate(bodies) if body.semi_axes is not None]
        self._smooth = np.array(smooth, dtype=np.int64)
        self._smooth_contacts = SmoothContacts([bodies[index] for index in smooth], [])
        long = [index for index in smooth if bodies[index].radius is None]
        self._long = np.array(long, dtype=np.int64)
        closed = [wall for wall in walls if not isinstance(wall.shape, FacetSurface)]
        self._long_contacts = SmoothContacts([bodies[index] for index in long], closed)

    @classmethod
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why detection is exact for ellipsoids and facets between flat, round and facet walls, or None."""
        if any(body.semi_axes is None and body.facets is None for body in bodies):
            return None
        long = any(body.semi_axes is not None and body.radius is None for body in bodies)
        walls_taken = all(_is_taken(piece, long) for piece in pieces)
        return "all bodies are balls, ellipsoids or made of facets" if walls_taken else None

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b, gap), from the shapes alone."""
        rotation = rotation_matrices(pose.orientation)
        placed = [self._placed(i, pose.position[i], rotation[i]) for i in range(len(self.bodies))]
        found = self._smooth_pair_contacts(pose, reach)
        for a, b in zip(*near_pairs(pose.position, self._bounds, reach), strict=True):
            if isinstance(placed[a], _Facets) or isinstance(placed[b], _Facets):
                spread = SPREAD * float(min(self._bounds[a], self._bounds[b]))
                touches = _pair_touches(placed[a], placed[b], reach, spread)
                found.append(self._contacts(int(a), int(b), touches))
        for body, wall in near_walls(pose.position, self._bounds, self.walls, reach):
            fixed, one = self._fixed[wall.surface], placed[body]
            if isinstance(fixed, _Facets) or not isinstance(one, _Ellipsoid):
                touches = _pair_touches(one, fixed, reach, SPREAD * float(self._bounds[body]))
                found.append(self._contacts(body, wall.surface, touches))
        return in_order(found)

    def _smooth_pair_contacts(self, pose: Pose, reach: float) -> list[Contacts]:
        """Contacts of balls and ellipsoids with each other, and of the latter with flat and round walls."""
        pairs = self._smooth_contacts.pair_contacts(_select_bodies(pose, self._smooth), reach)
        pairs = replace(pairs, body_a=self._smooth[pairs.body_a], body_b=self._smooth[pairs.body_b])
        at_walls = self._long_contacts.wall_contacts(_select_bodies(pose, self._long), reach)
        found = [pairs, *(replace(each, body_a=self._long[each.body_a]) for each in at_walls)]
        return [select(each, each.gap <= reach) for each in found]

    def _contacts(self, a: int, b: int, touches: Touches) -> Contacts:
        """Contacts of a body with another one or a wall, by their numbers."""
        count = len(touches.gap)
        return Contacts(
            body_a=np.full(count, a),
            body_b=np.full(count, b),
            **touches._asdict(),
            radius_a=np.full(count, self._radii[a]),
            radius_b=np.full(count, self._radii[b] if b < len(self.bodies) else self._wall_radii[b]),
            at_wall=np.full(count, b >= len(self.bodies)),
        )

    def _placed(self, index: int, position: FloatArray, rotation: FloatArray) -> _Placed:
        solid, body = self._solids[index], self.bodies[index]
        if solid is not None:
            return _Facets(solid, position, rotation)
        return _Ellipsoid(body, position, rotation) if body.radius is None else _Ball(position, body.radius)


def is_known(shape: Surface) -> bool:
    """Tell whether the detector takes walls of this shape."""
    return shape.radius is not None or isinstance(shape, FacetSurface)


class _Solid:
    """A surface of facets in its own frame, and its features that can touch others."""

    def __init__(self, surface: FacetSurface) -> None:
        self.surface = surface

    @cached_property
    def features(self) -> Features:
        return features_of(self.surface)


class _Ball(NamedTuple):
    """A ball where it stands."""

    centre: FloatArray
    radius: float


_Ellipsoid = PlacedEllipsoid


class _Facets(NamedTuple):
    """A surface of facets where it stands."""

    solid: _Solid
    position: FloatArray
    rotation: FloatArray

    def nearby(self, points: FloatArray, reach: float, spread: float) -> Nearby:
        found = self.solid.surface.nearby(self.local(points), reach, spread)
        return found._replace(foot=self.lab(found.foot), normal=found.normal @ self.rotation.T)

    def local(self, points: FloatArray) -> FloatArray:
        return np.asarray((points - self.position) @ self.rotation)

    def lab(self, points: FloatArray) -> FloatArray:
        return np.asarray(self.position + points @ self.rotation.T)

    @property
    def points(self) -> FloatArray:
        return self.lab(self.solid.surface.facets.points)


class _Round(NamedTuple):
    """A flat or round wall."""

    shape: Surface

    def nearby(self, points: FloatArray, reach: float, spread: float) -> Nearby:
        return nearby(self.shape, points, reach, spread)

    def ball(self, point: FloatArray) -> _Ball | None:
        """The wall as a ball, if it bulges into the fluid; ``point`` (d,) is any point there."""
        radius = radius_of(self.shape)
        if not 0 < radius < np.inf:
            return None
        foot, normal = self.shape.closest_point(point[None]), self.shape.normal(point[None])
        return _Ball((foot - radius * normal)[0], radius)


_Placed = _Ball | _Ellipsoid | _Facets
_Wall = _Facets | _Round


def _fixed(shape: Surface) -> _Wall:
    if not isinstance(shape, FacetSurface):
        return _Round(shape)
    dimension = shape.facets.points.shape[1]
    return _Facets(_Solid(shape), np.zeros(dimension), np.eye(dimension))


def _pair_touches(a: _Placed, b: _Placed | _Wall, reach: float, spread: float) -> Touches:
    """All contacts of a pair, the nearest first."""
    if isinstance(a, _Facets):
        if isinstance(b, _Facets | _Round):
            parts = _facet_touches(a, b, reach, spread)
        else:
            parts = [_smooth_touches(b, a, reach, spread).turned()]
    else:
        assert isinstance(b, _Facets | _Round)
        parts = [_smooth_touches(a, b, reach, spread)]
    found = Touches(*(np.concatenate(each) for each in zip(*parts, strict=True)))
    if isinstance(b, _Round):
        found = _without_repeats(found)
    least = found.gap.min(initial=np.inf)
    found = found.select((found.gap <= reach) & (found.gap <= max(least, 0.0) + spread))
    return Touches(*(each[np.argsort(found.gap, kind="stable")] for each in found))


def _without_repeats(found: Touches) -> Touches:
    """The contacts, each pair of points once: a corner may also be the point nearest to a wall that bulges."""
    points = np.concatenate([found.point_a, found.point_b], axis=1)
    return found.select(np.sort(np.unique(points, axis=0, return_index=True)[1]))


def _smooth_touches(body: _Ball | _Ellipsoid, other: _Facets | _Round, reach: float, spread: float) -> Touches:
    if isinstance(body, _Ball):
        near = other.nearby(body.centre[None], reach + body.radius, spread)
        return Touches(body.centre - body.radius * near.normal, near.foot, near.normal, near.distance - body.radius)
    assert isinstance(other, _Facets)
    turned = _Ellipsoid(body.shape, other.local(body.position), other.rotation.T @ body.rotation)
    near = ellipsoid_touches(turned, other.solid.surface, other.solid.features, reach)
    foot, normal = other.lab(near.foot), near.normal @ other.rotation.T
    return Touches(foot + near.distance[:, None] * normal, foot, normal, near.distance)


def _facet_touches(a: _Facets, b: _Facets | _Round, reach: float, spread: float) -> list[Touches]:
    reach = min(reach, _some_gap(a, b) + spread)
    parts = [_corner_touches(a, b, reach, spread)]
    if isinstance(b, _Round):
        ball = b.ball(a.position)
        return parts if ball is None else [*parts, _smooth_touches(ball, a, reach, spread).turned()]
    parts += [_corner_touches(b, a, reach, spread).turned(), _edge_touches(a, b, reach)]
    if all(part.gap.min(initial=np.inf) > 0 for part in parts):
        parts.append(_shallowest_piercing(a, b))
    return parts


def _some_gap(a: _Facets, b: _Facets | _Round) -> float:
    """Gap of a vertex of a that is near b [length]; the least gap is no larger."""
    foot = b.nearby(a.position[None], np.inf, 0.0).foot[0]
    points = a.points
    nearest = np.argmin(np.linalg.norm(points - foot, axis=1))
    return max(float(b.nearby(points[nearest : nearest + 1], np.inf, 0.0).distance[0]), 0.0)


def _corner_touches(a: _Facets, b: _Facets | _Round, reach: float, spread: float) -> Touches:
    features = a.solid.features
    corners = a.points[features.corners]
    close = np.flatnonzero(_near_boxes(corners[:, None], b, reach))
    corners = corners[close]
    near = b.nearby(corners, reach, spread)
    outwards = features.corner_normals[close[near.point]] @ a.rotation.T
    faces = np.sum(outwards * near.normal, axis=1) < 0
    nearest = near.distance <= near.distance.min(initial=np.inf)
    return Touches(corners[near.point], near.foot, near.normal, near.distance).select(faces | nearest)


def _near_boxes(groups: FloatArray, other: _Facets | _Round, reach: float) -> BoolArray:
    """Which groups of points (m, k, d) have a box within ``reach`` of that around another surface, in its frame."""
    if isinstance(other, _Round):
        return np.ones(len(groups), dtype=bool)
    lower, upper = other.solid.surface.bounds
    inside = other.local(groups)
    return np.asarray(np.all((inside.max(axis=1) >= lower - reach) & (inside.min(axis=1) <= upper + reach), axis=1))


def _edge_touches(a: _Facets, b: _Facets, reach: float) -> Touches:
    dimension = len(a.position)
    if dimension == 2:
        return _no_touches(dimension)
    from rigidfluid.detectors.edge_pairs import passing_edges

    points_a, points_b, both = a.points, b.points, (a.solid.features, b.solid.features)
    close_a = _near_boxes(points_a[both[0].edges], b, reach)
    close_b = _near_boxes(points_b[both[1].edges], a, reach)
    edges_a, edges_b = both[0].edges[close_a], both[1].edges[close_b]
    first, second, point_a, point_b = passing_edges(points_a, edges_a, points_b, edges_b, reach)
    away = point_a - point_b
    gap = np.linalg.norm(away, axis=1)
    normal = away / gap[:, None]
    towards_b = np.sum(both[0].edge_normals[close_a][first] @ a.rotation.T * normal, axis=1) < 0
    towards_a = np.sum(both[1].edge_normals[close_b][second] @ b.rotation.T * normal, axis=1) > 0
    return Touches(point_a, point_b, normal, gap).select(towards_a & towards_b)


def _shallowest_piercing(a: _Facets, b: _Facets) -> Touches:
    """The shallowest edge that goes through a facet, if any does, by its deeper end."""
    found = [_piercing_edges(a, b), _piercing_edges(b, a).turned()]
    both = Touches(*(np.concatenate(each) for each in zip(*found, strict=True)))
    return both.select(np.arange(len(both.gap)) == np.argmax(both.gap)) if len(both.gap) else both


def _piercing_edges(a: _Facets, b: _Facets) -> Touches:
    """Edges of a through facets of b."""
    from rigidfluid.core.geometry.crossings import crossings

    facets, inside = b.solid.surface.facets, b.local(a.points)
    lower, upper = b.solid.surface.bounds
    if np.any(inside.max(axis=0) < lower) or np.any(inside.min(axis=0) > upper):
        return _no_touches(len(lower))
    points, edges = np.concatenate([facets.points, inside]), a.solid.features.all_edges + len(facets.points)
    crossed = crossings(points, edges, b.solid.surface.tree)
    normal = b.solid.surface.facet_normals[crossed[:, 1]]
    ends = points[edges[crossed[:, 0]]]
    heights = np.einsum("mej,mj->me", ends - points[facets.vertices[crossed[:, 1], :1]], normal)
    deeper = np.argmin(heights, axis=1)
    rows = np.arange(len(crossed))
    gap, end = np.minimum(heights[rows, deeper], 0.0), ends[rows, deeper]
    return Touches(b.lab(end), b.lab(end - gap[:, None] * normal), normal @ b.rotation.T, gap)


def _select_bodies(pose: Pose, bodies: IntArray) -> Pose:
    return Pose(pose.position[bodies], pose.orientation[bodies])


def _no_touches(dimension: int) -> Touches:
    vectors = np.empty((0, dimension))
    return Touches(vectors, vectors, vectors, np.empty(0))


def _is_taken(piece: Piece, long: bool) -> bool:
    """Tell whether a piece is of facets, flat or round; ``long``: some bodies are ellipsoids that are no balls."""
    if isinstance(piece.shape, FacetSurface) or piece.shape.plane:
        return True
    return is_whole(piece) if long else is_round(piece.shape)


def _refuse(detector: str, found: str, allowed: str) -> None:
    remedy = 'Use detector = "auto", which takes one for these shapes.'
    raise SceneError("contact.detector", f'"{detector}" with {found}', allowed, remedy)
