"""The first mesh: Netgen fills the domain around the bodies with simplices whose facets know their surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.mesher_unit import in_space, in_unit, mesher_unit
from rigidfluid.core.mesh.distribution import surface_vertices
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.cad_of_body import cad_of_body
from rigidfluid.core.mesh.generation.on_surfaces import put_on_surfaces
from rigidfluid.core.mesh.generation.periodic import identify, on_periodic_surfaces, with_exact_images
from rigidfluid.core.mesh.generation.refine_surface import edges_of_facets
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import REMEDY, check_mesh, orient
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.errors import MeshError, PluginError

ATTEMPTS = 8

_AT_POINTS = 2
"""Further attempts, with points in the edges that are still too long."""

ROUNDING = 1e-9
"""Relative excess over the longest edge allowed on a body that counts as rounding."""

_TOUCHING = 3e-7
"""Gap between two surfaces, over the mesher's unit, up to which Open CASCADE may take them for one."""


Finer = Sequence[tuple[FloatArray, float]]
"""Points (d,), and the longest edge wanted there [length]."""


@dataclass(frozen=True)
class EdgeLengths:
    """Lengths of edges asked of Netgen, in the unit of its shape: at most ``size``, growing by ``growth`` with the
    distance to where they are small [1], and no longer than at the points of ``finer``.

    There are ``per_radius`` edges to a radius of curvature; None leaves that to Netgen.
    """

    size: float
    growth: float
    finer: Finer = ()
    per_radius: float | None = None

    @classmethod
    def from_sizes(cls, sizes: Sizes, finer: Finer, unit: float) -> EdgeLengths:
        """Lengths away from bodies, over ``unit``."""
        near = [(in_unit(point, unit), float(in_unit(length, unit))) for point, length in finer]
        return cls(float(in_unit(sizes.size, unit)), sizes.growth, near)


def generate_mesh(fluid_domain: FluidDomain, sizes: Sizes, finer: Finer = ()) -> Mesh:
    """Mesh of the domain minus the bodies, Ω \\ ∪ B_i, the vertices of each surface's facets on that surface.

    The size of ``sizes`` is the longest edge wanted far from the bodies, size_body the longest allowed on them; edges
    are no longer than at the points of ``finer``. Gaps and regions are left to re-meshing. Markers are surface numbers:
    bodies 0 … n-1, then the domain's pieces. Raises MeshError where a body leaves the domain, or Netgen makes no valid
    mesh.
    """
    bodies, domain = len(fluid_domain.bodies), fluid_domain.domain
    refuse_bodies_outside(fluid_domain.pose, domain)
    asked, finer = _lengths_to_ask(fluid_domain, sizes, finer)
    mesh = put_back(orient(run_netgen(fluid_domain, sizes, asked, finer)), bodies, domain, curved=True)
    mesh = replace(mesh, points=points_on_bodies(mesh, fluid_domain))
    mesh = with_exact_images(mesh, bodies, domain)
    refuse_touching_bodies(mesh, fluid_domain)
    check_mesh(mesh, quality=0.0)
    return mesh


def _lengths_to_ask(fluid_domain: FluidDomain, sizes: Sizes, finer: Finer) -> tuple[FloatArray, Finer]:
    """The edge length on each body (n,) to ask Netgen for, so that its edges are at most size_body long, and points
    where they are to be ``finer`` [length].

    Netgen makes some longer than asked. The surfaces show it, at a tenth of a whole mesh's cost. A short arc next to a
    periodic surface may stay one edge, whatever is asked on the body, and is divided by a point in its middle.
    """
    size_body = sizes.size_body
    asked = np.full(len(fluid_domain.bodies), size_body)
    for attempt in range(ATTEMPTS + _AT_POINTS):
        surfaces = run_netgen(fluid_domain, sizes, asked, finer, surfaces_alone=True)
        excess = longest_edges(surfaces, len(fluid_domain.bodies)) / size_body
        if np.all(excess <= 1.0 + ROUNDING):
            return asked, finer
        if attempt < ATTEMPTS - 1:
            asked = np.where(excess > 1.0 + ROUNDING, 0.95 * asked / np.maximum(excess, 1.0), asked)
        else:
            finer = [*finer, *_in_long_edges(surfaces, len(fluid_domain.bodies), size_body)]
    worst = int(np.argmax(excess))
    found = f"a facet of length {excess[worst] * size_body:.4g}"
    raise MeshError(f"body.{worst}", found, f"at most size_body = {size_body:g}", REMEDY)


