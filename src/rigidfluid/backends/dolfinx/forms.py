"""The weak form in UFL, compiled by DOLFINx."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import ufl
from dolfinx import default_scalar_type, fem
from dolfinx.mesh import meshtags

from rigidfluid.backends.dolfinx import compat
from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.system.coefficients import Coefficients

_STRAIGHT, _CURVED = 1, 2
_DEGREE_IN_CURVED_CELLS = {2: 6, 3: 7}
"""Degree of convection in curved cells: 2 + 1 + 2 and d - 1 of the map's adjugate."""

_COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"]}


class Forms:
    """Integrals over the cells of one space, evaluated where its mesh is now; all exact for straight simplices.

    On curved ones they are exact for convection and divergence, and so for the balance of energy.
    """

    def __init__(self, space: Space) -> None:
        self._space = space
        u, v = ufl.TrialFunction(space.velocity), ufl.TestFunction(space.velocity)
        p, q = ufl.TrialFunction(space.pressure), ufl.TestFunction(space.pressure)
        self._field, self._flow = fem.Function(space.velocity), fem.Function(space.velocity)
        self._weight = fem.Function(fem.functionspace(space.mesh, ("DG", 0)))
        self._inertia, self._viscosity = (fem.Constant(space.mesh, default_scalar_type(0.0)) for _ in range(2))
        over = _over_cells(space)
        convected = ufl.dot(ufl.grad(u), self._field) + 0.5 * ufl.div(self._flow) * u
        convection = over(ufl.inner(convected, v), 5)
        inertia = over(self._inertia * ufl.inner(u, v), 4)
        stress = over(self._viscosity * ufl.inner(ufl.grad(u) + ufl.grad(u).T, ufl.grad(v)), 2)
        pressure, divergence = over(-p * ufl.div(v), 2), over(-q * ufl.div(u), 2)
        grad_div = over(self._weight * ufl.div(u) * ufl.div(v), 2)
        self._matrix = _compiled([[inertia + convection + stress + grad_div, pressure], [divergence, None]])
        self._without_convection = _compiled([[inertia + stress, pressure], [divergence, None]])
        self._mass = _compiled(over(ufl.inner(self._field, v), 4))
        strain = ufl.sym(ufl.grad(self._field))
        self._strain_square = _compiled(over(2 * ufl.inner(strain, strain), 2))
        self._divergence_square = _compiled(over(self._weight * ufl.div(self._field) ** 2, 2))
        self._pressure_mass = _compiled(over(self._weight * p * q, 2))
        self.pressure_laplacian = _compiled(over(ufl.inner(ufl.grad(p), ufl.grad(q)), 0))

    def new_matrix(self) -> Any:
        """A PETSc matrix for `assemble`: the rows of each process' velocities, then of its pressures."""
        return compat.create_block_matrix(self._matrix)

    def assemble(self, matrix: Any, coefficients: Coefficients) -> None:
        """Overwrite a `new_matrix` by that of these coefficients."""
        self._inertia.value, self._viscosity.value = coefficients.inertia, coefficients.viscosity
        self._space.set(self._field, coefficients.advection)
        self._space.set(self._flow, coefficients.flow)
        self._space.set_cells(self._weight, coefficients.grad_div)
        moving = coefficients.advection.any() or coefficients.flow.any()
        compat.assemble_block_matrix(matrix, self._matrix if moving else self._without_convection)

    def pressure_mass(self, weight: FloatArray) -> Any:
        """The form of (w p, q), ``weight`` w (M,), until the weight is set again."""
        self._space.set_cells(self._weight, weight)
        return self._pressure_mass

    def mass_times(self, field: FloatArray) -> FloatArray:
        """(field, v) for every nodal test function over this process' cells, (nodes, d)."""
        self._space.set(self._field, field)
        return self._space.nodal_field(fem.assemble_vector(self._mass).array)

    def strain_square(self, velocity: FloatArray) -> float:
        """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) over this process' cells."""
        self._space.set(self._field, velocity)
        return float(fem.assemble_scalar(self._strain_square))

    def divergence_square(self, velocity: FloatArray, weight: FloatArray) -> float:
        """∫ w (∇·u)² over this process' cells, ``weight`` w (M,)."""
        self._space.set(self._field, velocity)
        self._space.set_cells(self._weight, weight)
        return float(fem.assemble_scalar(self._divergence_square))


def _over_cells(space: Space) -> Callable[[Any, int], Any]:
    """Makes integrals of integrands that have so high a degree in straight cells."""
    if space.curved is None:
        return lambda integrand, degree: integrand * ufl.dx(degree=degree)
    d, cells = space.numbering.dimension, np.arange(len(space.curved), dtype=np.int32)
    tags = meshtags(space.mesh, d, cells, np.where(space.curved, _CURVED, _STRAIGHT).astype(np.int32))
    dx = ufl.Measure("dx", domain=space.mesh, subdomain_data=tags)

    def over(integrand: Any, degree: int) -> Any:
        on_curved = integrand * dx(_CURVED, degree=_DEGREE_IN_CURVED_CELLS[d])
        return integrand * dx(_STRAIGHT, degree=degree) + on_curved

    return over


def _compiled(form: Any) -> Any:
    return fem.form(form, jit_options=_COMPILER)
