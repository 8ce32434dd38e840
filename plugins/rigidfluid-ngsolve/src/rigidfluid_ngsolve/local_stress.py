"""Viscous stress of a viscosity that varies: NGSolve's forms with functions that are given at quadrature points.

Points (N,) are those of the straight cells, one cell after another, then those of the curved ones.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid.api import FloatArray, IntArray
from rigidfluid.taylor_hood.system.local_viscosity import LocalViscosity, StrainRates
from rigidfluid_ngsolve.mesh import NodeMesh

_STRAIGHT, _CURVED = 1, {2: 3, 3: 4}
"""Half the degrees to which quadrature is exact in straight cells, and in curved ones by dimension: as scikit-fem's."""


class _Points:
    """Quadrature points of some ``cells`` (C,), with what the stress there depends on."""

    def __init__(self, mesh: NodeMesh, cells: IntArray, chosen: Any, order: int) -> None:
        import ngsolve as ngs
        from ngsolve.comp import IntegrationRuleSpace

        d = mesh.ngsolve.dim
        self.cells, self._count = cells, mesh.ngsolve.ne
        space = IntegrationRuleSpace(mesh.ngsolve, order=order)
        self.dx = ngs.dx(intrules=space.GetIntegrationRules(), definedonelements=chosen)
        self.viscosity, self.slope, *self._components = (ngs.GridFunction(space) for _ in range(2 + d * d))
        self.tensor = ngs.CF(tuple(self._components), dims=(d, d))
        self._weight = ngs.LinearForm(space.TestFunction() * self.dx)

    @property
    def weight(self) -> FloatArray:
        """Weights of the points in an integral (N,)."""
        self._weight.Assemble()
        return self._rows(self._weight.vec)[self.cells].ravel()

    @property
    def cell(self) -> IntArray:
        """The cell of each point (N,)."""
        return np.repeat(self.cells, len(self._rows(self.viscosity.vec)[0]))

    def evaluated(self, tensor: Any) -> FloatArray:
        """A tensor of NGSolve's at the points (N, d, d)."""
        d = tensor.dims[0]
        for number, function in enumerate(self._components):
            function.Interpolate(tensor[number // d, number % d])
        components = [self._rows(function.vec)[self.cells].ravel() for function in self._components]
        return np.stack(components, axis=1).reshape(-1, d, d)

    def take(self, function: Any, values: FloatArray) -> None:
        """Give a function its ``values`` (N,)."""
        self._rows(function.vec)[self.cells] = values.reshape(len(self.cells), -1)

    def take_tensor(self, values: FloatArray) -> None:
        """Give the tensor its ``values`` (N, d, d)."""
        for number, function in enumerate(self._components):
            self.take(function, values.reshape(len(values), -1)[:, number])

    def _rows(self, vector: Any) -> FloatArray:
        """A view of the entries of a vector, those of each cell in a row."""
        return np.asarray(vector.FV().NumPy().reshape(self._count, -1))


class LocalStress:
    """Integrals of viscous stress over a ``mesh``: matrices on the ``space`` of velocities and pressures, and what a
    ``field`` of velocities gives."""

    def __init__(self, mesh: NodeMesh, space: Any, field: Any) -> None:
        import ngsolve as ngs

        curved = np.asarray(mesh.curved)
        kinds = ((~mesh.curved, ~curved, _STRAIGHT), (mesh.curved, curved, _CURVED[mesh.ngsolve.dim]))
        self._points = [
            _Points(mesh, np.flatnonzero(among), chosen, order) for chosen, among, order in kinds if among.any()
        ]
        self._strain = twice_strain(field)
        (u, _), (v, _) = space.TnT()
        test = field.space.TestFunction()
        self._form, self._load = ngs.BilinearForm(space), ngs.LinearForm(field.space)
        for at in self._points:
            along = [ngs.InnerProduct(at.tensor, ngs.grad(each)) for each in (u, v)]
            self._form += at.viscosity * ngs.InnerProduct(twice_strain(u), ngs.grad(v)) * at.dx
            self._form += at.slope * along[0] * along[1] * at.dx
            self._load += ngs.InnerProduct(at.tensor, ngs.grad(test)) * at.dx

    def strain_rates(self) -> StrainRates:
        """∇u + ∇uᵀ of the field u at the points."""
        tensors = [at.evaluated(self._strain) for at in self._points]
        weight, cell = ([getattr(at, name) for at in self._points] for name in ("weight", "cell"))
        return StrainRates(np.concatenate(tensors), np.concatenate(weight), np.concatenate(cell))

    def load(self, stress: FloatArray) -> Any:
        """(stress, ∇v) of ``stress`` (N, d, d) at the points, as a vector of NGSolve's."""
        for at, values in self._shared(stress):
            at.take_tensor(values)
        self._load.Assemble()
        return self._load.vec

    def matrix(self, viscosity: float, local: LocalViscosity) -> Any:
        """(μ (∇u + ∇uᵀ), ∇v) + (μ' T:∇u, T:∇v) of ``viscosity`` times ``local``, as a matrix of NGSolve's."""
        for at, values in self._shared(viscosity * local.relative):
            at.take(at.viscosity, values)
        for at, values in self._shared(viscosity * local.slope):
            at.take(at.slope, values)
        for at, values in self._shared(local.direction):
            at.take_tensor(values)
        self._form.Assemble()
        return self._form.mat

    def _shared(self, values: FloatArray) -> list[tuple[_Points, FloatArray]]:
        """Values (N, …) by the kinds of cells that they belong to."""
        ends = np.cumsum([len(at.cell) for at in self._points])
        return list(zip(self._points, np.split(values, ends[:-1]), strict=True))


def twice_strain(velocity: Any) -> Any:
    """∇u + ∇uᵀ."""
    from ngsolve import grad

    return grad(velocity) + grad(velocity).trans
