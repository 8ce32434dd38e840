"""The integrals of the Taylor–Hood system over all cells: scikit-fem's elements, tabulated for compiled loops."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from rigidfluid.backends.scikit_fem import kernels
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.linear_solver.projection import Masses
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.local_viscosity import StrainRates


class Rule(NamedTuple):
    """Quadrature on the reference simplex: ``weight`` (Q,), and at its points the quadratic basis' ``value`` (Q, b) and
    ``gradient`` (Q, b, d), and the ``linear`` one's value (Q, d+1)."""

    weight: FloatArray
    value: FloatArray
    gradient: FloatArray
    linear: FloatArray


class Sizes(NamedTuple):
    """Numbers of the functions of the quadratic basis, of the axes, and of both together: as many as there are."""

    basis: tuple[int, ...]
    axes: tuple[int, ...]
    entries: tuple[int, ...]


class ReferenceTables(NamedTuple):
    """Tables of scikit-fem that the integrals over a cell read.

    On straight cells ``cubic`` is exact for convection (degree 5), ``flat`` for stress and divergence (2), ``mass``
    (b, b) is the exact mass matrix and ``flux`` (b, d, d+1) has -(∂φ/∂X, ψ). On curved ones ``curved`` is exact for all
    of convection and divergence (2 + 1 + 2 + (d - 1) of the map's adjugate), and so for the balance of energy.
    """

    cubic: Rule
    flat: Rule
    curved: Rule
    mass: FloatArray
    flux: FloatArray
    sizes: Sizes


class Cells(NamedTuple):
    """All cells' ``nodes`` (M, b), which of them are ``straight`` and ``curved`` (C,), and coordinates: ``points``
    (N, d) starts with the vertices, ``curved_points`` (C, b, d) are the nodes of the curved ones."""

    points: FloatArray
    nodes: IntArray
    straight: IntArray
    curved: IntArray
    curved_points: FloatArray


class Pattern(NamedTuple):
    """Neighbours of each node: rows of ``around``, sorted, that start at ``starts`` (nodes + 1,).

    ``nodes`` (M, b) are the cells'; ``ranks`` (M, b, b): the place of a cell's node j among those around its node i.
    """

    nodes: IntArray
    starts: NDArray[np.int32]
    around: NDArray[np.int32]
    ranks: NDArray[np.int16]


class Sparsity(NamedTuple):
    """Places of a cell's entries in the sorted rows of the matrix, which start at ``indptr`` (unknowns + 1,).

    A node's d rows and a vertex' row of pressures have an entry for each component of each neighbour, then one for
    each neighbour that is a vertex: ``vertices_around`` (nodes,). The ``ranks`` are those of the `Pattern`: vertices
    come first, so that they serve pressures too.
    """

    indptr: NDArray[np.int32]
    vertices_around: NDArray[np.int32]
    ranks: NDArray[np.int16]
    first_pressure: int


class ScalarTerms(NamedTuple):
    """Coefficients of the matrix of a scalar: ``flow`` c (nodes, d) that carries it, past the mesh."""

    inertia: float
    diffusivity: float
    flow: FloatArray


class Terms(NamedTuple):
    """`Coefficients` as the kernels take them; ``grad_div`` (M,) over the viscosity, if there is any."""

    inertia: float
    viscosity: float
    advection: FloatArray
    flow: FloatArray
    grad_div: FloatArray


class LocalTerms(NamedTuple):
    """The terms of a viscosity that varies as the kernels take them, at all quadrature points: ``viscosity`` (N,), its
    ``slope`` (N,) by log γ̇, the ``direction`` (N, d, d) of the strain rate; and ``grad_div`` (M,)."""

    viscosity: FloatArray
    slope: FloatArray
    direction: FloatArray
    grad_div: FloatArray


def reference_tables(dimension: int) -> ReferenceTables:
    """Tabulate scikit-fem's quadratic simplex in ``dimension`` 2 or 3."""
    from skfem import ElementTetP2, ElementTriP2
    from skfem.quadrature import get_quadrature

    element = (ElementTriP2 if dimension == 2 else ElementTetP2)()
    count = len(element.doflocs)

    def tabulate(order: int) -> Rule:
        points, weight = get_quadrature(element.refdom, order)
        basis = [element.lbasis(points, i) for i in range(count)]
        value = np.array([phi for phi, _ in basis]).T.copy()
        gradient = np.moveaxis(np.array([grad for _, grad in basis]), 2, 0).copy()
        linear = np.column_stack([1.0 - points.sum(axis=0), points.T])
        return Rule(weight, value, gradient, linear)

    # In tetrahedra scikit-fem's rule of order 5 is exact to degree 4 only, and that of order 6 to degree 5.
    cubic = tabulate(5 if dimension == 2 else 6)
    mass = np.einsum("q,qi,qj->ij", cubic.weight, cubic.value, cubic.value)
    sizes = Sizes(tuple(range(count)), tuple(range(dimension)), tuple(range(count * dimension)))
    flat = tabulate(2)
    flux = -np.einsum("q,qir,qk->irk", flat.weight, flat.gradient, flat.linear)
    return ReferenceTables(cubic, flat, tabulate(6 if dimension == 2 else 8), mass, flux, sizes)


