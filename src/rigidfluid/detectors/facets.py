"""Contacts of polygons and polyhedra with each other, with ellipsoids and with walls, exact and without a mesh."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np

from rigidfluid.core.contact.pairs.broad_phase import near_pairs, rows_of_near_walls
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wall import Wall, centre_of, is_round, radius_of
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.mechanics.shapes import shape_key
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import in_order, select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.ellipsoid_on_facets import PlacedEllipsoids, ellipsoid_touches
from rigidfluid.detectors.placed_facets import PlacedFacets, Places, Solid, passing_edges, shallowest_piercing
from rigidfluid.detectors.probes import Pairs, Placement, Probed, Probes
from rigidfluid.detectors.round_pieces import is_whole
from rigidfluid.detectors.smooth_contacts import SmoothContacts
from rigidfluid.detectors.touches import Touches, all_touches
from rigidfluid.errors import SceneError

SPREAD = 0.5
"""Greatest difference of gap between contacts of a pair, over the smaller bounding radius [1]; others are left out."""


class FacetDetector(Detector):
    """One contact for each corner of a pair that is in reach of the other's surface, so that a box lies on all its
    corners.

    A corner at x with the nearest point p of the other surface has gap = |x - p| and normal = (x - p)/|x - p|; in
    space the same holds between edges that pass each other. A ball or an ellipsoid has a contact with each place that
    is nearer to it than all around; of a hollow whose sides meet at more than a right angle a corner has the nearest
    side alone. Overlap is the depth of the deepest corner, or that of the shallowest edge that goes through a facet.
    Bodies other than ellipsoids and bodies of facets, and walls neither flat, round nor of facets, raise SceneError.
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
        self._radii = np.array([radius_of(each) for each in [*bodies, *(wall.shape for wall in walls)]], dtype=float)
        self._surfaces = np.array([*range(len(bodies)), *(wall.surface for wall in walls)], dtype=np.int64)
        shapes = {shape_key(body): Solid(FacetSurface(body.facets)) for body in bodies if body.facets is not None}
        self._solids = [shapes.get(shape_key(body)) for body in bodies]
        self._solids += [Solid(wall.shape) if isinstance(wall.shape, FacetSurface) else None for wall in walls]
        self.signed = sum(solid is not None for solid in self._solids) > 1 and any(
            body.dimension == 3 for body in bodies
        )
        self._different_solids = list({id(solid): solid for solid in self._solids if solid is not None}.values())
        number = {id(solid): row for row, solid in enumerate(self._different_solids)}
        self._solid_numbers = np.array([number.get(id(solid), -1) for solid in self._solids], dtype=np.int64)
        self._faceted = np.array([solid is not None for solid in self._solids], dtype=bool)
        smooth = [index for index, body in enumerate(bodies) if body.semi_axes is not None]
        self._smooth = np.array(smooth, dtype=np.int64)
        self._smooth_contacts = SmoothContacts([bodies[index] for index in smooth], [])
        long = [index for index in smooth if bodies[index].radius is None]
        self._long = np.array(long, dtype=np.int64)
        self._semi_axes = np.array([_semi_axes(body) for body in bodies])
        self._is_long = np.isin(np.arange(len(self._solids)), self._long)
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
        pairs, placed = self._pairs_near(pose.position, reach), self._placed(pose)
        touches = self._probes.touches(pairs, placed, reach)
        further = list(self._further_touches(pairs, placed, reach, touches))
        touches = all_touches([touches, *further], pose.position.shape[1]) if further else touches
        touches = touches.select(np.argsort(touches.gap, kind="stable"))
        limit = np.maximum(_least_gaps(touches, len(pairs.a)), 0.0) + pairs.spread
        near = touches.select((touches.gap <= reach) & (touches.gap <= limit[touches.pair]))
        return in_order([*self._smooth_pair_contacts(pose, reach), self._contacts(pairs, near)])

    def _pairs_near(self, position: FloatArray, reach: float) -> Pairs:
        """Pairs with a body or a wall of facets, or of a ball and a wall."""
        a, b = near_pairs(position, self._bounds, reach)
        meant = self._faceted[a] | self._faceted[b]
        a, b = a[meant], b[meant]
        body, wall = rows_of_near_walls(position, self._bounds, self.walls, reach)
        wall = wall + len(self.bodies)
        meant = self._faceted[wall] | ~self._is_long[body]
        body, wall = body[meant], wall[meant]
        size = np.concatenate([np.minimum(self._bounds[a], self._bounds[b]), self._bounds[body]])
        return Pairs(np.concatenate([a, body]), np.concatenate([b, wall]), SPREAD * size)

    def _placed(self, pose: Pose) -> Placement:
        """All bodies, and after them the walls."""
        placed = pose.position, rotation_matrices(pose.orientation)
        unmoved = _unmoved(len(self.walls), pose.position.shape[1])
        return Placement(*(np.concatenate(both) for both in zip(placed, unmoved, strict=True)))

    @cached_property
    def _probes(self) -> Probes:
        shapes = [*self.bodies, *(wall.shape for wall in self.walls)]
        return Probes([_probed(*each) for each in zip(shapes, self._solids, strict=True)])

    def _further_touches(self, pairs: Pairs, placed: Placement, reach: float, found: Touches) -> Iterator[Touches]:
        """Places besides those of points: on ellipsoids, and of two surfaces of facets between edges that pass each
        other, or, where no corner is inside, that go through facets."""
        yield from self._ellipsoid_touches(pairs, placed, reach)
        pair = np.flatnonzero(self._faceted[pairs.a] & self._faceted[pairs.b])
        if len(pair) == 0:
            return
        least = _least_gaps(found, len(pairs.a))
        span = np.minimum(reach, np.maximum(least, 0.0) + pairs.spread)
        if placed.position.shape[1] == 3:
            near = pair[self._probes.boxes_meet(pairs.a[pair], pairs.b[pair], placed, span[pair])]
            for row, a, b in self._both(pairs, near, placed):
                edges = _touches(row, passing_edges(a, b, float(span[row])))
                yield edges
                least[row] = min(least[row], edges.gap.min(initial=np.inf))
        pair = pair[least[pair] > 0.0]
        for own, other in ((pairs.a, pairs.b), (pairs.b, pairs.a)):
            pair = pair[self._probes.boxes_meet(own[pair], other[pair], placed, 0.0)]
        for row, a, b in self._both(pairs, pair, placed):
            yield _touches(row, shallowest_piercing(a, b))

    def _both(
        self, pairs: Pairs, rows: IntArray, placed: Placement
    ) -> Iterator[tuple[int, PlacedFacets, PlacedFacets]]:
        """Both surfaces of facets of the pairs in these ``rows``."""
        for row in rows.tolist():
            yield row, self._facets(int(pairs.a[row]), placed), self._facets(int(pairs.b[row]), placed)

    def _facets(self, number: int, placed: Placement) -> PlacedFacets:
        solid = self._solids[number]
        assert solid is not None
        return PlacedFacets(solid, placed.position[number], placed.rotation[number])

    def _ellipsoid_touches(self, pairs: Pairs, placed: Placement, reach: float) -> Iterator[Touches]:
        """Contacts of ellipsoids with surfaces of facets, those of all pairs with one surface at once."""
        rows = np.flatnonzero(self._is_long[pairs.a] | self._is_long[pairs.b])
        faceted = self._faceted[pairs.a[rows]]
        body = np.where(faceted, pairs.b[rows], pairs.a[rows])
        other = np.where(faceted, pairs.a[rows], pairs.b[rows])
        for number in np.unique(self._solid_numbers[other]).tolist():
            mine = np.flatnonzero(self._solid_numbers[other] == number)
            there = other[mine]
            turned = np.einsum("nki,nkj->nij", placed.rotation[there], placed.rotation[body[mine]])
            local = placed.local(there, placed.position[body[mine]])
            bodies = PlacedEllipsoids(self._semi_axes[body[mine]], local, turned)
            near = ellipsoid_touches(bodies, self._different_solids[number], reach)
            there, row = there[near.point], rows[mine][near.point]
            foot, normal = placed.lab(there, near.foot), placed.turned(there, near.normal)
            point, sign = foot + near.distance[:, None] * normal, np.ones(len(row))
            yield Touches(row, point, foot, normal, near.distance, sign).turned(faceted[mine][near.point])

    def _smooth_pair_contacts(self, pose: Pose, reach: float) -> list[Contacts]:
        """Contacts of balls and ellipsoids with each other, and of the latter with flat and round walls."""
        if len(self._smooth) < 2 and len(self._long) == 0:
            return []
        pairs = self._smooth_contacts.pair_contacts(_select_bodies(pose, self._smooth), reach)
        pairs = replace(pairs, body_a=self._smooth[pairs.body_a], body_b=self._smooth[pairs.body_b])
        at_walls = self._long_contacts.wall_contacts(_select_bodies(pose, self._long), reach)
        found = [pairs, *(replace(each, body_a=self._long[each.body_a]) for each in at_walls)]
        return [select(each, each.gap <= reach) for each in found]

    def _contacts(self, pairs: Pairs, touches: Touches) -> Contacts:
        a, b = pairs.a[touches.pair], pairs.b[touches.pair]
        return Contacts(
            body_a=a,
            body_b=self._surfaces[b],
            point_a=touches.point_a,
            point_b=touches.point_b,
            normal=touches.normal,
            gap=touches.gap,
            radius_a=self._radii[a],
            radius_b=self._radii[b],
            at_wall=b >= len(self.bodies),
            sign=touches.sign,
        )


