"""A new mesh around bodies that have moved: MMG re-meshes the fluid and keeps facets of bodies and curved walls."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.mesher_unit import mesher_unit, significant
from rigidfluid.core.mesh.adaptation.kept_cells import kept_cells
from rigidfluid.core.mesh.adaptation.mmg import Kept, run_mmg, with_kept_facets
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import put_back
from rigidfluid.core.mesh.generation.refine_films import refine_films
from rigidfluid.core.mesh.generation.refine_surface import (
    long_edges,
    on_kept_surfaces,
    refine_surface,
)
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes, edge_lengths
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes, wanted_size
from rigidfluid.core.mesh.topology import REMEDY, check_mesh, check_volume, distinct_edges, orient
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

GRADATIONS = (1.3, 1.4, 1.2)
"""Ratio of neighbouring edges that MMG may use: the first one, then the others where its mesh is not good."""

GOOD_QUALITY = 0.3
"""A re-made mesh is good, and the first one that is good is taken, when all its cells but those in films are above
this quality."""

WEDGED = 2.0
"""Kept cells are given up within so many longest edges of a bad cell between them."""

FLAT_IN_FILM = 1.0
"""A cell must be flat where the gap is at most so wide beside its longest edge."""

ROUNDS = 4
"""Largest number of times that cells are improved around edges that could not be bisected."""

WORST_QUALITY = 0.02
"""A re-made mesh with a cell at or below this quality is refused."""

LONGEST_EDGE = 2.5
"""A re-made mesh with an edge longer than this many times the wanted size is refused: MMG has done nothing."""


def remesh(
    mesh: Mesh,
    fluid_domain: FluidDomain,
    sizes: Sizes,
    layers: int = 0,
) -> Mesh:
    """Re-mesh the fluid to the wanted size h(x); vertices on bodies and curved walls keep their coordinates to the last
    bit.

    Their facets are kept too, in the same order and before those of flat surfaces, but those too long for the gap they
    face are bisected first. If that would invert a cell, the cells around the unbisected facets are improved before;
    facets that still do not fit after ROUNDS of it stay if they are within LONGEST_EDGE. MMG knows the wanted size at
    the vertices of the mesh that it is given alone, and sometimes leaves a sliver at a flat wall or in a thin film: if
    its mesh is far too coarse or has a bad cell, it is given that mesh again, with long edges in thin films bisected.
    So many ``layers`` of cells next to bodies are kept as far as they are good, and the flow there as it is. Raises
    MeshError where MMG fails, loses a facet or leaves a bad cell with every gradation.
    """
    size_at = partial(wanted_size, fluid_domain=fluid_domain, sizes=sizes)
    check_mesh(mesh, quality=0.0)
    new = best_remeshed(refine_surface(mesh, fluid_domain, sizes), fluid_domain, size_at, layers)
    excess = longest_relative_edge(new, size_at)
    for _ in range(ROUNDS):
        well_shaped = lowest_quality(new) > WORST_QUALITY and excess <= LONGEST_EDGE
        if well_shaped and not len(long_edges(new, fluid_domain, sizes, LONGEST)[0]):
            break
        refined = refine_films(refine_surface(new, fluid_domain, sizes), fluid_domain, sizes)
        new = best_remeshed(refined, fluid_domain, size_at, layers)
        excess = longest_relative_edge(new, size_at)
    check_mesh(new, quality=WORST_QUALITY)
    if excess > LONGEST_EDGE:
        found = f"an edge {excess:.3g} times longer than wanted after re-meshing"
        raise MeshError("mesh", found, f"at most {LONGEST_EDGE:g} times", REMEDY)
    return replace(new, periods=mesh.periods)


def best_remeshed(
    mesh: Mesh, fluid_domain: FluidDomain, size_at: Callable[[FloatArray], FloatArray], layers: int
) -> Mesh:
    """Re-mesh by MMG with the first gradation that gives good cells, else take the best of all gradations.

    Kept cells, so many ``layers``, are given up around bad ones first, as these are most often wedged between them;
    all are if no gradation gives good cells with the others kept.
    """
    made: list[Mesh] = []
    failures: list[MeshError] = []
    given, kept = Given.from_mesh(mesh, size_at), kept_cells(mesh, len(fluid_domain.bodies), size_at, layers)
    for cells, gradation in _tries(mesh, kept, fluid_domain, made):
        try:
            made.append(remeshed_once(mesh, fluid_domain, given, cells, gradation))
        except MeshError as error:
            failures.append(error)
        else:
            if not len(_bad_outside_films(made[-1], fluid_domain)):
                break
    if not made:
        raise failures[0]
    return max(made, key=lowest_quality)


def _tries(
    mesh: Mesh, kept: BoolArray, fluid_domain: FluidDomain, made: list[Mesh]
) -> Iterator[tuple[BoolArray, float]]:
    """Yield cells to keep (M,) and a gradation, one pair after the other until a mesh is good: all that are ``kept``,
    those away from bad cells of what was ``made`` so, none."""
    if kept.any():
        yield kept, GRADATIONS[0]
        others = kept
        if made:
            others = kept & _away(mesh, made[-1], _bad_outside_films(made[-1], fluid_domain))
        if others.any():
            for gradation in GRADATIONS if (others != kept).any() else GRADATIONS[1:]:
                yield others, gradation
    for gradation in GRADATIONS:
        yield np.zeros_like(kept), gradation


def _away(mesh: Mesh, made: Mesh, bad: IntArray) -> BoolArray:
    """Tell whether each cell of a ``mesh`` (M,) is farther than WEDGED of their longest edges from the ``bad`` cells
    (B,) of the mesh ``made``."""
    centres, away = mesh.points[mesh.cells].mean(axis=1), np.ones(len(mesh.cells), dtype=bool)
    reach = WEDGED * edge_lengths(made.points, made.cells[bad]).max(axis=1)
    for place, far in zip(made.points[made.cells[bad]].mean(axis=1), reach, strict=True):
        away &= np.linalg.norm(centres - place, axis=1) > far
    return away


class Given(NamedTuple):
    """A mesh as MMG is given it: ``mesh``, with rounded lengths over ``unit`` [length], and the sizes ``wanted``
    (N,) there over it [1]."""

    mesh: Mesh
    unit: float
    wanted: FloatArray

    @classmethod
    def from_mesh(cls, mesh: Mesh, size_at: Callable[[FloatArray], FloatArray]) -> Given:
        unit = mesher_unit(np.ptp(mesh.points, axis=0))
        scaled = rounded(replace(mesh, points=mesh.points / unit))
        return cls(scaled, unit, significant(size_at(unit * scaled.points) / unit))


def remeshed_once(mesh: Mesh, fluid_domain: FluidDomain, given: Given, cells: BoolArray, gradation: float) -> Mesh:
    """Re-mesh by one call of MMG, to which the mesh is ``given`` and which keeps these ``cells`` (M,), repair round-off
    and check the result."""
    bodies, kept = len(fluid_domain.bodies), Kept(on_kept_surfaces(mesh, fluid_domain), cells)
    made = run_mmg(given.mesh, kept, bodies, given.wanted, gradation)
    outer, made = ~on_kept_surfaces(made, fluid_domain), replace(made, points=given.unit * made.points)
    restored = with_kept_facets(made, outer, mesh, kept, given.unit * given.mesh.points)
    new = orient(put_back(restored, bodies, fluid_domain.domain, curved=False))
    check_mesh(new, quality=0.0)
    check_volume(new, float(cell_volumes(mesh.points, mesh.cells).sum()), "before re-meshing")
    return new


def rounded(mesh: Mesh) -> Mesh:
    """The mesh with its points rounded to a millionth of the shortest edge.

    MMG amplifies round-off to another mesh: two runs that agree to round-off shall get the same one.
    """
    shortest = float(edge_lengths(mesh.points, mesh.cells).min())
    unit = 2.0 ** (np.floor(np.log2(shortest)) - 20)
    return replace(mesh, points=np.round(mesh.points / unit) * unit)


def lowest_quality(mesh: Mesh) -> float:
    """Quality of the worst cell [1]."""
    return float(cell_quality(mesh.points, mesh.cells).min())


def _bad_outside_films(mesh: Mesh, fluid_domain: FluidDomain) -> IntArray:
    """Cells (B,) that are not good, but those as flat as the film they are in."""
    bad = np.flatnonzero(cell_quality(mesh.points, mesh.cells) <= GOOD_QUALITY)
    width = fluid_domain.gap_widths(mesh.points[mesh.cells[bad]].mean(axis=1))
    longest = edge_lengths(mesh.points, mesh.cells[bad]).max(axis=1)
    return np.asarray(bad[width > FLAT_IN_FILM * longest])


def longest_relative_edge(mesh: Mesh, size_at: Callable[[FloatArray], FloatArray]) -> float:
    """Longest edge over the size wanted at its middle, max |x_b - x_a| / h [1]."""
    edges = distinct_edges(mesh.cells)
    start, end = mesh.points[edges[:, 0]], mesh.points[edges[:, 1]]
    return float(np.max(np.linalg.norm(end - start, axis=1) / size_at(0.5 * (start + end))))
