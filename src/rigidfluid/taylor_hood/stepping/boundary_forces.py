"""Forces of the fluid on the pieces of the domain's boundary, by consistent tractions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rigidfluid.core.fluid.conditions import BoundaryCondition
from rigidfluid.core.fluid.material import Material
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.boundary_forces import BoundaryForces
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.face import Face
from rigidfluid.taylor_hood.elements.facet_integrals import area_at_points, into_fluid, opposite_corners
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.stepping.nodal_stress import nodal_stress

_ONE_DIRECTION = 0.1
"""Least eigenvalue, over the greatest, of the directions that pieces at a node take: below it they are one surface."""


@dataclass(frozen=True, eq=False)
class BoundaryFlow:
    """A step's solution where it meets the boundary of the domain.

    ``mesh``: its facets and cells; ``points``, ``velocity`` (nodes, d) and ``pressure`` (vertices,) at the end of the
    step; ``reaction`` (nodes, d): force on the fluid where its velocity is held; ``raised``: by how much the state's
    pressure is above this one [force/length^(d-1)].
    """

    surfaces: Surfaces
    mesh: Mesh
    material: Material
    time: float
    points: FloatArray
    velocity: FloatArray
    pressure: FloatArray
    reaction: FloatArray
    raised: float

    @cached_property
    def force(self) -> FloatArray:
        """Force of the fluid at each node but for pressures that are given, (nodes, d): that of all its images."""
        found = np.zeros_like(self.reaction)
        np.add.at(found, self.surfaces.originals, -self.reaction)
        return found

    @cached_property
    def pressure_at_nodes(self) -> FloatArray:
        """The pressure at all nodes (nodes,)."""
        return self.surfaces.numbering.interpolate_to_nodes(self.pressure)


def boundary_forces(flow: BoundaryFlow) -> BoundaryForces:
    r"""Force of the fluid on each piece of the boundary, F = Σ f over its nodes, and its area.

    Parameters
    ----------
    flow : BoundaryFlow
        Solution of the step. The force f at a node is the residual of its equations, as on bodies.

    Returns
    -------
    BoundaryForces
        Zero on periodic pieces. The sum over all pieces and bodies is that of all f: the momentum that the fluid loses,
        with convection but for what the mesh leaves of the divergence.

    Notes
    -----
    A node of several pieces w gives each its ∫_w φ σ·n, of the stress in the cells there; what is missing of f after
    that, an error of the mesh, they share equally: along all directions where the velocity is held, along the normal
    where it slips, and across the normal where a pressure is given. Next to nothing is left beside these, at curved
    pieces, and is shared too.
    """
    surfaces = flow.surfaces
    first, count = len(surfaces.body_nodes), len(surfaces.faces)
    force, area = np.zeros((count, flow.points.shape[1])), np.zeros(count)
    taking = [face for face in surfaces.faces if not face.condition.is_seam]
    on = [np.unique(surfaces.originals[face.nodes]) for face in taking]
    is_shared = _counts(on, len(flow.points)) > 1
    sides = [_Side.from_face(face, flow) for face in taking]
    number = [face.condition.surface - first for face in taking]
    for piece, nodes, side in zip(number, on, sides, strict=True):
        force[piece] = flow.force[nodes[~is_shared[nodes]]].sum(axis=0) - side.given_load(flow)
        area[piece] = side.area
    force[number] += _shares(sides, is_shared, flow)
    total = surfaces.ranks.sum(np.column_stack([force, area]))
    return BoundaryForces(total[:, :-1], total[:, -1])


def _counts(on: list[IntArray], nodes: int) -> IntArray:
    """Number of pieces that each node is on, (nodes,)."""
    return np.bincount(np.concatenate([*on, np.empty(0, np.int64)]), minlength=nodes)


def _shares(sides: list[_Side], is_shared: BoolArray, flow: BoundaryFlow) -> FloatArray:
    """Force (w, d) on each of w pieces at the nodes that it shares with others."""
    shared, d = np.flatnonzero(is_shared), flow.points.shape[1]
    place, count = np.full(len(is_shared), -1), len(shared)
    place[shared] = np.arange(count)
    direct, taken = np.zeros((len(sides), count, d)), np.zeros((len(sides), count, d, d))
    for number, side in enumerate(sides):
        direct[number] = side.tractions(flow, place, count)
        taken[number] = side.directions(flow, place, count)
    missing = flow.force[shared] - direct.sum(axis=0)
    inverse = np.linalg.pinv(taken.sum(axis=0), rcond=_ONE_DIRECTION, hermitian=True)
    shares = np.einsum("wsij,sjk,sk->wsi", taken, inverse, missing)
    there = np.asarray(taken.any(axis=(2, 3)))[:, :, None]
    shares += there / np.maximum(there.sum(axis=0), 1) * (missing - shares.sum(axis=0))
    return np.asarray((direct + shares).sum(axis=1))


@dataclass(frozen=True, eq=False)
class _Side:
    """A piece as its ``cells`` (F,) see it: the ``nodes`` (F, 3 | 6) of their facets, and there, at Gauss' points, the
    nodes' functions ``shapes`` (q, 3 | 6) and ``areas`` n dA (F, q, d), n into the fluid [length^(d-1)]."""

    face: Face
    cells: IntArray
    nodes: IntArray
    shapes: FloatArray
    areas: FloatArray

    @classmethod
    def from_face(cls, face: Face, flow: BoundaryFlow) -> _Side:
        """Side of a ``face``, whose facets are turned into the fluid."""
        mesh, numbering = flow.mesh, flow.surfaces.numbering
        near = np.flatnonzero(np.isin(mesh.cells, face.facets).sum(axis=1) >= mesh.points.shape[1])
        facets = into_fluid(face.facets, mesh.cells[near], mesh.points)
        opposite = opposite_corners(facets, mesh.cells[near], len(mesh.points))
        nodes = numbering.facet_nodes(facets)
        return cls(face, near[opposite // mesh.cells.shape[1]], nodes, *area_at_points(flow.points[nodes]))

    @property
    def area(self) -> float:
        """The whole area [length^(d-1)]."""
        return float(np.linalg.norm(self.areas, axis=2).sum())

    def given_load(self, flow: BoundaryFlow) -> FloatArray:
        """∫ p n (d,) of what is known of the pressure: all of it where it is given, its shift elsewhere."""
        shift = flow.raised * self.areas.sum(axis=(0, 1))
        if self.face.condition.prescribes_normal:
            return np.asarray(shift)
        return np.asarray(shift + self.face.pressure_load(flow.time, flow.points).sum(axis=(0, 1)))

    def tractions(self, flow: BoundaryFlow, place: IntArray, count: int) -> FloatArray:
        """∫ φ σ·n (count, d) for nodes with a ``place`` (nodes,) of 0 or more, of that part which holds velocities."""
        at = place[flow.surfaces.originals[self.nodes]]
        near = np.flatnonzero((at >= 0).any(axis=1))
        around, nodes = flow.surfaces.numbering.cell_nodes[self.cells[near]], self.nodes[near]
        of_cells = flow.points[around], flow.velocity[around], flow.pressure_at_nodes[around]
        stress = nodal_stress(*of_cells, flow.material).stress
        corner = np.argmax(around[:, None, :] == nodes[:, :, None], axis=2)
        on_facets = np.take_along_axis(stress, corner[:, :, None, None], axis=1)
        forces = np.einsum("qa,faij,fqj->fqi", self.shapes, on_facets, self.areas[near])
        forces = _held_part(self.face.condition, forces, _unit(self.areas[near]))
        return _gathered(np.einsum("qa,fqi->fai", self.shapes, forces), at[near], count)

    def directions(self, flow: BoundaryFlow, place: IntArray, count: int) -> FloatArray:
        """Projectors (count, d, d) onto the directions along which the piece holds velocities, for the same nodes; zero
        where it has none."""
        at = place[flow.surfaces.originals[self.face.nodes]]
        on, normal = at[at >= 0], self.face.condition.normal
        if normal is None:
            weighed = np.einsum("qa,qa,fqi->fai", self.shapes, self.shapes, self.areas)
            normals = _unit(_gathered(weighed, place[flow.surfaces.originals[self.nodes]], count)[on])
        else:
            normals = np.broadcast_to(normal, (len(on), len(normal)))
        d = flow.points.shape[1]
        found = np.zeros((count, d, d))
        found[on] = _held_part(self.face.condition, np.eye(d), normals[:, None])
        return found


def _held_part(condition: BoundaryCondition, vectors: FloatArray, normals: FloatArray) -> FloatArray:
    """The part of ``vectors`` (…, d) along which a ``condition`` holds velocities, by unit ``normals`` (…, d)."""
    across = np.sum(vectors * normals, axis=-1, keepdims=True) * normals
    return np.asarray(condition.prescribes_normal * across + condition.prescribes_tangential * (vectors - across))


def _gathered(values: FloatArray, at: IntArray, count: int) -> FloatArray:
    """Sums (count, d) of ``values`` (F, a, d) in the places ``at`` (F, a), those below 0 left out."""
    found = np.zeros((count, values.shape[2]))
    np.add.at(found, at[at >= 0], values[at >= 0])
    return found


def _unit(vectors: FloatArray) -> FloatArray:
    """Unit vectors (…, d) along others; zero along zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0))
