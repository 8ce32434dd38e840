"""The thin films between surfaces, solved by factors of the equations there."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mesh.mesh_quality import edge_lengths
from rigidfluid.taylor_hood.elements.linear_functions import gradients
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.linear_solver.factorization import factorise
from rigidfluid.taylor_hood.system.parts import Parts

FLAT = 0.15
"""Least height of a cell over its longest edge, below which it is in a film."""

ACROSS = 4.0
"""Farthest that both surfaces of a film are from a flat cell in it, over the height of that."""

RINGS = 9
"""Rings of edges around flat cells that are solved with them: there the film is thin too."""

MOST = 6
"""Greatest number of vertices of flat cells and rings, over that of the flat cells alone. In films of .002 to .0001
radii nine rings make it 2 to 9; around a few flat cells of a coarse mesh they are the whole mesh, whose factors cost
far more than the iterations that they save."""

_NOWHERE = -1
"""Number of the surface of vertices that are on none."""


class Films:
    """Solution of the coupled equations in films, all else held: of pressures in and near flat cells between two
    surfaces, and of the velocities around them.

    In a film of thickness h the Schur complement of a pressure that varies over a length L along it is (h/L)²/12 of the
    pressures' mass matrix, so that `CahouetChabard` alone needs the more iterations the thinner it is.

    Parameters
    ----------
    parts : Parts
        Ingredients of the coupled matrix.
    """

    def __init__(self, parts: Parts) -> None:
        constraint = parts.constraint
        numbering = constraint.surfaces.numbering
        points, surface = parts.points[: numbering.vertices], _surface_numbers(constraint.surfaces)
        vertices = vertices_of_films(numbering.cells, points, surface)
        self._which = _unknowns_of(parts, with_rings(numbering, vertices))
        self._rows = constraint.transposed[self._which] @ parts.system_matrix @ constraint.matrix
        self._factors = factorise(self._rows[:, self._which].tocsr()) if len(self._which) else None

    def correct(self, found: FloatArray, right_side: FloatArray) -> None:
        """Add to ``found`` (unknowns,) what the films lack of a solution for ``right_side``."""
        if self._factors is not None:
            found[self._which] += self._factors.solve(right_side[self._which] - self._rows @ found)


def vertices_of_films(cells: IntArray, points: FloatArray, surface: IntArray) -> IntArray:
    """Vertices (v,) of all cells that are less high than FLAT times their longest edge and between two surfaces at most
    ACROSS heights away, ascending; each vertex is on the ``surface`` (vertices,) of that number, -1 for none.

    Cells that are stretched as bodies move are flat too, anywhere, and make no film.
    """
    corners = points[cells]
    longest = edge_lengths(points, cells).max(axis=1)
    slopes = gradients(corners)
    steepest = np.argmax(np.linalg.norm(slopes, axis=-1), axis=1)
    up = slopes[np.arange(len(cells)), steepest]
    flat = np.linalg.norm(up, axis=1) * FLAT * longest > 1.0
    chosen, cell, vertex = cells[flat], *_surface_vertices_around(cells, np.flatnonzero(flat), surface)
    heights = np.abs(np.sum((points[vertex] - corners[flat].mean(axis=1)[cell]) * up[flat][cell], axis=1))
    cell, vertex = cell[heights < ACROSS], vertex[heights < ACROSS]
    least, most = np.full(len(chosen), len(points)), np.full(len(chosen), _NOWHERE)
    np.minimum.at(least, cell, surface[vertex])
    np.maximum.at(most, cell, surface[vertex])
    return np.unique(chosen[least < most])


def _surface_vertices_around(cells: IntArray, flat: IntArray, surface: IntArray) -> tuple[IntArray, IntArray]:
    """Pairs of a ``flat`` cell, by its place among these, and a vertex on a surface of a cell around it."""
    own = sparse.csr_matrix(
        (np.ones(cells.size), cells.ravel(), np.arange(len(cells) + 1) * cells.shape[1]), (len(cells), len(surface))
    )
    around = (own[flat] @ own.T @ own[:, surface != _NOWHERE]).tocoo()
    return around.row.astype(np.int64), np.flatnonzero(surface != _NOWHERE)[around.col]


def _surface_numbers(surfaces: Surfaces) -> IntArray:
    """Number of the surface that each vertex is on (vertices,), 0 of all faces together, of bodies from 1 on."""
    number = np.full(surfaces.numbering.nodes, _NOWHERE)
    for face in surfaces.faces:
        number[face.nodes] = 0
    for body, nodes in enumerate(surfaces.body_nodes, start=1):
        number[nodes] = body
    return number[: surfaces.numbering.vertices]


def with_rings(numbering: Numbering, vertices: IntArray) -> IntArray:
    """The ``vertices`` (v,) and all up to RINGS edges from them if they are no more than MOST times as many,
    ascending."""
    chosen = np.zeros(numbering.vertices, dtype=bool)
    chosen[vertices] = True
    for _ in range(RINGS if len(vertices) else 0):
        wider = chosen.copy()
        wider[numbering.edges[chosen[numbering.edges].any(axis=1)]] = True
        if np.count_nonzero(wider) > MOST * len(vertices):
            break
        chosen = wider
    return np.flatnonzero(chosen)


def _unknowns_of(parts: Parts, vertices: IntArray) -> IntArray:
    """The unknowns that are pressures at ``vertices``, or velocities in the cells around them, ascending."""
    constraint, numbering = parts.constraint, parts.constraint.surfaces.numbering
    d, chosen = numbering.dimension, np.zeros(numbering.unknowns, dtype=bool)
    chosen[numbering.nodes * d + vertices] = True
    around = np.isin(numbering.cells, vertices).any(axis=1)
    nodes = np.unique(numbering.cell_nodes[around])
    chosen[(nodes[:, None] * d + np.arange(d)).ravel()] = True
    return constraint.free_columns[chosen[constraint.free_unknowns]]
