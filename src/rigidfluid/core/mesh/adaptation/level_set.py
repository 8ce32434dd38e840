"""The first mesh by cutting: MMG cuts bodies out of a mesh of the domain along the zero level of their distance.

Here for comparison with `fill_mesh`, which keeps edges and corners of bodies; a cut rounds them to first order.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.mesher_unit import mesher_unit
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.adaptation.mmg import from_mmg, keep_facets, mmg_mesh, run_mmg, with_kept_facets
from rigidfluid.core.mesh.adaptation.signals import kept_signals
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.fill import fill_between
from rigidfluid.core.mesh.generation.meshing import points_on_bodies
from rigidfluid.core.mesh.generation.surface_mesh import part_of, surface_mesh
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.size.size_field import Sizes, wanted_size
from rigidfluid.core.mesh.topology import REMEDY, boundary_facets, check_mesh, orient
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

ADAPTATIONS = 4
"""Number of times that MMG brings the domain's mesh nearer to the wanted size before it cuts."""

GRADATION = 1.3
"""Ratio of neighbouring edges that MMG may use."""

CUT = 9
"""Marker that `from_mmg` gives to the facets of a cut; those of surfaces are shifted beyond it meanwhile."""

FLUID, SOLID = 2, 3
"""References that MMG gives to the cells outside and inside the bodies."""

DEVIATION = {2: 0.01, 3: 0.25}
"""Largest distance of a cut's facets from the level that MMG interpolates, over size_body, by dimension."""

ROUNDS = 12
"""Largest number of times that vertices are moved towards the shapes, and cells improved."""

LEAST_QUALITY = 0.1
"""Moving vertices onto the shapes leaves cells at this quality, or at half of what they had if that was less."""

LEAST_SHARE = 1e-3
"""A vertex that can move less than this of its way stays where it is."""

ON_SHAPE = 1e-12
"""A vertex is on its shape when it is nearer than this, over size_body."""

CHORD = 0.25
"""A facet whose middle is farther off the shape than this, over its longest edge, cuts through the body."""


def level_set_mesh(fluid_domain: FluidDomain, sizes: Sizes, timeout: float) -> Mesh:
    """Mesh of the domain minus the bodies, {x ∈ Ω: min_i d_i(x) > 0}, its facets on bodies cut by MMG.

    The domain's facets, halved near bodies, stay. Vertices of the cut are moved onto the exact shapes as far as the
    cells allow, cells are improved, and so on until all are there: the way of Van Landeghem et al., appendix, with the
    vertices put back onto the shapes. Markers are surface numbers: bodies 0 … n-1, then the domain's pieces. Raises
    MeshError where MMG fails, the domain is not filled within ``timeout`` [s], a body gets no facets, or vertices do
    not come onto their shape.
    """

    def size_at(points: FloatArray) -> FloatArray:
        return wanted_size(points, fluid_domain, sizes)

    surface = surface_mesh(fluid_domain, sizes)
    outer = part_of(surface, surface.markers >= len(fluid_domain.bodies))
    mesh = background = fill_between(outer, sizes, timeout)
    if not fluid_domain.bodies:
        return background
    for _ in range(ADAPTATIONS):
        mesh = orient(_improved(mesh, size_at(mesh.points)))
    mesh = _cut(mesh, fluid_domain, size_at(mesh.points), DEVIATION[fluid_domain.domain.dimension] * sizes.size_body)
    for _ in range(ROUNDS):
        target = points_on_bodies(mesh, fluid_domain)
        mesh = replace(mesh, points=_move_within_quality(mesh, target))
        mesh = orient(_improved(mesh, size_at(mesh.points)))
        off = np.linalg.norm(points_on_bodies(mesh, fluid_domain) - mesh.points, axis=1)
        if off.max() <= ON_SHAPE * sizes.size_body:
            break
    else:
        body = mesh.markers[(mesh.facets == off.argmax()).any(axis=1)][0]
        found = f"vertices up to {off.max():.3g} off the shape after cutting"
        raise MeshError(f"body.{body}", found, "all on it", "Use mesh.inserter = 'fill'.")
    mesh = replace(mesh, points=points_on_bodies(mesh, fluid_domain))
    kept = keep_facets(background, np.ones(len(background.facets), dtype=bool))
    mesh = orient(with_kept_facets(mesh, mesh.markers < len(fluid_domain.bodies), background, kept, background.points))
    _refuse_chords(mesh, fluid_domain)
    check_mesh(mesh, quality=0.0)
    return mesh


