"""Nodes of a transported scalar on one topology: which are held, follow a body's value, or are images of others."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, partial

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.scalar import ScalarProblem
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.frames import to_body_frame
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.taylor_hood.elements.face import Face
from rigidfluid.taylor_hood.elements.facet_integrals import area_at_points
from rigidfluid.taylor_hood.elements.inside_space import InsideSpace, traces
from rigidfluid.taylor_hood.elements.surfaces import Surfaces


class ScalarSurfaces:
    """Values of the scalar = P · (free values, one of each lumped body, those inside bodies that conduct) + held ones.

    Parameters
    ----------
    problem : ScalarProblem
        Conditions on all surfaces, bodies first.
    surfaces : Surfaces
        Nodes on bodies and faces.
    mesh : Mesh
        Its facets say where they are.
    insides : mapping of int to InsideSpace
        Elements inside the bodies that conduct, by their numbers.
    """

    def __init__(
        self, problem: ScalarProblem, surfaces: Surfaces, mesh: Mesh, insides: Mapping[int, InsideSpace]
    ) -> None:
        self._problem, self.faces, self._insides = problem, surfaces.faces, insides
        self.first_face = len(surfaces.body_nodes)
        numbering, nodes = surfaces.numbering, [*surfaces.body_nodes, *(face.nodes for face in surfaces.faces)]
        self.nodes: list[IntArray] = nodes
        """Nodes on each surface."""
        facets = [mesh.facets[mesh.markers == surface] for surface in range(len(nodes))]
        self.facet_nodes: list[IntArray] = [numbering.facet_nodes(some) for some in facets]
        self.owner = np.full(numbering.nodes, -1)
        """Surface that fixes the value of each node; -1 where it is free (nodes,)."""
        for surface in reversed(range(len(nodes))):
            if problem.conditions[surface].is_solved or self._holds(surface):
                self.owner[nodes[surface]] = surface
        self._place(surfaces.originals)

    def _holds(self, surface: int) -> bool:
        """Tell whether the surface holds a value: one through which the fluid goes as it likes does not."""
        given = self._problem.conditions[surface]
        return given.value is not None and not given.is_solved and self._open_face(surface) is None

    def _open_face(self, surface: int) -> Face | None:
        face = self.faces[surface - self.first_face] if surface >= self.first_face else None
        return face if face is not None and face.condition.is_open else None

    def _place(self, originals: IntArray) -> None:
        """Lay out P: free nodes first, then lumped bodies, then insides; images have the values of their originals."""
        count, lumped = len(self.owner), self.lumped
        column = np.full(count, -1)
        free = np.flatnonzero((self.owner < 0) & (originals == np.arange(count)))
        column[free] = np.arange(len(free))
        for number, body in enumerate(lumped):
            column[self.owner == body] = len(free) + number
        column = np.where((self.owner < 0) & (originals != np.arange(count)), column[originals], column)
        rows = np.flatnonzero(column >= 0)
        entries = np.ones(len(rows)), (rows, column[rows])
        self.first_lumped, self.first_inside = len(free), len(free) + len(lumped)
        self._unknowns = self.first_inside + sum(inside.nodes for inside in self._insides.values())
        self._prolongation = sparse.csr_array(entries, shape=(count, self._unknowns))
        self.representative = np.concatenate([free, [self.nodes[body][0] for body in lumped]]).astype(np.int64)
        """A node with the value of each unknown but those inside bodies (first_inside,)."""

    def prolongation(self, node_points: FloatArray, pose: Pose) -> sparse.csr_array:
        """P (nodes, unknowns) where nodes are at ``node_points`` (nodes, d) and bodies, or their images, at ``pose``.

        Nodes on a body that conducts follow what is inside of it at their place.
        """
        if not self._insides:
            return self._prolongation
        rows, columns, values, first = list[IntArray](), list[IntArray](), list[FloatArray](), self.first_inside
        for body, inside in self._insides.items():
            facets = self.facet_nodes[body]
            nodes, found = traces(facets, node_points[facets], partial(_basis_in_world, inside, pose, body))
            entries = found.tocoo()
            mine = self.owner[nodes[entries.row]] == body
            rows.append(nodes[entries.row[mine]])
            columns.append(first + entries.col[mine])
            values.append(entries.data[mine])
            first += inside.nodes
        places = np.concatenate(rows), np.concatenate(columns)
        on_bodies = sparse.csr_array((np.concatenate(values), places), shape=self._prolongation.shape)
        return sparse.csr_array(self._prolongation + on_bodies)

    @cached_property
    def lumped(self) -> IntArray:
        """The bodies that have one value each."""
        return np.array([n for n, one in enumerate(self._problem.conditions) if one.is_lumped], dtype=np.int64)

    @cached_property
    def is_held(self) -> BoolArray:
        """Tell whether the value of each node is given (nodes,)."""
        return np.asarray((self.owner >= 0) & ~np.isin(self.owner, [*self.lumped, *self._insides]))

    @cached_property
    def capacities(self) -> FloatArray:
        """Capacity of each lumped body [length^d]."""
        return np.array([self._problem.conditions[body].capacity for body in self.lumped], dtype=float)

    @cached_property
    def open_faces(self) -> list[tuple[int, Face]]:
        """Faces, with their numbers, through which the fluid carries the scalar and no value is held."""
        found = []
        for number, face in enumerate(self.faces, self.first_face):
            if face.condition.passes and not self._holds(number):
                found.append((number, face))
        return found

    def held_values(self, time: float, node_points: FloatArray) -> FloatArray:
        """Values (nodes,) where they are held, and zero elsewhere."""
        values = np.zeros(len(node_points))
        for surface, condition in enumerate(self._problem.conditions):
            nodes = np.flatnonzero(self.owner == surface)
            if condition.value is not None and not condition.is_solved and len(nodes):
                values[nodes] = condition.value(time, node_points[nodes])
        return values

    def start_values(self, node_points: FloatArray) -> FloatArray:
        """Values (nodes,) at the start; zero on bodies that conduct."""
        problem, held = self._problem, self.held_values(0.0, node_points)
        values = np.where(self.owner < 0, problem.initial(0.0, node_points), held)
        for body in self.lumped:
            value = problem.conditions[body].value
            given = problem.initial if value is None else value
            nodes = self.owner == body
            values[nodes] = given(0.0, node_points[nodes]).mean()
        return values

    def given_fluxes(self, time: float, node_points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Load (nodes,) of the fluxes that are given, and their sums over each surface (surfaces,)."""
        load, sums = np.zeros(len(node_points)), np.zeros(len(self.nodes))
        for surface, condition in enumerate(self._problem.conditions):
            if condition.flux is None:
                continue
            nodes = self.facet_nodes[surface]
            shapes, measure = _measured(node_points[nodes])
            where = np.einsum("qi,fid->fqd", shapes, node_points[nodes])
            density = condition.flux(time, where.reshape(-1, where.shape[2])).reshape(measure.shape)
            each = (density * measure) @ shapes
            np.add.at(load, nodes, each)
            sums[surface] = each.sum()
        return load, sums

    def means(self, node_points: FloatArray, values: FloatArray) -> FloatArray:
        """Mean of ``values`` (nodes,) on each surface (surfaces,)."""
        found = np.zeros(len(self.nodes))
        for surface, nodes in enumerate(self.facet_nodes):
            shapes, measure = _measured(node_points[nodes])
            whole = measure.sum()
            found[surface] = np.sum(measure * (values[nodes] @ shapes.T)) / whole if whole > 0.0 else 0.0
        return found


def _basis_in_world(inside: InsideSpace, pose: Pose, body: int, points: FloatArray) -> sparse.csr_array:
    """Functions inside a body at ``points`` (N, d) of the world, (N, nodes)."""
    return inside.basis(to_body_frame(pose, body, points))


def _measured(facet_points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gauss' rule on each facet: the nodes' functions at its points (q, 3 | 6), and the area of each (F, q)."""
    shapes, area = area_at_points(facet_points)
    return shapes, np.asarray(np.linalg.norm(area, axis=2))
