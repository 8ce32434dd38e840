"""Insides of the bodies that conduct a transported scalar: their matrices, which never change, and their values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.conduction import Conduction
from rigidfluid.core.fluid.scalar import ScalarProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.frames import to_world
from rigidfluid.core.model.types import Pose
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
        shared = {id(one.inside()): InsideSpace(one.inside()) for one in given.values()}
        self.spaces = {body: shared[id(one.inside())] for body, one in given.items()}
        self.nodes = sum(space.nodes for space in self.spaces.values())
        parts = [_matrices(one, self.spaces[body], problem, assembly) for body, one in given.items()]
        self.capacity, self.conductance = (_joined([each[k] for each in parts]) for k in (0, 1))

    def __bool__(self) -> bool:
        return bool(self.spaces)

    def start_values(self, pose: Pose) -> FloatArray:
        """Values (nodes,) at the start, when the bodies, or their images, are at ``pose``."""
        found = [np.zeros(0)]
        for body, space in self.spaces.items():
            given = self._problem.conditions[body].value or self._problem.initial
            found.append(given(0.0, to_world(pose, body, space.node_points)))
        return np.concatenate(found)

    def means(self, on_surfaces: FloatArray, values: FloatArray) -> FloatArray:
        """Mean of ``values`` (nodes,) in each body that conducts, and that ``on_surfaces`` (surfaces,) of all else."""
        found, first, content = on_surfaces.copy(), 0, self.capacity @ values
        weight = self.capacity @ np.ones(self.nodes)
        for body, space in self.spaces.items():
            mine = slice(first, first + space.nodes)
            found[body] = content[mine].sum() / weight[mine].sum()
            first += space.nodes
        return found


def _matrices(
    conduction: Conduction, space: InsideSpace, problem: ScalarProblem, assembly: Callable[[Numbering], ScalarAssembly]
) -> tuple[sparse.csr_array, sparse.csr_array]:
    """Matrices of capacity, whose sum is that of the body, and of conductance."""
    integrals, still = assembly(space.numbering), np.zeros_like(space.node_points)
    mass = integrals.scalar_matrix(space.geometry, 1.0, 0.0, still)
    stiffness = integrals.scalar_matrix(space.geometry, 0.0, problem.diffusivity * conduction.conductivity, still)
    return conduction.capacity / mass.sum() * mass, stiffness


def _joined(parts: list[sparse.csr_array]) -> sparse.csr_array:
    return sparse.csr_array(sparse.block_diag(parts)) if parts else sparse.csr_array((0, 0))
