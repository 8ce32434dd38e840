"""Contacts of bodies with each other and with walls, from the distance fields of their surfaces on a mesh."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import partial
from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.pairs.broad_phase import near_pairs, near_walls
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall, radius_of, wall_radii
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.errors import SceneError
from rigidfluid.marching.exact import measure, put_back, reset
from rigidfluid.marching.field import WAVES, Accuracy, Band
from rigidfluid.marching.options import MarchingOptions
from rigidfluid.marching.pairs import any_near, facet_gaps, nearest_points, places
from rigidfluid.marching.shared import NO_GAPS, Gaps, SharedMesh, joined_gaps
from rigidfluid.marching.topology import Numbers, Target, Topology
from rigidfluid.marching.workers import Workers, same_topology
from rigidfluid.marching.workspace import Workspace

ROUNDED_UP = 1.0 + 1e-9
"""Factor on radii of bounding balls, as the vertices of a mesh are on the surface only to rounding [1]."""

TO_CORNER = {2: 0.5, 3: 1.0 / sqrt(3.0)}
"""Dimension → distance from a point of a facet to its nearest corner over the facet's longest edge, at most."""


class _Scope(NamedTuple):
    """Data that all searches of one call share: the mesh as it lies, the bodies' centres, the largest gap wanted."""

    topology: Topology
    points: FloatArray
    position: FloatArray
    reach: float


class Field(NamedTuple):
    """Field marched from a ``body``, the ``target`` of its distances, which are in ``work``."""

    body: int
    target: Target
    work: Workspace


_Near = tuple[int, list[int]]
"""A body, and the surfaces that may be near it."""