def _in_long_edges(mesh: Mesh, bodies: int, longest: float) -> Finer:
    """Middles of the edges on ``bodies`` that are longer than the ``longest`` [length], with half their length."""
    ends = mesh.points[edges_of_facets(mesh, mesh.markers < bodies)[0]]
    length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    long = length > (1.0 + ROUNDING) * longest
    return list(zip(ends[long].mean(axis=1), (0.5 * length[long]).tolist(), strict=True))


def longest_edges(mesh: Mesh, count: int) -> FloatArray:
    """Longest edge among each body's facets, (count,) [length]."""
    longest = np.zeros(count)
    for a, b in combinations(range(mesh.facets.shape[1]), 2):
        length = np.linalg.norm(mesh.points[mesh.facets[:, a]] - mesh.points[mesh.facets[:, b]], axis=1)
        on_body = mesh.markers < count
        np.maximum.at(longest, mesh.markers[on_body], length[on_body])
    return longest


def refuse_bodies_outside(pose: Pose, domain: Domain) -> None:
    """Raise MeshError for the first body whose centre is not inside the domain."""
    for i in np.flatnonzero(~domain.contains(pose.position)):
        lower, upper = (corner.tolist() for corner in domain.extent)
        allowed = f"inside the {domain.name} that reaches from {lower} to {upper}"
        remedy = "Move the body or enlarge the domain."
        raise MeshError(f"body.{i}.position", pose.position[i].tolist(), allowed, remedy)


def refuse_touching_bodies(mesh: Mesh, fluid_domain: FluidDomain) -> None:
    """Raise MeshError for the first body without facets of its own, or with a vertex on another surface that is not
    periodic."""
    count, domain = len(fluid_domain.bodies), fluid_domain.domain
    names = [f"body.{i}" for i in range(count)] + [repr(piece.name) for piece in domain.pieces]
    least = _TOUCHING * mesher_unit(domain.size)
    mesh = replace(mesh, markers=np.where(on_periodic_surfaces(mesh, count, domain), -1, mesh.markers))
    for i in range(count):
        mine = mesh.facets[mesh.markers == i]
        others = mesh.markers[np.isin(mesh.facets, mine).any(axis=1) & (mesh.markers != i) & (mesh.markers >= 0)]
        if len(others) or not len(mine):
            found = f"contact with {names[others[0]]}" if len(others) else "no surface of its own"
            allowed = f"a gap of more than {least:.2g} to all other surfaces, below which the mesher sees none"
            raise MeshError(f"body.{i}.position", found, allowed, "Move it.")


def run_netgen(
    fluid_domain: FluidDomain, sizes: Sizes, asked: FloatArray, finer: Finer = (), surfaces_alone: bool = False
) -> Mesh:
    """Mesh by Netgen, cells and facets or facets alone; ``asked`` (n,) is the target edge length on each body
    [length]."""
    from netgen import occ

    domain = fluid_domain.domain
    unit = mesher_unit(domain.size)
    try:
        shape = fluid_shape(fluid_domain, asked, unit)
    except (occ.OCCException, RuntimeError) as error:
        raise _netgen_failed(error) from error
    netgen = netgen_mesh(shape, domain.dimension, EdgeLengths.from_sizes(sizes, finer, unit), surfaces_alone)
    made = (surfaces_of if surfaces_alone else from_netgen)(netgen, domain.dimension)
    return replace(made, points=unit * made.points)


