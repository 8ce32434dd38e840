"""Chooses where a periodic mesh is cut open: half-way between bodies and their images, so that each body is whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.images import periods
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mesh.adaptation.recut import Neighbours, neighbours, recut
from rigidfluid.core.mesh.adaptation.smooth_cut import find_cut, smooth_cut
from rigidfluid.core.mesh.distribution import surface_vertices
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.periodic import Seams, on_periodic_surfaces
from rigidfluid.core.mesh.generation.refine_surface import bisect, long_seam_edges, one_per_cell
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes
from rigidfluid.core.mesh.topology import distinct_edges
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Mesh, Periods
from rigidfluid.errors import MeshError

WELL_SHAPED = 0.3
"""Least quality of cells at the seam with which the mesh is not cut open elsewhere."""

MOST_ROUNDS = 3
"""Most often that edges at bodies are bisected to make room for seams in several directions."""

NEAR = 4.0
"""Bodies with a gap of at most so many of the cells on them have no seam between them, if that can be."""

_FARTHEST = 3
"""Largest number of periods along each way by which a cell is displaced."""


def is_badly_cut(mesh: Mesh, fluid_domain: FluidDomain, sizes: Sizes) -> bool:
    """Tell whether the seam crosses a body, has edges too long for what they face or bad cells next to it, which
    re-meshing cannot change, or a body's image on the mesh is not in the domain.

    ``fluid_domain`` is that around the images on the mesh.
    """
    bodies, domain = len(fluid_domain.bodies), fluid_domain.domain
    if bodies == 0:
        return False
    seam = on_periodic_surfaces(mesh, bodies, domain)
    on_seam = np.zeros(len(mesh.points), dtype=bool)
    on_seam[mesh.facets[seam]] = True
    if crosses_bodies(mesh, bodies, domain) or fluid_domain.periods_outside().any():
        return True
    if (cell_quality(mesh.points, mesh.cells[on_seam[mesh.cells].any(axis=1)]) < WELL_SHAPED).any():
        return True
    return len(long_seam_edges(mesh, fluid_domain, sizes, LONGEST)[0]) > 0


def crosses_bodies(mesh: Mesh, bodies: int, domain: Domain) -> bool:
    """Tell whether the seam crosses one of so many bodies."""
    seam = on_periodic_surfaces(mesh, bodies, domain)
    return bool(np.isin(mesh.facets[mesh.markers < bodies], mesh.facets[seam]).any())


def well_cut(mesh: Mesh, fluid_domain: FluidDomain, sizes: Sizes, winding: IntArray) -> Mesh:
    """The periodic mesh, cut open elsewhere if it is badly cut and can be.

    The bodies are so many periods ahead of the poses of ``fluid_domain``, ``winding`` (n, k). Raises MeshError where
    the seam crosses bodies and there is no better one.
    """
    kept = replace(mesh, periods=Periods(fluid_domain.domain.lattice, winding))
    if not is_badly_cut(mesh, fluid_domain, sizes):
        return kept
    must = crosses_bodies(mesh, len(fluid_domain.bodies), fluid_domain.domain)
    failures = []
    for reach, rounds in product((NEAR * sizes.size_body, 0.0), (0, MOST_ROUNDS)):
        try:
            return cut_around(mesh, fluid_domain, winding, reach, rounds)
        except MeshError as error:
            failures.append(error)
    if must:
        raise failures[0]
    return kept


class _Link(NamedTuple):
    """Two bodies with a ``gap`` [length] when the ``other`` is so many periods ``apart`` from where it is."""

    gap: float
    one: int
    other: int
    apart: tuple[int, ...]


def cut_around(mesh: Mesh, fluid_domain: FluidDomain, winding: IntArray, reach: float, rounds: int = 0) -> Mesh:
    """The mesh cut open so that those images of bodies are whole that are in the domain, each cell in the period of the
    nearest one.

    The bodies of the mesh are images of those of ``fluid_domain``, whose own poses are so many periods ahead of them,
    ``winding`` (n, k). Bodies with a gap of less than ``reach`` [length] get images next to each other if they
    can. Edges between others are bisected, so that no cell is at two of them; where seams in several directions do not
    fit, edges at bodies too, at most so many ``rounds``. Raises MeshError if no seam fits.
    """
    seams = Seams.from_domain(len(fluid_domain.bodies), fluid_domain.domain)
    wishes, together = _wishes(mesh, fluid_domain, seams, reach)
    mesh, wishes = _bisected(mesh, wishes, _between(mesh, wishes))
    for _ in range(rounds):
        _, conflicts = find_cut(*_wanted(mesh, wishes, seams))
        if not len(conflicts):
            break
        mesh, wishes = _bisected(mesh, wishes, _edges_at_bodies(mesh, wishes, seams, conflicts))
    bad = cell_quality(mesh.points, mesh.cells) < WELL_SHAPED
    made = recut(mesh, seams, smooth_cut(*_wanted(mesh, wishes, seams), bad))
    return replace(made, periods=Periods(seams.ways, winding + fluid_domain.periods_outside() - together))


class _Wishes(NamedTuple):
    """The ``shift`` (N, k) of all cells at a vertex that is ``on_body`` (N,), or an image of such a one."""

    on_body: BoolArray
    shift: IntArray

    def with_others(self, count: int) -> _Wishes:
        """The same with so many more vertices that are not on bodies."""
        none = np.zeros((count, self.shift.shape[1]), dtype=np.int64)
        return _Wishes(np.append(self.on_body, np.zeros(count, dtype=bool)), np.concatenate([self.shift, none]))


def _wishes(mesh: Mesh, fluid_domain: FluidDomain, seams: Seams, reach: float) -> tuple[_Wishes, IntArray]:
    """Shifts that make bodies whole, and by how many periods they are displaced from the domain to be next to others,
    (n, k)."""
    on_each = [surface_vertices(mesh, i) for i in range(len(fluid_domain.bodies))]
    place = _to_domain(mesh, fluid_domain, on_each, seams.ways)
    original, offset = seams.originals(mesh)
    body, total = _on_torus(on_each, original, place + offset)
    goal = [mesh.points[vertices] + place[vertices] @ seams.ways for vertices in on_each]
    together = _together(goal, reach, seams.ways)
    shift = total[original] - offset + together[np.maximum(body[original], 0)]
    return _Wishes(body[original] >= 0, shift), together


def _between(mesh: Mesh, wishes: _Wishes) -> IntArray:
    """Edges (E, 2) between bodies, or a body and its image, that want different shifts."""
    edges = distinct_edges(mesh.cells)
    one, other = edges.T
    differ = (wishes.shift[one] != wishes.shift[other]).any(axis=1)
    return np.asarray(edges[wishes.on_body[one] & wishes.on_body[other] & differ])


def _edges_at_bodies(mesh: Mesh, wishes: _Wishes, seams: Seams, cells: IntArray) -> IntArray:
    """Edges (E, 2) between the vertices of ``cells`` (C,) on bodies, or images of them, and others that are on none."""
    root, _ = seams.originals(mesh)
    chosen = np.zeros(len(mesh.points), dtype=bool)
    chosen[root[mesh.cells[cells]]] = True
    chosen = chosen[root] & wishes.on_body
    edges = distinct_edges(mesh.cells)
    one, other = edges.T
    return np.asarray(edges[(chosen[one] & ~wishes.on_body[other]) | (chosen[other] & ~wishes.on_body[one])])


def _bisected(mesh: Mesh, wishes: _Wishes, edges: IntArray) -> tuple[Mesh, _Wishes]:
    """The mesh with all ``edges`` (E, 2) bisected, and its wishes."""
    while len(edges):
        length = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1)
        now = one_per_cell(mesh.cells, edges, length, len(mesh.points))
        mesh = bisect(mesh, edges[now], mesh.points[edges[now]].mean(axis=1))
        wishes, edges = wishes.with_others(int(now.sum())), edges[~now]
    return mesh, wishes


def _wanted(mesh: Mesh, wishes: _Wishes, seams: Seams) -> tuple[IntArray, Neighbours, BoolArray]:
    """The shift (M, k) that each cell wants, pairs of neighbours, and which cells are at bodies (M,)."""
    at_body = np.asarray(wishes.on_body[mesh.cells].any(axis=1))
    shift = _nearest(mesh, wishes, seams.ways)
    first = np.argmax(wishes.on_body[mesh.cells[at_body]], axis=1)
    shift[at_body] = wishes.shift[mesh.cells[at_body, first]]
    return shift, neighbours(mesh, seams), at_body


def _to_domain(mesh: Mesh, fluid_domain: FluidDomain, on_each: Sequence[IntArray], ways: FloatArray) -> IntArray:
    """Periods (N, k) from each vertex on a body to where it is with the body's centre in the domain."""
    place = np.zeros((len(mesh.points), len(ways)), dtype=np.int64)
    outside, pose = fluid_domain.periods_outside(), fluid_domain.pose
    for i, (body, vertices) in enumerate(zip(fluid_domain.bodies, on_each, strict=True)):
        points = mesh.points[vertices]
        near = periods(pose.position[i] - points, ways)
        best = np.full(len(vertices), np.inf)
        for step in product((-1, 0, 1), repeat=len(ways)):
            tried = near + np.array(step)
            away = np.abs(distance_to_body(pose, i, body, points + tried @ ways))
            nearer = away < best
            place[vertices[nearer]], best[nearer] = tried[nearer] - outside[i], away[nearer]
    return place


