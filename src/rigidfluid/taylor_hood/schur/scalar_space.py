"""One component of a velocity that is the same all over each body, as an unknown for each node and each body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import reverse_cuthill_mckee

from rigidfluid.core.geometry.arrays import BoolArray, IntArray
from rigidfluid.taylor_hood.system.constraint import Constraint


@dataclass(frozen=True, eq=False)
class ScalarSpace:
    """Velocity components that have the same nodes free.

    ``columns`` (s, c): each scalar unknown's number among those of the coupled matrix, for each of c components;
    ``of_node`` (nodes,): the scalar unknown at each node, -1 where the velocity is held; ``alone`` (nodes,): whether
    its components are along axes of its own, so that it is coupled with no other; ``coarse`` (s, k): linear functions
    on the cells as combinations of these unknowns.
    """

    columns: IntArray
    of_node: IntArray
    alone: BoolArray
    coarse: sparse.csr_array

    def reduced(self, matrix: sparse.csr_array) -> sparse.csr_array:
        """Qᵀ F Q of a ``matrix`` F (nodes, nodes), Q being 1 where an unknown is a node's."""
        entries = matrix.tocoo()
        row, column = self.of_node[entries.row], self.of_node[entries.col]
        crossing = (self.alone[entries.row] | self.alone[entries.col]) & (entries.row != entries.col)
        kept = (row >= 0) & (column >= 0) & ~crossing
        shape = (len(self.columns),) * 2
        found = sparse.coo_array((entries.data[kept], (row[kept], column[kept])), shape=shape).tocsr()
        found.sort_indices()
        return found


def scalar_spaces(constraint: Constraint, matrix: sparse.csr_array) -> list[ScalarSpace]:
    """All components' spaces, numbered so that neighbours in ``matrix`` (nodes, nodes) are near each other."""
    columns = _columns(constraint)
    patterns: list[tuple[IntArray, list[int]]] = []
    for component in range(columns.shape[1]):
        number = _numbered(columns[:, component])
        for known, components in patterns:
            if np.array_equal(known, number):
                components.append(component)
                break
        else:
            patterns.append((number, [component]))
    return [_space(constraint, matrix, number, columns[:, components]) for number, components in patterns]


def _columns(constraint: Constraint) -> IntArray:
    """The unknown of the coupled matrix that each component (nodes, d) is, on a body its translation; -1 if held."""
    surfaces, d = constraint.surfaces, constraint.surfaces.numbering.dimension
    found = np.full(surfaces.numbering.nodes * d, -1)
    velocities = constraint.free_unknowns < len(found)
    found[constraint.free_unknowns[velocities]] = constraint.free_columns[velocities]
    found = found.reshape(-1, d)[surfaces.originals]
    width = d + (1 if d == 2 else 3)
    nodes, _, place = surfaces.carried_nodes(np.flatnonzero(~constraint.prescribed))
    found[nodes] = constraint.twist_start + place[:, None] * width + np.arange(d)
    return found


def _numbered(columns: IntArray) -> IntArray:
    """Numbers of what is not -1, by first to last."""
    found = np.full(len(columns), -1)
    found[columns >= 0] = np.unique(columns[columns >= 0], return_inverse=True)[1]
    return found


def _space(constraint: Constraint, matrix: sparse.csr_array, number: IntArray, columns: IntArray) -> ScalarSpace:
    size = int(number.max(initial=-1)) + 1
    node_of = np.empty(size, dtype=np.int64)
    free = np.flatnonzero(number >= 0)
    node_of[number[free[::-1]]] = free[::-1]  # the first node of each
    is_body = columns[node_of, 0] >= constraint.twist_start
    order = _order(matrix, node_of, is_body)
    place = np.empty(size, dtype=np.int64)
    place[order] = np.arange(size)
    of_node = np.where(number >= 0, place[number], -1)
    alone = np.zeros(len(of_node), dtype=bool)
    alone[constraint.surfaces.frames.nodes] = True
    first = node_of[order]
    return ScalarSpace(columns[first], of_node, alone, _coarse(constraint, of_node, first))


def _order(matrix: sparse.csr_array, node_of: IntArray, is_body: BoolArray) -> IntArray:
    """Unknowns by Cuthill and McKee, bodies last: their rows are long."""
    nodes = np.flatnonzero(~is_body)
    pattern = matrix[node_of[nodes]][:, node_of[nodes]]
    found = reverse_cuthill_mckee(sparse.csr_matrix(pattern), symmetric_mode=True)
    return np.concatenate([nodes[found], np.flatnonzero(is_body)])


def _coarse(constraint: Constraint, of_node: IntArray, first: IntArray) -> sparse.csr_array:
    """Values at vertices make those half-way along edges."""
    numbering = constraint.surfaces.numbering
    vertices, size = numbering.vertices, len(first)
    at_vertex = of_node[:vertices]
    kept, coarse = np.unique(at_vertex[at_vertex >= 0], return_inverse=True)
    number = np.full(vertices, -1)
    number[at_vertex >= 0] = coarse
    own = np.column_stack([np.arange(vertices), np.arange(vertices)])
    ends = np.concatenate([own, numbering.edges])[first]
    rows, columns = np.repeat(np.arange(size), 2), number[ends].ravel()
    values = np.full(len(rows), 0.5)
    free = columns >= 0
    return sparse.coo_array((values[free], (rows[free], columns[free])), shape=(size, len(kept))).tocsr()