class CompiledAssembly:
    """Matrices and loads on the cells of ``numbering``; their sparsity is laid out once."""

    def __init__(self, numbering: Numbering) -> None:
        self.numbering = numbering
        self._tables = reference_tables(numbering.dimension)
        straight = np.setdiff1d(np.arange(len(numbering.cells)), numbering.curved_cells)
        if numbering.dimension == 3:  # the matrix is larger than the caches: neighbours one after the other
            straight = straight[np.argsort(numbering.cells[straight].min(axis=1), kind="stable")]
        self._straight = straight
        self._build_sparsity()

    def matrix(self, points: FloatArray, coefficients: Coefficients) -> sparse.csr_array:
        c = coefficients
        data = np.zeros(len(self._indices))  # by NumPy, whose large pages cost a tenth of Numba's small ones
        cells, uniform = self._cells(points), 0.0 if c.local.varies else c.viscosity
        ratio = c.grad_div / uniform if uniform > 0.0 else c.grad_div
        terms = Terms(c.inertia, uniform, c.advection, c.flow, ratio)
        kernels.assemble(data, cells, self._sparsity, terms, self._tables)
        if c.local.varies:
            from rigidfluid.backends.scikit_fem.local_stress import add_local_stress  # few fluids have one that varies

            viscosity, slope = c.viscosity * c.local.relative, c.viscosity * c.local.slope
            varying = LocalTerms(viscosity, slope, c.local.direction, c.grad_div)
            add_local_stress(data, cells, self._sparsity, varying, self._tables)
        return sparse.csr_array((data, self._indices, self._sparsity.indptr), shape=(self.numbering.unknowns,) * 2)

    def masses(self, points: FloatArray) -> Masses:
        n, d, pattern = self.numbering, self.numbering.dimension, self._pattern
        mass, divergence = np.zeros(len(pattern.around)), np.zeros(d * pattern.starts[n.vertices])
        kernels.assemble_masses(mass, divergence, self._cells(points), pattern, self._tables)
        columns = (d * pattern.around[: pattern.starts[n.vertices], None] + np.arange(d, dtype=np.int32)).ravel()
        rows = d * pattern.starts[: n.vertices + 1]
        return Masses(
            sparse.csr_array((mass, pattern.around, pattern.starts), shape=(n.nodes,) * 2),
            sparse.csr_array((divergence, columns, rows), shape=(n.vertices, n.nodes * d)),
        )

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        load: FloatArray = kernels.apply_mass(self._cells(points), self._tables, field)
        return load

    def scalar_matrix(
        self, points: FloatArray, inertia: float, diffusivity: float, flow: FloatArray
    ) -> sparse.csr_array:
        """Matrix of inertia (T, v) - (c T, ∇v) + diffusivity (∇T, ∇v), with the ``flow`` c (nodes, d)."""
        from rigidfluid.backends.scikit_fem.scalar_kernels import assemble_scalar  # few scenes have a scalar

        pattern, data = self._pattern, np.zeros(len(self._pattern.around))
        terms = ScalarTerms(inertia, diffusivity, flow)
        assemble_scalar(data, self._cells(points), pattern, terms, self._tables)
        return sparse.csr_array((data, pattern.around, pattern.starts), shape=(self.numbering.nodes,) * 2)

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        return float(kernels.strain_square(self._cells(points), self._tables, velocity))

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        from rigidfluid.backends.scikit_fem.local_stress import fill_strain_rates

        cell, d = self._cell_of_point, self.numbering.dimension
        tensor, weight = np.empty((len(cell), d, d)), np.empty(len(cell))
        fill_strain_rates(tensor, weight, self._cells(points), self._tables, velocity)
        return StrainRates(tensor, weight, cell)

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        from rigidfluid.backends.scikit_fem.local_stress import add_stress_load

        load = np.zeros((self.numbering.nodes, self.numbering.dimension))
        add_stress_load(load, self._cells(points), self._tables, stress)
        return load

    def divergence_square(self, points: FloatArray, velocity: FloatArray, weight: FloatArray) -> float:
        return float(kernels.divergence_square(self._cells(points), self._tables, velocity, weight))

    @cached_property
    def _cell_of_point(self) -> IntArray:
        """Cell of each quadrature point (N,): those of straight cells come first."""
        straight = np.repeat(self._straight, len(self._tables.flat.weight))
        return np.concatenate([straight, np.repeat(self.numbering.curved_cells, len(self._tables.curved.weight))])

    def _cells(self, points: FloatArray) -> Cells:
        n = self.numbering
        return Cells(points, n.cell_nodes, self._straight, n.curved_cells, n.curved_cell_points(points))

    def _build_sparsity(self) -> None:
        n, d = self.numbering, self.numbering.dimension
        self._pattern = pattern = Pattern(n.cell_nodes, *kernels.neighbours(n.cell_nodes, n.nodes))
        indptr, self._indices = kernels.expand(pattern.starts, pattern.around, n.vertices, d)
        vertices_around = np.diff(indptr)[: n.nodes * d : d] - d * np.diff(pattern.starts)
        self._sparsity = Sparsity(indptr, vertices_around, pattern.ranks, n.nodes * d)
