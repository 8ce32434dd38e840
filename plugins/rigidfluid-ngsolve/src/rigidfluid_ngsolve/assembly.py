"""The integrals of the Taylor–Hood system as NGSolve's forms, in the numbers of the rest of rigidfluid."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse

from rigidfluid.api import FloatArray, IntArray
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.linear_solver.projection import Masses
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.local_viscosity import StrainRates
from rigidfluid_ngsolve.local_stress import LocalStress, twice_strain
from rigidfluid_ngsolve.mesh import NodeMesh

_ORDER_OF_FIELD = 2
"""NGSolve takes the order of quadrature from the test and trial functions, not from a field that convects."""

_ORDER_OF_STRAIN_SQUARE = 2
"""The same where there is no test function at all."""

_ORDER_OF_CURVES = 4
"""More of it where cells are curved: exact for convection and divergence, as with scikit-fem."""


class FormAssembly:
    """Matrices and loads on the cells of ``numbering``; forms and sparsity are made once.

    Parameters
    ----------
    numbering : Numbering
        The topology.
    convection : bool
        Whether there is any; without it ``advection``, ``flow`` and ``grad_div`` are not read.
    """

    def __init__(self, numbering: Numbering, convection: bool) -> None:
        import ngsolve as ngs

        self.numbering = numbering
        self._mesh = NodeMesh(numbering)
        velocities = ngs.VectorNodalFESpace(self._mesh.ngsolve, order=2)
        self._space = space = velocities * ngs.H1(self._mesh.ngsolve, order=1)
        self._field, self._flow = ngs.GridFunction(velocities), ngs.GridFunction(velocities)
        self._weight = ngs.GridFunction(ngs.L2(self._mesh.ngsolve, order=0))
        self._inertia, self._viscosity = ngs.Parameter(0.0), ngs.Parameter(0.0)
        (u, p), (v, q) = space.TnT()
        # One integral each: NGSolve multiplies all functions of an integral with each other.
        over = _over_cells(self._mesh)
        self._form = ngs.BilinearForm(space)
        self._form += over(self._inertia * u * v)
        self._form += over(self._viscosity * ngs.InnerProduct(twice_strain(u), ngs.grad(v)))
        self._form += over(-p * ngs.div(v) - q * ngs.div(u))
        if convection:
            convected = ngs.grad(u) * self._field + 0.5 * ngs.div(self._flow) * u
            self._form += over(convected * v, _ORDER_OF_FIELD)
            self._form += over(self._weight * ngs.div(u) * ngs.div(v))
        self._load = ngs.LinearForm(over(self._field * velocities.TestFunction(), _ORDER_OF_FIELD))
        square = 0.5 * ngs.InnerProduct(twice_strain(self._field), twice_strain(self._field))
        self._strain_square = over(square, _ORDER_OF_STRAIN_SQUARE)
        self._divergence_square = over(self._weight * ngs.div(self._field) ** 2, _ORDER_OF_STRAIN_SQUARE)
        self._order: IntArray | None = None

    def matrix(self, points: FloatArray, coefficients: Coefficients) -> sparse.csr_array:
        self._take(points, coefficients.advection)
        self._weight.vec.FV().NumPy()[:] = coefficients.grad_div
        _nodal(self._flow.vec, self.numbering.dimension)[:] = coefficients.flow
        self._inertia.Set(coefficients.inertia)
        local = coefficients.local
        self._viscosity.Set(0.0 if local.varies else coefficients.viscosity)
        self._form.Assemble()
        entries, columns, starts = self._form.mat.CSR()
        if local.varies:
            entries = np.asarray(entries) + np.asarray(self._local.matrix(coefficients.viscosity, local).CSR()[0])
        if self._order is None:
            self._order, self._indices, self._indptr = _renumbered(self.numbering, columns, starts)
        data = np.asarray(entries)[self._order]
        return sparse.csr_array((data, self._indices, self._indptr), shape=(self.numbering.unknowns,) * 2)

    def masses(self, points: FloatArray) -> Masses:
        n, d = self.numbering, self.numbering.dimension
        still, velocities = np.zeros((n.nodes, d)), n.nodes * d
        whole = self.matrix(points, Coefficients(1.0, 0.0, still, still, np.zeros(len(n.cells))))
        return Masses(whole[:velocities:d, :velocities:d], whole[velocities:, :velocities])

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        self._take(points, field)
        self._load.Assemble()
        return _nodal(self._load.vec, field.shape[1]).copy()

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        from ngsolve import Integrate

        self._take(points, velocity)
        return float(Integrate(self._strain_square, self._mesh.ngsolve))

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        self._take(points, velocity)
        return self._local.strain_rates()

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        self._mesh.move(points)
        return _nodal(self._local.load(stress), stress.shape[1]).copy()

    def divergence_square(self, points: FloatArray, velocity: FloatArray, weight: FloatArray) -> float:
        from ngsolve import Integrate

        self._take(points, velocity)
        self._weight.vec.FV().NumPy()[:] = weight
        return float(Integrate(self._divergence_square, self._mesh.ngsolve))

    @cached_property
    def _local(self) -> LocalStress:
        return LocalStress(self._mesh, self._space, self._field)

    def _take(self, points: FloatArray, field: FloatArray) -> None:
        self._mesh.move(points)
        _nodal(self._field.vec, field.shape[1])[:] = field


def _over_cells(mesh: NodeMesh) -> Callable[..., Any]:
    """Makes integrals of integrands; ``more`` is the order that NGSolve does not know of."""
    import ngsolve as ngs

    def over(integrand: Any, more: int = 0) -> Any:
        straight = integrand * ngs.dx(bonus_intorder=more, definedonelements=~mesh.curved)
        return straight + integrand * ngs.dx(bonus_intorder=more + _ORDER_OF_CURVES, definedonelements=mesh.curved)

    return over


def _nodal(vector: Any, dimension: int) -> FloatArray:
    """A view (nodes, d) of the entries of a vector of `VectorNodalFESpace`, which holds one component after another."""
    return np.asarray(vector.FV().NumPy().reshape(dimension, -1).T)


def _renumbered(numbering: Numbering, columns: Any, starts: Any) -> tuple[IntArray, IntArray, IntArray]:
    """From NGSolve's sparsity to that in the unknowns of ``numbering``: which entry comes where, indices, indptr.

    NGSolve numbers the first components of all nodes, then the second ones, …, then the pressures.
    """
    d, nodes = numbering.dimension, numbering.nodes
    velocities = np.arange(nodes * d).reshape(nodes, d).T.ravel()
    unknown = np.concatenate([velocities, nodes * d + np.arange(numbering.vertices)])
    entries = np.arange(len(columns))
    theirs = sparse.csr_array((entries, np.asarray(columns), np.asarray(starts)), shape=(len(unknown),) * 2).tocoo()
    made = sparse.coo_array((entries, (unknown[theirs.row], unknown[theirs.col])), shape=theirs.shape).tocsr()
    made.sort_indices()
    return made.data, made.indices.astype(np.int32), made.indptr.astype(np.int32)