def _improved(mesh: Mesh, metric: FloatArray) -> Mesh:
    """Re-mesh by MMG to the wanted size ``metric`` (N,) [length], with all facets kept."""
    unit = mesher_unit(np.ptp(mesh.points, axis=0))
    given = replace(mesh, points=mesh.points / unit)
    made = run_mmg(given, keep_facets(mesh, np.ones(len(mesh.facets), dtype=bool)), 0, metric / unit, GRADATION)
    return replace(made, points=unit * made.points)


def _cut(mesh: Mesh, fluid_domain: FluidDomain, metric: FloatArray, deviation: float) -> Mesh:
    """The fluid's part of a mesh that is cut along the bodies, facets there marked by the nearest body."""
    unit, d = mesher_unit(np.ptp(mesh.points, axis=0)), mesh.points.shape[1]
    shifted = replace(mesh, points=mesh.points / unit, markers=mesh.markers + CUT + 1)
    mmg = mmg_mesh(shifted, keep_facets(mesh, np.ones(len(mesh.facets), dtype=bool)), 0, metric / unit)
    mmg.set_multi_materials([{"ref": 0, "split": 1, "ref_minus": SOLID, "ref_plus": FLUID}])
    level = fluid_domain.body_distances(mesh.points).min(axis=0)
    try:
        with kept_signals():
            mmg.remesh_levelset(level[:, None] / unit, verbose=-1, hgrad=GRADATION, hausd=deviation / unit)
    except RuntimeError as error:
        raise MeshError("mesh.inserter", f"MMG failed to cut ({error})", "bodies it can cut", REMEDY) from error
    _, sides = mmg.get_triangles_with_refs() if d == 2 else mmg.get_tetrahedra_with_refs()
    made = from_mmg(mmg, d)
    used, cells = np.unique(made.cells[sides == FLUID], return_inverse=True)
    points, cells = unit * made.points[used], cells.reshape(-1, d + 1)
    facets = boundary_facets(cells)
    marks = dict(zip(map(tuple, np.sort(made.facets, axis=1).tolist()), made.markers.tolist(), strict=True))
    markers = np.array([marks.get(tuple(facet), CUT) for facet in used[facets].tolist()]) - CUT - 1
    on_cut = markers < 0
    nearest = np.abs(fluid_domain.body_distances(points[facets[on_cut]].mean(axis=1))).argmin(axis=0)
    markers[on_cut] = nearest
    for i in np.setdiff1d(np.arange(len(fluid_domain.bodies)), nearest):
        raise MeshError(f"body.{i}", "no facet of its own after the cut", "one at least", REMEDY)
    return orient(Mesh(points, cells, facets, markers))


def _move_within_quality(mesh: Mesh, target: FloatArray) -> FloatArray:
    """Points (N, d) moved towards ``target`` (N, d), each halfway back as long as it spoils a cell."""
    share, points = np.ones((len(target), 1)), target
    allowed = np.minimum(LEAST_QUALITY, 0.5 * cell_quality(mesh.points, mesh.cells))
    while (bad := cell_quality(points, mesh.cells) < allowed).any():
        back = np.unique(mesh.cells[bad])
        share[back] = np.where(share[back] < LEAST_SHARE, 0.0, 0.5 * share[back])
        points = np.where(share == 1.0, target, mesh.points + share * (target - mesh.points))
    return points


def _refuse_chords(mesh: Mesh, fluid_domain: FluidDomain) -> None:
    """All vertices may be on a shape and a facet still cut through it; of shapes with corners all facets there do."""
    for i, body in enumerate(fluid_domain.bodies):
        if body.facets is not None:
            continue
        corners = mesh.points[mesh.facets[mesh.markers == i]]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        off = np.abs(distance_to_body(fluid_domain.pose, i, body, corners.mean(axis=1))) / longest
        if off.max() > CHORD:
            found = f"a facet whose middle is {off.max():.3g} of its length off the shape"
            raise MeshError(f"body.{i}", found, f"at most {CHORD:g}", "Use mesh.inserter = 'fill'.")
