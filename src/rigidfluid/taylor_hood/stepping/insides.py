"""Insides of the bodies that conduct a transported scalar: their matrices, which never change, and their values."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.conduction import Conduction, Inside
from rigidfluid.core.fluid.scalar import ScalarProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.mechanics.frames import to_body_frame, to_world
from rigidfluid.core.model.types import InsideFields, Pose
from rigidfluid.taylor_hood.elements.inside_space import InsideSpace
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.scalar_assembly import ScalarAssembly


class Insides:
    """All nodes inside bodies that conduct, body after body.

    ``spaces``: elements by the body's number; ``capacity`` and ``conductance`` (nodes, nodes): the matrices of c (T, v)
    and kκ (∇T, ∇v). Bodies of one shape share their elements. True if there are any such bodies.
    """

    def __init__(self, problem: ScalarProblem, assembly: Callable[[Numbering], ScalarAssembly]) -> None:
        self._problem = problem
        given = {n: one.conduction for n, one in enumerate(problem.conditions) if one.conduction is not None}
        insides = {body: one.inside() for body, one in given.items()}
        shapes = {id(inside): inside for inside in insides.values()}
        made = {key: _Elements.from_inside(inside, assembly) for key, inside in shapes.items()}
        elements = {body: made[id(inside)] for body, inside in insides.items()}
        self.spaces = {body: each.space for body, each in elements.items()}
        self.nodes = sum(space.nodes for space in self.spaces.values())
        self.capacity = _joined([elements[body].capacity(one) for body, one in given.items()])
        by_fluid = _joined([elements[body].conductance(one) for body, one in given.items()])
        self.conductance = sparse.csr_array(problem.diffusivity * by_fluid)

    def __bool__(self) -> bool:
        return bool(self.spaces)

    def start_values(self, pose: Pose) -> FloatArray:
        """Values (nodes,) at the start, when the bodies, or their images, are at ``pose``."""
        found = [np.zeros(0)]
        for body, space in self.spaces.items():
            given = self._problem.conditions[body].value or self._problem.initial
            found.append(given(0.0, to_world(pose, body, space.node_points)))
        return np.concatenate(found)

    def fields(self, values: FloatArray, pose: Pose) -> InsideFields:
        """The ``values`` (nodes,) in the cells inside all bodies, when these, or their images, are at ``pose``."""
        spaces = list(self.spaces.values())
        counts = [space.nodes for space in spaces]
        first = np.cumsum([0, *counts[:-1]])
        return InsideFields(
            points=np.concatenate([to_world(pose, body, space.node_points) for body, space in self.spaces.items()]),
            cells=np.concatenate([space.numbering.cell_nodes + n for space, n in zip(spaces, first, strict=True)]),
            scalar=values,
            body=np.repeat(list(self.spaces), counts),
        )

    def sampled(self, values: FloatArray, pose: Pose, points: FloatArray, lattice: Lattice) -> FloatArray:
        """The ``values`` (nodes,) at ``points`` (N, d), (N,), not numbers outside of the bodies that conduct and of
        their images by a ``lattice``."""
        found = np.full(len(points), np.nan)
        for (body, space), mine in zip(self.spaces.items(), self._nodes_of_bodies(), strict=True):
            centre = pose.position[body]
            own = to_body_frame(pose, body, centre + lattice.shortened(points - centre))
            inside, basis = space.held(own)
            found[inside] = basis @ values[mine]
        return found

    def means(self, on_surfaces: FloatArray, values: FloatArray) -> FloatArray:
        """Mean of ``values`` (nodes,) in each body that conducts, and that ``on_surfaces`` (surfaces,) of all else."""
        found, content = on_surfaces.copy(), self.capacity @ values
        weight = self.capacity @ np.ones(self.nodes)
        for body, mine in zip(self.spaces, self._nodes_of_bodies(), strict=True):
            found[body] = content[mine].sum() / weight[mine].sum()
        return found

    def _nodes_of_bodies(self) -> Iterator[slice]:
        """Nodes inside each body, in order."""
        first = 0
        for space in self.spaces.values():
            yield slice(first, first + space.nodes)
            first += space.nodes


@dataclass(frozen=True, eq=False)
class _Elements:
    """A ``space``, with its matrices of (T, v) and (∇T, ∇v), which all bodies of one shape share."""

    space: InsideSpace
    mass: sparse.csr_array
    stiffness: sparse.csr_array

    @classmethod
    def from_inside(cls, inside: Inside, assembly: Callable[[Numbering], ScalarAssembly]) -> _Elements:
        space = InsideSpace(inside)
        integrals, still = assembly(space.numbering), np.zeros_like(space.node_points)
        mass, stiffness = (integrals.scalar_matrix(space.geometry, *each, still) for each in ((1.0, 0.0), (0.0, 1.0)))
        return cls(space, mass, stiffness)

    def capacity(self, conduction: Conduction) -> sparse.csr_array:
        """Matrix of c (T, v), whose sum is the body's capacity."""
        return sparse.csr_array(conduction.capacity / self.mass.sum() * self.mass)

    def conductance(self, conduction: Conduction) -> sparse.csr_array:
        """Matrix of k (∇T, ∇v)."""
        return sparse.csr_array(conduction.conductivity * self.stiffness)


def _joined(parts: list[sparse.csr_array]) -> sparse.csr_array:
    return sparse.csr_array(sparse.block_diag(parts)) if parts else sparse.csr_array((0, 0))