@lru_cache(maxsize=4)
def _unmoved(count: int, dimension: int) -> tuple[FloatArray, FloatArray]:
    """Positions and rotations of so many surfaces that do not move."""
    return np.zeros((count, dimension)), np.tile(np.eye(dimension), (count, 1, 1))


def is_known(shape: Surface) -> bool:
    """Tell whether the detector takes walls of this shape."""
    return shape.radius is not None or isinstance(shape, FacetSurface)


def _probed(shape: Surface, solid: Solid | None) -> Probed:
    """Points of a body or a wall that are measured: the corners of facets, the centre of a ball or a bump."""
    if solid is not None:
        return Probed(solid.surface.facets.points[solid.features.corners], 0.0, solid)
    target, radius = None if isinstance(shape, Body) else shape, radius_of(shape)
    if not 0.0 < radius < np.inf:
        return Probed(np.empty((0, len(shape.bounds[0]))), 0.0, target)
    centre = np.zeros(len(shape.bounds[0])) if isinstance(shape, Body) else centre_of(shape)
    return Probed(centre[None], radius, target)


def _touches(pair: int, places: Places) -> Touches:
    return Touches(np.full(len(places.gap), pair), *places)


def _semi_axes(body: Body) -> FloatArray:
    """Semi-axes (d,) of a body, NaN without any [length]."""
    return np.full(body.dimension, np.nan) if body.semi_axes is None else body.semi_axes


def _least_gaps(touches: Touches, pairs: int) -> FloatArray:
    """Least gap of each of so many pairs, infinite where none is found [length]."""
    least = np.full(pairs, np.inf)
    np.minimum.at(least, touches.pair, touches.gap)
    return least


def _select_bodies(pose: Pose, bodies: IntArray) -> Pose:
    return Pose(pose.position[bodies], pose.orientation[bodies])


def _is_taken(piece: Piece, long: bool) -> bool:
    """Tell whether a piece is of facets, flat or round; ``long``: some bodies are ellipsoids that are no balls."""
    if isinstance(piece.shape, FacetSurface) or piece.shape.plane:
        return True
    return is_whole(piece) if long else is_round(piece.shape)


def _refuse(detector: str, found: str, allowed: str) -> None:
    remedy = 'Use detector = "auto", which takes one for these shapes.'
    raise SceneError("contact.detector", f'"{detector}" with {found}', allowed, remedy)
