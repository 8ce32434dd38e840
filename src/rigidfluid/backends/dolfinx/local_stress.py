"""Viscous stress of a viscosity that varies: functions in UFL that are given at quadrature points.

Points (N,) are those of the straight cells, one cell after another in DOLFINx' order, then those of the curved ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import basix
import basix.ufl
import numpy as np
import ufl
from dolfinx import fem

from rigidfluid.backends.dolfinx.compiled import compiled
from rigidfluid.backends.dolfinx.measures import Measures
from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.taylor_hood.system.local_viscosity import LocalViscosity, StrainRates

_DEGREE, _DEGREE_IN_CURVED_CELLS = 2, 6
"""Degrees to which stress is integrated: all weights are positive, those of degree 7 in tetrahedra are not."""


class _Points:
    """Quadrature points of some ``cells`` (C,), in DOLFINx' order, with what the stress there depends on."""

    def __init__(self, space: Space, cells: IntArray, dx: Any, degree: int) -> None:
        mesh, d = space.mesh, space.numbering.dimension
        name = ("triangle", "tetrahedron")[d - 2]
        self.cells, self.dx, self._mesh = cells, dx, mesh
        self._at, self._weight = basix.make_quadrature(basix.CellType[name], degree)
        scalar, tensor = (
            fem.functionspace(mesh, basix.ufl.quadrature_element(name, shape, scheme="default", degree=degree))
            for shape in ((), (d, d))
        )
        self.viscosity, self.slope, self.tensor = fem.Function(scalar), fem.Function(scalar), fem.Function(tensor)
        self._jacobian = fem.Expression(ufl.JacobianDeterminant(mesh), self._at)

    @property
    def weight(self) -> FloatArray:
        """Weights of the points in an integral (N,)."""
        jacobian = self._evaluated(self._jacobian).reshape(len(self.cells), self.per_cell)
        return np.asarray(np.abs(jacobian) * self._weight).ravel()

    @property
    def per_cell(self) -> int:
        """Number of points of a cell."""
        return len(self._weight)

    def expression(self, tensor: Any) -> Any:
        """An expression of UFL's, to be `evaluated` at the points."""
        return fem.Expression(tensor, self._at)

    def tensors(self, expression: Any) -> FloatArray:
        """An `expression` at the points (N, d, d)."""
        d = self._mesh.geometry.dim
        return self._evaluated(expression).reshape(-1, d, d)

    def take(self, function: fem.Function, values: FloatArray) -> None:
        """Give a function its ``values`` (N, …)."""
        dofmap = function.function_space.dofmap
        dofs = dofmap.list[self.cells].ravel()
        function.x.array.reshape(-1, dofmap.bs)[dofs] = values.reshape(len(dofs), dofmap.bs)

    def _evaluated(self, expression: Any) -> FloatArray:
        return np.asarray(expression.eval(self._mesh, self.cells.astype(np.int32)))


class LocalStress:
    """Integrals of viscous stress on a ``space``, with what a ``field`` of velocities gives."""

    def __init__(self, space: Space, measures: Measures, field: fem.Function) -> None:
        self._space, strain = space, _twice_strain(field)
        self._points = [_Points(space, *each) for each in measures.kinds(_DEGREE, _DEGREE_IN_CURVED_CELLS)]
        self._strains = [at.expression(strain) for at in self._points]
        test = ufl.TestFunction(space.velocity)
        self._load = compiled(sum(ufl.inner(at.tensor, ufl.grad(test)) * at.dx for at in self._points))

    def form(self, u: Any, v: Any) -> Any:
        """(μ (∇u + ∇uᵀ), ∇v) + (μ' T:∇u, T:∇v), of what was `taken` last."""
        return sum(
            (
                at.viscosity * ufl.inner(_twice_strain(u), ufl.grad(v))
                + at.slope * ufl.inner(at.tensor, ufl.grad(u)) * ufl.inner(at.tensor, ufl.grad(v))
            )
            * at.dx
            for at in self._points
        )

    def strain_rates(self) -> StrainRates:
        """∇u + ∇uᵀ of the field u at the points."""
        tensors = [at.tensors(strain) for at, strain in zip(self._points, self._strains, strict=True)]
        weights = [at.weight for at in self._points]
        cells = [np.repeat(self._space.cell_of_made[at.cells], at.per_cell) for at in self._points]
        return StrainRates(np.concatenate(tensors), np.concatenate(weights), np.concatenate(cells))

    def load(self, stress: FloatArray) -> FloatArray:
        """(stress, ∇v) of ``stress`` (N, d, d) at the points, for every nodal test function (nodes, d)."""
        for at, values in self._shared(stress):
            at.take(at.tensor, values)
        return self._space.nodal_field(fem.assemble_vector(self._load).array)

    def take(self, viscosity: float, local: LocalViscosity) -> None:
        """Take ``viscosity`` times ``local`` for the `form`."""
        given = (viscosity * local.relative, viscosity * local.slope, local.direction)
        for name, values in zip(("viscosity", "slope", "tensor"), given, strict=True):
            for at, mine in self._shared(values):
                at.take(getattr(at, name), mine)

    def _shared(self, values: FloatArray) -> Iterator[tuple[_Points, FloatArray]]:
        """Values (N, …) by the kinds of cells that they belong to."""
        ends = np.cumsum([len(at.cells) * at.per_cell for at in self._points])
        return zip(self._points, np.split(values, ends[:-1]), strict=True)


def _twice_strain(velocity: Any) -> Any:
    """∇u + ∇uᵀ."""
    return ufl.grad(velocity) + ufl.grad(velocity).T
