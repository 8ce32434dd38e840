"""Bodies at random in curved and irregular domains, and how well they come into a mesh."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from facet_domain import along_the_tube, bent_tube, irregular_outline

from rigidfluid.bodies.ellipsoid import Ellipsoid
from rigidfluid.bodies.facet_body import FacetBody
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.inserter import Inserter, Way
from rigidfluid.core.mesh.generation.meshing import EdgeLengths, netgen_mesh
from rigidfluid.core.mesh.generation.surface_mesh import surface_mesh
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.domains.stenosis import Stenosis

SAG = {2: 1.0 / 8.0, 3: 1.0 / 6.0}
"""How far the middle of a facet, an edge or an equilateral triangle with edges h, is off a surface of radius R, in
h²/R."""


@dataclass(frozen=True)
class Case:
    """Domain, how many bodies with which radii and gaps, where they may be, and the sizes of cells."""

    domain: Domain
    count: int
    radii: tuple[float, float]
    gap: float
    place: Callable[[np.random.Generator], FloatArray]
    sizes: Sizes


@dataclass(frozen=True)
class Outcome:
    """Of one arrangement: cells; quality of the worst one [1]; farthest vertex of a body from its shape [length];
    farthest middle of a facet, over what facets as long as the longest are off the narrowest curvature [1]; whether all
    surfaces are there; share of the vertices on walls that are not flat that are kept to the last bit [1]; relative
    change of those walls' area [1]; CPU time, that of Netgen's process included [s]."""

    cells: int
    quality: float
    vertices_off: float
    middles_off: float
    all_surfaces: bool
    kept: float
    area_change: float
    seconds: float


def stenosis() -> Stenosis:
    """A channel of 32 by 8, a throat of 1.75."""
    return Stenosis(Stenosis.Options(length=32.0, width=8.0, radius=3.125), 2)


def plane_case(domain: Domain, count: int = 20, size_body: float = 0.1) -> Case:
    def place(rng: np.random.Generator) -> FloatArray:
        return np.array([rng.uniform(-15.0, 15.0), rng.uniform(-4.5, 4.5)])

    return Case(domain, count, (0.25, 0.5), 0.12, place, Sizes(0.5, size_body))


def tube_case(count: int) -> Case:
    return Case(bent_tube(), count, (0.2, 0.35), 0.12, along_the_tube, Sizes(0.4, 0.08, 0.3))


CASES = {
    "stenosis, 20 bodies": lambda: plane_case(stenosis()),
    "irregular outline, 20 bodies": lambda: plane_case(irregular_outline()),
    "bent tube, 1 body": lambda: tube_case(1),
    "bent tube, 10 bodies": lambda: tube_case(10),
}


class Peanut(FacetBody):
    """A body of facets that is no plug-in."""

    name = "peanut"


def peanut() -> FacetBody:
    """Two balls and a box in one, of facets with sharp edges."""
    from netgen import occ

    balls = occ.Sphere(occ.Pnt(-0.2, 0, 0), 0.28) + occ.Sphere(occ.Pnt(0.2, 0, 0), 0.22)
    shape = balls + occ.Box(occ.Pnt(-0.05, -0.05, 0), occ.Pnt(0.05, 0.05, 0.45))
    netgen = netgen_mesh(shape, 3, EdgeLengths(0.08, 0.3), surfaces_alone=True)
    vertices = netgen.Elements2D().NumPy()["nodes"][:, :3].astype(np.int64) - 1
    used, compact = np.unique(vertices, return_inverse=True)
    facets = Facets(netgen.Coordinates()[used].copy(), compact.reshape(-1, 3), np.zeros(len(vertices), dtype=np.int64))
    return Peanut(PartOptions(), facets, "peanut")


def peanut_in_a_tube() -> tuple[Pose, Domain]:
    """Where it is, not turned, and what it is in."""
    return Pose(np.array([[-2.0, 0.1, 0.0]]), np.array([[1.0, 0.0, 0.0, 0.0]])), bent_tube()


def arranged(case: Case, seed: int) -> tuple[list[Body], Pose]:
    """Balls and ellipsoids in turn, none nearer than ``gap`` to anything."""
    rng, d = np.random.default_rng(seed), case.domain.dimension
    bodies: list[Body] = []
    places: list[FloatArray] = []
    while len(bodies) < case.count:
        at, radius = case.place(rng), rng.uniform(*case.radii)
        clear = radius + case.gap
        if not case.domain.contains(at[None])[0]:
            continue
        if min(np.linalg.norm(piece.shape.closest_point(at[None])[0] - at) for piece in case.domain.pieces) < clear:
            continue
        if any(np.linalg.norm(at - x) < clear + b.bounding_radius for x, b in zip(places, bodies, strict=True)):
            continue
        axes = [radius, *[radius * (0.5 if d == 2 else 0.6)] * (d - 1)]
        egg = len(bodies) % 2
        bodies.append(
            Ellipsoid(Ellipsoid.Options(semi_axes=axes), d) if egg else Sphere(Sphere.Options(radius=radius), d)
        )
        places.append(at)
    turn = rng.uniform(0.0, np.pi, (case.count, 1)) if d == 2 else rng.standard_normal((case.count, 4))
    return bodies, Pose(np.array(places), turn if d == 2 else turn / np.linalg.norm(turn, axis=1, keepdims=True))


def outcome(case: Case, seed: int, way: Way) -> Outcome:
    """What comes of one arrangement."""
    bodies, pose = arranged(case, seed)
    around = FluidDomain(bodies, pose, case.domain, surfaces_of(case.domain, len(bodies)))
    start = cpu_seconds()
    mesh = initial_mesh(around, case.sizes, Inserter(way))
    seconds = cpu_seconds() - start
    check_mesh(mesh, quality=0.0)
    facets = [mesh.facets[mesh.markers == i] for i in range(len(bodies))]
    off = [abs(distance_to_body(pose, i, b, mesh.points[np.unique(facets[i])])).max() for i, b in enumerate(bodies)]
    middles = [middles_off(mesh, facets[i], body, i, pose) for i, body in enumerate(bodies)]
    given, curved = surface_mesh(around, case.sizes), curved_walls(case.domain, len(bodies))
    before, after = (np.isin(m.markers, curved) for m in (given, mesh))
    return Outcome(
        len(mesh.cells),
        float(cell_quality(mesh.points, mesh.cells).min()),
        float(max(off)),
        float(max(middles)),
        np.array_equal(np.unique(mesh.markers), np.arange(len(bodies) + len(case.domain.pieces))),
        len(rows(given, before) & rows(mesh, after)) / len(rows(given, before)),
        abs(area(mesh, after) / area(given, before) - 1.0),
        seconds,
    )


def cpu_seconds() -> float:
    """Of this process and those that it has started and that have ended [s]."""
    of_others = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + of_others.ru_utime + of_others.ru_stime


def middles_off(mesh: Mesh, facets: IntArray, body: Body, number: int, pose: Pose) -> float:
    """The farthest middle of a body's facets, over what the longest would be off its narrowest curvature [1]."""
    corners = mesh.points[facets]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    assert body.semi_axes is not None
    narrowest = body.semi_axes.min() ** 2 / body.semi_axes.max()
    off = abs(distance_to_body(pose, number, body, corners.mean(axis=1))).max()
    return float(off / (SAG[body.dimension] * longest**2 / narrowest))


def curved_walls(domain: Domain, bodies: int) -> list[int]:
    """The numbers of the domain's surfaces that are not flat."""
    return [bodies + k for k, piece in enumerate(domain.pieces) if piece.shape.plane is None]


def rows(mesh: Mesh, chosen: FloatArray) -> set[tuple[float, ...]]:
    """The vertices of the ``chosen`` facets (F,), by their coordinates."""
    return set(map(tuple, mesh.points[np.unique(mesh.facets[chosen])].tolist()))


def area(mesh: Mesh, chosen: FloatArray) -> float:
    return float(np.linalg.norm(area_vectors(mesh.points, mesh.facets[chosen]), axis=1).sum())
