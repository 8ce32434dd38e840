"""Refuses surfaces that no mesher can fill between: open ones, crossing ones, bodies outside the domain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray
from rigidfluid.core.geometry.facets import enclosed_volume, place
from rigidfluid.core.geometry.ridges import ridges_of
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.distribution import surface_vertices
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

_MEND = "Mend the surface: each edge of a facet belongs to one other facet, all normals point to the same side."


def refuse_unfillable(surface: Mesh, fluid_domain: FluidDomain) -> None:
    """Refuse a closed surface of `surface_mesh` that a mesher would fail on, or never end with.

    The MeshError names the surface and the place: where it is open, where two cross, which body is outside or in
    another.
    """
    bodies, pose, domain = fluid_domain.bodies, fluid_domain.pose, fluid_domain.domain
    names = [*(f"body.{i}" for i in range(len(bodies))), *(f"domain surface {name!r}" for name in domain.names)]
    _refuse_open(surface, names)
    _refuse_inside_out(surface, len(bodies))
    _refuse_crossing(surface, names)
    for i in range(len(bodies)):
        mine = surface.points[surface_vertices(surface, i)]
        outside = mine[~domain.contains(mine)]
        if len(outside):
            allowed, remedy = f"all of it inside the {domain.name}", "Move the body or enlarge the domain."
            raise MeshError(f"body.{i}.position", f"a vertex outside, at {place(outside[:1])}", allowed, remedy)
        for k in np.flatnonzero(_overlaps_ball(i, fluid_domain)):
            if distance_to_body(pose, int(k), bodies[int(k)], mine[:1])[0] < 0.0:
                found = f"a vertex inside body.{k}, at {place(mine[:1])}"
                raise MeshError(f"body.{i}.position", found, "a body apart from all others", "Move it.")


def _refuse_open(surface: Mesh, names: Sequence[str]) -> None:
    ridges = ridges_of(surface.facets)
    wrong = np.flatnonzero((ridges.facets_at != 2) | (ridges.turn != 0))
    if len(wrong):
        facet = int(np.argmax((ridges.number == wrong[0]).any(axis=1)))
        found = f"a surface that is open, folded or turned over at {place(surface.points[ridges.corners[wrong[0]]])}"
        raise MeshError(names[surface.markers[facet]], found, "closed surfaces with normals into the fluid", _MEND)


def _refuse_inside_out(surface: Mesh, bodies: int) -> None:
    """The normals of a body point out of it, those of the domain into it."""
    for i in range(bodies):
        volume = enclosed_volume(surface.points, surface.facets[surface.markers == i])
        if volume <= 0.0:
            allowed = "a positive one: normals into the fluid"
            raise MeshError(f"body.{i}", f"facets that enclose a volume of {volume:.6g}", allowed, _MEND)
    volume = -enclosed_volume(surface.points, surface.facets)
    if volume <= 0.0:
        allowed = "a positive one: normals of the domain's facets into it, and bodies smaller than it"
        raise MeshError("domain", f"facets around a fluid with a volume of {volume:.6g}", allowed, _MEND)


def _refuse_crossing(surface: Mesh, names: Sequence[str]) -> None:
    from rigidfluid.core.geometry.crossings import first_crossing

    crossing = first_crossing(surface.points, surface.facets)
    if crossing is None:
        return
    pair = list(crossing)
    one, other = sorted(surface.markers[pair].tolist())
    where = place(surface.points[surface.facets[pair]].reshape(-1, surface.points.shape[1]))
    found = f"facets that cross {names[other] if other != one else 'each other'} near {where}"
    remedy = "Move the body, or choose a finer [mesh] size_body where two surfaces are near."
    raise MeshError(names[one], found, "surfaces that do not cross", remedy)


def _overlaps_ball(number: int, fluid_domain: FluidDomain) -> BoolArray:
    """Tell whether each other body's bounding ball overlaps that of one, (n,)."""
    position = fluid_domain.pose.position
    radii = np.array([body.bounding_radius for body in fluid_domain.bodies])
    distance = np.linalg.norm(position - position[number], axis=1)
    distance[number] = np.inf
    return np.asarray(distance < radii + radii[number])
