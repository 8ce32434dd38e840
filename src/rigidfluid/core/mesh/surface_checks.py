"""Refuses surfaces that no mesher can fill between: open ones, crossing ones, bodies outside the domain."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.surface_mesh import enclosed, part_of
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Mesh, Pose
from rigidfluid.errors import MeshError

_MEND = "Mend the surface: each edge of a facet belongs to one other facet, all normals point to the same side."


def refuse_unfillable(surface: Mesh, bodies: Sequence[Body], pose: Pose, domain: Domain) -> None:
    """Refuse what a mesher would fail on, or never end with.

    Parameters
    ----------
    surface : Mesh
        All facets around the fluid, as `surface_mesh` makes them.
    bodies : sequence of Body
        The shapes.
    pose : Pose
        Where they are.
    domain : Domain
        What they are in.

    Raises
    ------
    MeshError
        Names the surface and the place: where it is open, where two cross, which body is outside or in another.
    """
    names = [*(f"body.{i}" for i in range(len(bodies))), *(f"domain surface {name!r}" for name in domain.names)]
    _refuse_open(surface, names)
    _refuse_inside_out(surface, len(bodies))
    _refuse_crossing(surface, names)
    for i, body in enumerate(bodies):
        mine = surface.points[np.unique(surface.facets[surface.markers == i])]
        outside = mine[~domain.contains(mine)]
        if len(outside):
            allowed, remedy = f"all of it inside the {domain.name}", "Move the body or enlarge the domain."
            raise MeshError(f"body.{i}.position", f"a vertex outside, at {_place(outside[0])}", allowed, remedy)
        for k in np.flatnonzero(_within_reach(i, body, bodies, pose)):
            if distance_to_body(pose, int(k), bodies[int(k)], mine[:1])[0] < 0.0:
                found = f"a vertex inside body.{k}, at {_place(mine[0])}"
                raise MeshError(f"body.{i}.position", found, "a body apart from all others", "Move it.")


def _refuse_open(surface: Mesh, names: Sequence[str]) -> None:
    """A surface is closed when each side of its facets is met once, from the other side, by a facet beside it."""
    sides, facet = _sides(surface.facets)
    order = np.lexsort(sides.T[::-1])
    sides, facet = sides[order], facet[order]
    count = np.unique(sides, axis=0, return_counts=True)[1]
    met = _found_in(_reversed(sides), sides) & np.repeat(count == 1, count)
    if met.all():
        return
    at = int(np.flatnonzero(~met)[0])
    place = surface.points[sides[at][sides[at] >= 0]].mean(axis=0)
    found = f"a surface that is open, folded or turned over at {_place(place)}"
    raise MeshError(names[surface.markers[facet[at]]], found, "closed surfaces with normals into the fluid", _MEND)


def _sides(facets: IntArray) -> tuple[IntArray, IntArray]:
    """Directed sides of facets (S, 2), of an edge its first vertex as (v, -1) and its last as (-1, v); and the facet of
    each (S,)."""
    number = np.arange(len(facets))
    if facets.shape[1] == 3:
        sides = np.concatenate([facets[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
        return sides, np.tile(number, 3)
    none = np.full(len(facets), -1)
    sides = np.concatenate([np.stack([facets[:, 0], none], axis=1), np.stack([none, facets[:, 1]], axis=1)])
    return sides, np.tile(number, 2)


def _reversed(sides: IntArray) -> IntArray:
    return sides[:, ::-1]


def _found_in(wanted: IntArray, rows: IntArray) -> BoolArray:
    """Which of ``wanted`` (S, 2) are among ``rows`` (R, 2), (S,)."""
    base = int(rows.max()) + 2
    keys = (rows + 1) @ np.array([base, 1])
    return np.isin((wanted + 1) @ np.array([base, 1]), keys)


def _refuse_inside_out(surface: Mesh, bodies: int) -> None:
    """The normals of a body point out of it, those of the domain into it."""
    for i in range(bodies):
        volume = enclosed(part_of(surface, surface.markers == i))
        if volume <= 0.0:
            allowed = "a positive one: normals into the fluid"
            raise MeshError(f"body.{i}", f"facets that enclose a volume of {volume:.6g}", allowed, _MEND)
    volume = -enclosed(surface)
    if volume <= 0.0:
        allowed = "a positive one: normals of the domain's facets into it, and bodies smaller than it"
        raise MeshError("domain", f"facets around a fluid with a volume of {volume:.6g}", allowed, _MEND)


def first_crossing(points: FloatArray, facets: IntArray) -> tuple[int, int] | None:
    """Two of the ``facets`` (F, d) that cut through each other, None if no two do."""
    corners = points[facets]
    first, second = _near_facets(corners, facets)
    cross = facets_cross(corners[first], corners[second])
    return (int(first[cross][0]), int(second[cross][0])) if cross.any() else None


def _refuse_crossing(surface: Mesh, names: Sequence[str]) -> None:
    crossing = first_crossing(surface.points, surface.facets)
    if crossing is None:
        return
    a, b = crossing
    corners = surface.points[surface.facets]
    place = 0.5 * (corners[a].mean(axis=0) + corners[b].mean(axis=0))
    one, other = sorted((int(surface.markers[a]), int(surface.markers[b])))
    found = f"facets that cross {names[other] if other != one else 'each other'} near {_place(place)}"
    remedy = "Move the body, or choose a finer [mesh] size_body where two surfaces are near."
    raise MeshError(names[one], found, "surfaces that do not cross", remedy)


def _near_facets(corners: FloatArray, facets: IntArray) -> tuple[IntArray, IntArray]:
    """Pairs of facets without a common vertex whose boxes overlap, by number, each (P,)."""
    from scipy.spatial import cKDTree

    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    order = np.argsort(-radius, kind="stable")  # each looks for smaller ones, so that large ones are not met by all
    rank = np.argsort(order)
    found = cKDTree(centre).query_ball_point(centre, 2.0 * radius, return_sorted=True)
    second = np.concatenate([np.array(near, dtype=np.int64) for near in found])
    first = np.repeat(np.arange(len(centre)), [len(near) for near in found])
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    near = rank[first] < rank[second]
    near &= np.all((lower[first] <= upper[second]) & (lower[second] <= upper[first]), axis=1)
    first, second = first[near], second[near]
    shared = (facets[first][:, :, None] == facets[second][:, None]).any(axis=(1, 2))
    return first[~shared], second[~shared]


def facets_cross(first: FloatArray, second: FloatArray) -> BoolArray:
    """Which pairs of facets, corners (P, d, d) each, cut through each other, (P,)."""
    cross = np.zeros(len(first), dtype=bool)
    for one, other in permutations((first, second)):
        for k in range(one.shape[1] if one.shape[2] == 3 else 1):
            cross |= _edge_crosses(one[:, k], one[:, (k + 1) % one.shape[1]], other)
        if one.shape[2] == 2:
            break
    return cross


def _edge_crosses(start: FloatArray, end: FloatArray, facet: FloatArray) -> BoolArray:
    """Which edges from ``start`` to ``end`` (P, d) pass through the inside of a ``facet`` (P, d, d), (P,).

    Their ends are on two sides of it, and it is seen from the start around the edge's line.
    """
    sides = [np.sign(_volume(point, facet)) for point in (start, end)]
    if facet.shape[2] == 2:
        edge = np.stack([start, end], axis=1)
        around = [np.sign(_volume(facet[:, k], edge)) for k in range(2)]
        return (sides[0] * sides[1] < 0.0) & (around[0] * around[1] < 0.0)
    pairs = [np.stack([end, facet[:, k], facet[:, (k + 1) % 3]], axis=1) for k in range(3)]
    around = [np.sign(_volume(start, pair)) for pair in pairs]
    same = (around[0] == around[1]) & (around[1] == around[2]) & (around[0] != 0.0)
    return np.asarray((sides[0] * sides[1] < 0.0) & same)


def _volume(point: FloatArray, simplex: FloatArray) -> FloatArray:
    """Signed volume between a point (P, d) and a simplex (P, d, d), times d!, (P,)."""
    return np.asarray(np.linalg.det(simplex - point[:, None]))


def _within_reach(number: int, body: Body, bodies: Sequence[Body], pose: Pose) -> BoolArray:
    """Which other bodies' bounding balls overlap that of one, (n,)."""
    radii = np.array([other.bounding_radius for other in bodies])
    distance = np.linalg.norm(pose.position - pose.position[number], axis=1)
    distance[number] = np.inf
    return np.asarray(distance < radii + body.bounding_radius)


def _place(point: FloatArray) -> str:
    return np.array2string(point, precision=4)