def _on_torus(on_each: Sequence[IntArray], original: IntArray, total: IntArray) -> tuple[IntArray, IntArray]:
    """The body that each original is on, -1 for none, (N,), and the ``total`` (N, k) of its image there."""
    body, found = np.full(len(original), -1), np.zeros_like(total)
    for i, vertices in enumerate(on_each):
        body[original[vertices]] = i
        found[original[vertices]] = total[vertices]
    return body, found


def _together(goal: list[FloatArray], reach: float, ways: FloatArray) -> IntArray:
    """Periods (n, k) by which to displace bodies with vertices at ``goal`` (v, d) each, so that those nearer than
    ``reach`` are next to each other [length].

    A spanning forest by ascending gaps (Kruskal 1956, doi:10.1090/S0002-9939-1956-0078686-7): where a ring of near
    bodies spans a period, it is open where the gap is widest.
    """
    moved, group = np.zeros((len(goal), len(ways)), dtype=np.int64), np.arange(len(goal))
    for _, one, other, apart in sorted(_near(goal, reach, ways)):
        mine = group == group[other]
        if not mine[one]:
            moved[mine] += moved[one] + np.array(apart) - moved[other]
            group[mine] = group[one]
    return moved


def _near(goal: list[FloatArray], reach: float, ways: FloatArray) -> list[_Link]:
    """Links of bodies whose vertices, at ``goal`` (v, d) each, are nearer to each other than ``reach`` [length]."""
    links = []
    low, high = (np.array([edge(points, axis=0) for points in goal]) for edge in (np.min, np.max))
    trees = [scipy.spatial.cKDTree(points) for points in goal]
    for step in product((-1, 0, 1), repeat=len(ways)):
        way = np.array(step) @ ways
        for i in range(len(goal)):
            gap = np.maximum(low + way - high[i], low[i] - high - way).max(axis=1)
            for j in range(i + 1, len(goal)):
                if gap[j] >= reach:
                    continue
                nearest = float(np.min(trees[i].query(goal[j] + way, distance_upper_bound=reach)[0]))
                if nearest < reach:
                    links.append(_Link(nearest, i, j, step))
    return links


def _nearest(mesh: Mesh, wishes: _Wishes, ways: FloatArray) -> IntArray:
    """Shift (M, k) of each cell to the image of the nearest vertex on a body that its ``wishes`` ask for."""
    centres = mesh.points[mesh.cells].mean(axis=1)
    goal = mesh.points[wishes.on_body] + wishes.shift[wishes.on_body] @ ways
    margin = np.abs(ways).sum(axis=0)
    lower, upper = centres.min(axis=0) - margin, centres.max(axis=0) + margin
    points, shifts = [], []
    for step in product(range(-_FARTHEST, _FARTHEST + 1), repeat=len(ways)):
        image = goal - np.array(step) @ ways
        inside = np.all((image >= lower) & (image <= upper), axis=1)
        points.append(image[inside])
        shifts.append(np.tile(np.array(step), (int(inside.sum()), 1)))
    if not sum(map(len, points)):
        raise MeshError("mesh", "no body near its cells", "bodies a few periods away at most", "Shorten time.step.")
    _, nearest = scipy.spatial.cKDTree(np.concatenate(points)).query(centres)
    return np.asarray(np.concatenate(shifts)[nearest])
