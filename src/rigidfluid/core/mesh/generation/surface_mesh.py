"""The closed surface around the fluid, facets of the domain and of each placed body, before there are cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.mesher_unit import in_unit, mesher_unit
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.mechanics.frames import to_world
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import (
    ATTEMPTS,
    ROUNDING,
    EdgeLengths,
    longest_edges,
    netgen_mesh,
    put_back,
    run_netgen,
    sides,
    surfaces_of,
)
from rigidfluid.core.mesh.generation.refine_surface import (
    bisect,
    edges_of_facets,
    middles_on_surfaces,
    one_per_cell,
)
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes, wanted_size
from rigidfluid.core.mesh.topology import REMEDY
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.errors import MeshError


def surface_mesh(fluid_domain: FluidDomain, sizes: Sizes) -> Mesh:
    """Mesh without cells: all facets around the fluid, none longer than LONGEST times the wanted size, normals into the
    fluid.

    Shapes that have facets keep them; all others are meshed by Netgen, each on its own, their vertices exactly on them.
    Edges still too long, as those of walls near bodies, are halved. Markers are surface numbers: bodies 0 … n-1, then
    the domain's pieces. Raises MeshError where Netgen cannot mesh a shape.
    """
    bodies, domain, parts = fluid_domain.bodies, fluid_domain.domain, []
    for i, body in enumerate(bodies):
        own = _mesh_of_facets(body.facets) if body.facets is not None else _meshed_body(i, body, sizes)
        parts.append(
            replace(own, points=to_world(fluid_domain.pose, i, own.points), markers=np.full(len(own.facets), i))
        )
    if domain.facets is None:
        outer = _meshed_domain(domain, sizes)
    else:
        outer = put_back(_mesh_of_facets(domain.facets), 0, domain, curved=False)
    parts.append(replace(outer, markers=len(bodies) + outer.markers))
    return _halved(_joined(parts), fluid_domain, sizes)


def part_of(surface: Mesh, chosen: BoolArray) -> Mesh:
    """The ``chosen`` facets (F,) with their vertices."""
    used, compact = np.unique(surface.facets[chosen], return_inverse=True)
    facets = compact.reshape(-1, surface.facets.shape[1])
    return _without_cells(surface.points[used], facets, surface.markers[chosen])


def _mesh_of_facets(facets: Facets) -> Mesh:
    """The vertices that facets use, and the facets."""
    whole = _without_cells(facets.points, facets.vertices, facets.markers)
    return part_of(whole, np.ones(len(facets.vertices), dtype=bool))


def _without_cells(points: FloatArray, facets: IntArray, markers: IntArray) -> Mesh:
    d = points.shape[1]
    return Mesh(points, np.empty((0, d + 1), dtype=np.int64), facets.astype(np.int64), markers.astype(np.int64))


def _meshed_body(number: int, body: Body, sizes: Sizes) -> Mesh:
    """Facets of a body that has a CAD shape, in its own frame, no edge longer than size_body."""
    asked, unit = sizes.size_body, mesher_unit(2.0 * np.array([body.bounding_radius]))
    for _ in range(ATTEMPTS):
        shape = body.cad_shape(unit)
        for side in sides(shape, body.dimension):
            side.name = "0"
        lengths = EdgeLengths(float(in_unit(asked, unit)), sizes.growth)
        netgen = netgen_mesh(shape, body.dimension, lengths, surfaces_alone=True)
        found = surfaces_of(netgen, body.dimension)
        excess = float(longest_edges(found, 1)[0]) * unit / sizes.size_body
        if excess <= 1.0 + ROUNDING:
            surface = _mesh_of_facets(Facets(unit * found.points, found.facets, found.markers))
            return _into_fluid(replace(surface, points=body.closest_point(surface.points)), [body])
        asked *= 0.95 / excess
    edge = f"a facet of length {excess * sizes.size_body:.4g}"
    raise MeshError(f"body.{number}", edge, f"at most size_body = {sizes.size_body:g}", REMEDY)


def _meshed_domain(domain: Domain, sizes: Sizes) -> Mesh:
    """Facets of a domain that has a CAD shape; markers are the numbers of its pieces."""
    nobody = Pose(np.empty((0, domain.dimension)), np.empty((0, 1 if domain.dimension == 2 else 4)))
    found = run_netgen(FluidDomain([], nobody, domain, ()), sizes, np.empty(0), surfaces_alone=True)
    surface = put_back(_mesh_of_facets(Facets(found.points, found.facets, found.markers)), 0, domain, curved=True)
    return _into_fluid(surface, [piece.shape for piece in domain.pieces])


def _into_fluid(surface: Mesh, shapes: Sequence[Surface]) -> Mesh:
    """The same facets, with the normals of the shapes that they are on: Netgen's may point to either side."""
    normals, middles = area_vectors(surface.points, surface.facets), surface.points[surface.facets].mean(axis=1)
    along = np.empty(len(normals))
    for number, shape in enumerate(shapes):
        mine = surface.markers == number
        along[mine] = np.sum(normals[mine] * shape.normal(middles[mine]), axis=1)
    return replace(surface, facets=np.where(along[:, None] > 0.0, surface.facets, surface.facets[:, ::-1]))


def _joined(parts: Sequence[Mesh]) -> Mesh:
    first = np.cumsum([0, *(len(part.points) for part in parts)])
    return _without_cells(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.facets + start for part, start in zip(parts, first[:-1], strict=True)]),
        np.concatenate([part.markers for part in parts]),
    )


def _halved(surface: Mesh, fluid_domain: FluidDomain, sizes: Sizes) -> Mesh:
    """The surface with too long edges halved, the longest of each facet first, new vertices on the exact surface."""
    while True:
        edges, _ = edges_of_facets(surface, np.ones(len(surface.facets), dtype=bool))
        start, end = surface.points[edges[:, 0]], surface.points[edges[:, 1]]
        length = np.linalg.norm(end - start, axis=1)
        long = length > LONGEST * wanted_size(0.5 * (start + end), fluid_domain, sizes)
        if not long.any():
            return surface
        edges, length = edges[long], length[long]
        edges = edges[one_per_cell(surface.facets, edges, length, len(surface.points))]
        surface = bisect(surface, edges, middles_on_surfaces(surface, edges, fluid_domain))
