"""Quadratic elements inside a body that conducts a scalar, and what their functions are on the fluid's facets.

The facets of the two meshes do not match. On each facet of the fluid a function inside is projected onto the fluid's
quadratic ones, and at nodes that facets share the mean is taken, by their areas. This keeps the integral of a function
over the surface, so that a uniform flux reaches each node inside as it would between meshes that match; values at the
fluid's nodes alone would scatter it among these.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.conduction import Inside
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.quadratic_cells import quadratic_basis
from rigidfluid.core.mesh.location import CellFinder
from rigidfluid.taylor_hood.elements.facet_integrals import area_at_points
from rigidfluid.taylor_hood.elements.location import located
from rigidfluid.taylor_hood.elements.numbering import Numbering

_POINTS = {2: 8, 3: 4}
"""Points of Gauss' rule in each direction of a facet, by dimension; across it the functions inside have bends."""

_BESIDE, _BESIDE_STRAIGHT = -2e-3, -0.3
"""Least coordinate in a cell, and in a straight one, of a point that counts as beside it: points on the body are a
little outside of all cells, and to look for others takes most of a step in 3D."""

_INSIDE = 1e-3
"""Distance from the nearest place inside, over the body's radius, up to which a point counts as inside: cells may
differ by so much from a curved surface, where body and fluid have one value."""


class InsideSpace:
    """Elements on the cells of an ``inside``: their ``numbering``, ``geometry`` (vertices + K, d) and ``node_points``
    (nodes, d), in the body's frame [length]."""

    def __init__(self, inside: Inside) -> None:
        self.numbering = Numbering(inside.cells, len(inside.points), inside.curved if len(inside.curved) else None)
        self.geometry = inside.geometry
        self.node_points = self.numbering.node_points(self.geometry)
        self._finder = CellFinder(inside.points, inside.cells, _BESIDE_STRAIGHT)

    @property
    def nodes(self) -> int:
        """Number of the nodes."""
        return self.numbering.nodes

    def basis(self, points: FloatArray) -> sparse.csr_array:
        """Values (N, nodes) of the nodes' functions at ``points`` (N, d); outside those at the nearest place inside."""
        cell, coordinates = located(self._finder, self.numbering, self.geometry, points, _BESIDE)
        columns = self.numbering.cell_nodes[cell]
        rows = np.repeat(np.arange(len(points)), columns.shape[1])
        entries = quadratic_basis(coordinates).ravel(), (rows, columns.ravel())
        return sparse.csr_array(entries, shape=(len(points), self.nodes))

    def held(self, points: FloatArray) -> tuple[IntArray, sparse.csr_array]:
        """Numbers (K,) of the ``points`` (N, d) that are inside, and the functions' values there, (K, nodes)."""
        reach = float(np.linalg.norm(self.node_points, axis=1).max())
        near = np.flatnonzero(np.linalg.norm(points, axis=1) <= reach)
        basis = self.basis(points[near])
        missed = np.linalg.norm(basis @ self.node_points - points[near], axis=1)
        inside = missed <= _INSIDE * reach
        return near[inside], basis[inside]


def traces(
    facet_nodes: IntArray, facet_points: FloatArray, basis: Callable[[FloatArray], sparse.csr_array]
) -> tuple[IntArray, sparse.csr_array]:
    """The nodes of facets (N,), and values there of functions that are given anywhere, (N, functions).

    ``facet_nodes`` (F, b) are at ``facet_points`` (F, b, d); ``basis`` gives functions at points, (P, functions).
    Quadratic functions stay as they are on flat facets.
    """
    shapes, area = area_at_points(facet_points, _POINTS[facet_points.shape[2]])
    measure = np.linalg.norm(area, axis=2)
    where = np.einsum("qi,fid->fqd", shapes, facet_points)
    weighted = measure[:, :, None] * shapes
    mass = np.einsum("fqi,qj->fij", weighted, shapes)
    projection = np.linalg.solve(mass, np.swapaxes(weighted, 1, 2))
    nodes, place = np.unique(facet_nodes, return_inverse=True)
    place = place.reshape(facet_nodes.shape)
    whole = measure.sum(axis=1)[:, None] + np.zeros_like(place)
    share = whole / np.bincount(place.ravel(), whole.ravel())[place]
    columns = np.arange(measure.size).reshape(len(measure), 1, -1)
    rows, columns = np.broadcast_arrays(place[:, :, None], columns)
    entries = (share[:, :, None] * projection).ravel(), (rows.ravel(), columns.ravel())
    averaged = sparse.csr_array(entries, shape=(len(nodes), measure.size))
    return nodes, sparse.csr_array(averaged @ basis(where.reshape(-1, where.shape[2])))