class ContactFinder:
    """Finds gap = min |x - y| over the facets x of surface a and y of surface b, and the points where it is reached.

    A field is marched from each body that has something near, and the facets of its neighbours in the band are compared
    with the body's own. The band goes to reach + L/2 at a vertex with longest edge L (in space: + L/√3): a point within
    ``reach`` on an edge or a facet has a corner of it in the band. So the march meets the facets at the end of every
    straight line of that length through the fluid.

    The ``options`` say how the fields are marched: gaps are exact to the facets with either accuracy. Fields go on to
    the end of the mesh for the ``whole_domain``.
    """

    def __init__(
        self,
        bodies: Sequence[Body],
        walls: Sequence[Wall],
        options: MarchingOptions,
        whole_domain: bool,
    ) -> None:
        self._walls = tuple(walls)
        self._bounds = np.array([body.bounding_radius for body in bodies], dtype=float)
        self._radii = np.array([radius_of(body) for body in bodies], dtype=float)
        self._surfaces = max([len(bodies) - 1, *(wall.surface for wall in walls)]) + 1
        self._accuracy: Accuracy = options.accuracy
        self._several = options.multiple
        self._whole_domain = whole_domain
        self._workers = Workers(options.threads)
        self._shared: SharedMesh | None = None

    def find(self, pose: Pose, mesh: Mesh, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b, gap)."""
        if mesh.part is not None:
            self._refuse_first_order(mesh.ranks.size)
        near = self._near_surfaces(pose.position, reach)
        if not near:
            return self._contacts(mesh.points, mesh.facets.astype(np.int32), NO_GAPS)
        search = self._search_whole if mesh.part is None else self._search_parts
        scope, gaps = search(pose.position, mesh, reach, near)
        return self._contacts(scope.points, scope.topology.surfaces.facets, gaps)

    def _search_whole(
        self, position: FloatArray, mesh: Mesh, reach: float, near: Sequence[_Near]
    ) -> tuple[_Scope, Gaps]:
        topology, points = self._workers.topology(mesh), np.ascontiguousarray(mesh.points)
        scope = _Scope(topology, points, position, reach)
        return scope, joined_gaps([NO_GAPS, *self._workers.map(partial(self._gaps_of, scope), near)])

    def _search_parts(
        self, position: FloatArray, mesh: Mesh, reach: float, near: Sequence[_Near]
    ) -> tuple[_Scope, Gaps]:
        """Search a mesh in parts: each rank measures the facets of its part, and all judge the gaps of all."""
        if self._shared is None or not same_topology(mesh, self._shared.mesh):
            self._shared = SharedMesh(mesh)
        shared = self._shared
        points, work = shared.points(mesh), shared.part.workspace
        scope = _Scope(shared.part.topology, points, position, reach)
        near = [(body, close) for body, others in near if (close := self._close_surfaces(scope, body, others))]
        sources = [(body,) for body, _ in near]
        marches = shared.march(points, sources, self._band(scope))
        gaps = [NO_GAPS]
        for (body, others), march in zip(near, marches, strict=True):
            if march is not None:
                put_back(work, *march[:4])
                field = Field(body, march.target, work)
                gaps += [self._surface_gaps(scope, field, other, shared.facets_of(other)) for other in others]
                reset(work, len(march.vertices), len(march.beyond))
        return scope, shared.gather(joined_gaps(gaps))

    def _refuse_first_order(self, ranks: int) -> None:
        if self._accuracy != "exact":
            raise SceneError(
                "contact.accuracy",
                f"{self._accuracy!r} with {ranks} processes",
                "'exact' where several processes share the mesh: the other's values depend on the order of the whole",
                "Leave contact.accuracy out, or start one process.",
            )

    def _near_surfaces(self, position: FloatArray, reach: float) -> list[_Near]:
        """Bodies, each with the surfaces whose bounding volumes are in reach; a pair stands with its first body."""
        surfaces: dict[int, list[int]] = defaultdict(list)
        for a, b in zip(*near_pairs(position, self._bounds, reach), strict=True):
            surfaces[int(a)].append(int(b))
        for body, wall in near_walls(position, self._bounds, self._walls, reach):
            surfaces[body].append(wall.surface)
        return sorted(surfaces.items())

    def _close_surfaces(self, scope: _Scope, body: int, others: Sequence[int]) -> list[int]:
        """The ``others``, surfaces, that have a facet whose bounding box is in reach of the body's ball."""
        points, facets, (centre, radius) = scope.points, scope.topology.surfaces.facets, self._ball(scope, body)
        near, facets_of = radius + scope.reach, scope.topology.facets_of
        return [other for other in others if any_near(points, facets, facets_of(other), centre, near)]

    def _gaps_of(self, scope: _Scope, work: Workspace, near: _Near) -> list[Gaps]:
        body, others = near[0], self._close_surfaces(scope, *near)
        if not others:
            return []
        topology, points = scope.topology, scope.points
        wave = WAVES[self._accuracy](topology, points, [body], self._band(scope), work)
        if self._accuracy != "exact":
            measure(wave.target, work, wave.touched)
        field = Field(body, wave.target, work)
        gaps = [self._surface_gaps(scope, field, other, topology.facets_of(other)) for other in others]
        reset(work, wave.touched, wave.beyond)
        return gaps

    def _surface_gaps(self, scope: _Scope, field: Field, other: int, chosen: Numbers) -> Gaps:
        """Gaps of the facets ``chosen`` of the other surface to the body of a field."""
        gap, partner = facet_gaps(field, self._ball(scope, field.body), chosen, scope.reach, self._several)
        near = np.flatnonzero(np.isfinite(gap))
        pair = np.full(len(near), field.body * self._surfaces + other)
        return Gaps(pair, chosen[near], gap[near], partner[near])

    def _ball(self, scope: _Scope, body: int) -> tuple[FloatArray, float]:
        return scope.position[body], self._bounds[body] * ROUNDED_UP

    def _band(self, scope: _Scope) -> Band:
        return Band(inf if self._whole_domain else scope.reach, TO_CORNER[scope.points.shape[1]])

    def _least_gaps(self, facets: Numbers, gaps: Gaps) -> Gaps:
        """Least gap of each pair, or of each separate place; of equal ones that at the first facet."""
        gaps = gaps.select(np.lexsort((gaps.facet, gaps.pair)))
        pair, first, place = np.unique(gaps.pair, return_index=True, return_inverse=True)
        if self._several:
            patches = [places(facets, part) for part in np.split(gaps.facet, first[1:])] if len(pair) else []
            place = place * len(gaps.pair) + np.concatenate([np.empty(0, np.int64), *patches])
        order = np.lexsort((gaps.gap, place))
        best = gaps.select(order[np.unique(place[order], return_index=True)[1]])
        return best.select(np.lexsort((best.gap, best.pair)))

    def _contacts(self, points: FloatArray, facets: Numbers, gaps: Gaps) -> Contacts:
        best = self._least_gaps(facets, gaps)
        (a, b), gap = np.divmod(best.pair, self._surfaces), best.gap
        point_a, point_b = nearest_points(points, facets, best.partner, best.facet)
        at_wall, radius_b = b >= len(self._radii), np.empty(len(b))
        radius_b[~at_wall], radius_b[at_wall] = self._radii[b[~at_wall]], wall_radii(self._walls, b[at_wall])
        return Contacts(
            body_a=a,
            body_b=b,
            point_a=point_a,
            point_b=point_b,
            normal=(point_a - point_b) / gap[:, None],
            gap=gap,
            radius_a=self._radii[a],
            radius_b=radius_b,
            at_wall=at_wall,
        )