def netgen_mesh(shape: Any, dimension: int, lengths: EdgeLengths, surfaces_alone: bool = False) -> Any:
    """Netgen's mesh of a ``netgen.occ`` shape, or of its boundary alone."""
    from netgen import meshing, occ

    surfaces = meshing.MeshingStep.MESHEDGES if dimension == 2 else meshing.MeshingStep.MESHSURFACE
    rules: dict[str, Any] = {"perfstepsend": surfaces} if surfaces_alone else {}
    if lengths.per_radius is not None:
        rules["curvaturesafety"] = lengths.per_radius
    verbosity = meshing.SetMessageImportance(0)
    try:
        geometry = occ.OCCGeometry(shape, dim=dimension)
        parameters = meshing.MeshingParameters(
            maxh=lengths.size, grading=lengths.growth, parallel_meshing=False, **rules
        )
        for point, length in lengths.finer:
            parameters.RestrictH(*in_space(point), h=float(length))
        return geometry.GenerateMesh(parameters)
    except (occ.OCCException, meshing.NgException, RuntimeError) as error:
        raise _netgen_failed(error) from error
    finally:
        meshing.SetMessageImportance(verbosity)


def _netgen_failed(error: Exception) -> MeshError:
    found = f"Netgen failed ({str(error).strip()})"
    return MeshError("mesh", found, "bodies that neither overlap nor leave the domain", REMEDY)


def put_back(mesh: Mesh, bodies: int, domain: Domain, curved: bool) -> Mesh:
    """The mesh with the vertices on flat surfaces of the domain that are not periodic, or on all, exactly there; on all
    at once where several meet."""
    periodic = domain.periodic_pieces
    flat = [k for k, piece in enumerate(domain.pieces) if piece.shape.plane is not None and k not in periodic]
    chosen = list(range(len(domain.pieces))) if curved else flat
    belongs = np.zeros((len(mesh.points), len(chosen)), dtype=bool)
    for column, number in enumerate(chosen):
        belongs[surface_vertices(mesh, bodies + number), column] = True
    shapes = [domain.pieces[number].shape for number in chosen]
    return replace(mesh, points=put_on_surfaces(mesh.points, shapes, belongs))


def points_on_bodies(mesh: Mesh, fluid_domain: FluidDomain) -> FloatArray:
    """The mesh's points (N, d) with those of each body's facets exactly on its shape [length]."""
    points = mesh.points.copy()
    for i in range(len(fluid_domain.bodies)):
        vertices = surface_vertices(mesh, i)
        points[vertices] = fluid_domain.closest_points(i, points[vertices])
    return points


def fluid_shape(fluid_domain: FluidDomain, size_body: FloatArray, unit: float) -> Any:
    """The domain minus the bodies as a ``netgen.occ`` shape with lengths over ``unit``, whose faces (edges in 2D) are
    named by surface number."""
    from netgen import occ

    bodies, pose, domain = fluid_domain.bodies, fluid_domain.pose, fluid_domain.domain
    shape, placed = numbered_shape(domain, len(bodies), unit), []
    numbers, centres = images_in_box(fluid_domain)
    longest = in_unit(size_body, unit).tolist()
    for i, centre in zip(numbers.tolist(), in_unit(centres, unit), strict=True):
        placed.append(turned(cad_of_body(bodies[i], unit), pose.orientation[i]).Move(occ.Vec(*in_space(centre))))
        for side in sides(placed[-1], domain.dimension):
            side.name, side.maxh = str(i), longest[i]
    radius = np.array([bodies[i].bounding_radius for i in numbers])
    for group in groups_apart(radius, centres):  # one by one costs the square of their number
        shape = shape - (placed[group[0]] if len(group) == 1 else occ.Compound([placed[i] for i in group]))
    identify(sides(shape, domain.dimension), len(bodies), domain, unit)
    return shape


def images_in_box(fluid_domain: FluidDomain) -> tuple[IntArray, FloatArray]:
    """All bodies, and the images of them that reach into the box around the domain or touch it, as one touches a
    periodic surface: the body's number (c,) and the centre (c, d) of each [length]."""
    (lower, upper), position = fluid_domain.domain.extent, fluid_domain.pose.position
    near = _TOUCHING * mesher_unit(fluid_domain.domain.size)
    radius = np.array([body.bounding_radius for body in fluid_domain.bodies])[:, None]
    numbers, centres = [np.arange(len(position))], [position]
    for way in fluid_domain.images[1:]:
        moved = position + way
        reaches = np.flatnonzero(np.all((moved + radius > lower - near) & (moved - radius < upper + near), axis=1))
        numbers.append(reaches)
        centres.append(moved[reaches])
    return np.concatenate(numbers), np.concatenate(centres)


def groups_apart(radius: FloatArray, centres: FloatArray) -> list[list[int]]:
    """The numbers of all balls (N,) in groups of such that do not meet: OpenCASCADE takes no bodies that overlap in one
    compound."""
    groups: list[list[int]] = []
    for i in range(len(centres)):
        for group in groups:
            distance = np.linalg.norm(centres[group] - centres[i], axis=1)
            if (distance > radius[group] + radius[i]).all():
                group.append(i)
                break
        else:
            groups.append([i])
    return groups


def numbered_shape(domain: Domain, first: int, unit: float) -> Any:
    """The domain's CAD shape with lengths over ``unit``, its sides numbered from ``first`` on, as its pieces are."""
    shape = domain.cad_shape(unit)
    for side in sides(shape, domain.dimension):
        if side.name not in domain.names:
            found, key = f"a side of the CAD shape named {side.name!r}, by the type {domain.name!r}", "domain.type"
            raise PluginError(key, found, f"one of {', '.join(domain.names)}", "Name all sides in `cad_shape`.")
        side.name = str(first + domain.names.index(side.name))
    return shape


def sides(shape: Any, dimension: int) -> Any:
    """The parts of a shape's boundary: edges in 2D, faces in 3D."""
    return shape.edges if dimension == 2 else shape.faces


def turned(shape: Any, orientation: FloatArray) -> Any:
    """A shape rotated about the origin by an angle (2D) or a unit quaternion (3D)."""
    from netgen import occ

    if len(orientation) == 1:
        axis, angle = np.array([0.0, 0.0, 1.0]), orientation[0]
    else:
        axis, angle = orientation[1:], 2.0 * np.arctan2(np.linalg.norm(orientation[1:]), orientation[0])
    if angle == 0.0:
        return shape
    return shape.Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.Dir(*axis)), float(np.degrees(angle)))


def from_netgen(netgen: Any, dimension: int) -> Mesh:
    """Netgen's mesh as arrays; only vertices that a cell uses are kept."""
    surfaces = surfaces_of(netgen, dimension)
    cells, _ = elements(netgen.Elements2D() if dimension == 2 else netgen.Elements3D(), dimension + 1)
    used, compact = np.unique(cells, return_inverse=True)
    number = np.full(used.max() + 1, -1)
    number[used] = np.arange(len(used))
    cells = compact.reshape(cells.shape).astype(np.int64)
    return Mesh(np.ascontiguousarray(surfaces.points[used]), cells, number[surfaces.facets], surfaces.markers)


def surfaces_of(netgen: Any, dimension: int) -> Mesh:
    """All vertices of Netgen's mesh and its facets, without cells."""
    facets, regions = elements(netgen.Elements1D() if dimension == 2 else netgen.Elements2D(), dimension)
    # Until its cells are there, Netgen takes a plane mesh for one in space, whose edges are of codimension 2.
    name = netgen.GetBCName if netgen.dim == dimension else netgen.GetCD2Name
    markers = np.array([int(name(region)) for region in range(regions.max() + 1)], dtype=np.int64)
    points = netgen.Coordinates()[:, :dimension]
    return Mesh(points, np.empty((0, dimension + 1), dtype=np.int64), facets, markers[regions])


def elements(container: Any, corners: int) -> tuple[IntArray, IntArray]:
    """Vertex numbers (M, corners) and region numbers (M,) of Netgen's elements, both from 0."""
    table = container.NumPy()
    return table["nodes"][:, :corners].astype(np.int64) - 1, table["index"].astype(np.int64) - 1
