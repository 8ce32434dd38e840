"""The weak form in UFL, compiled by DOLFINx."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import ufl
from dolfinx import default_scalar_type, fem

from rigidfluid.backends.dolfinx import compat
from rigidfluid.backends.dolfinx.compiled import compiled
from rigidfluid.backends.dolfinx.local_stress import LocalStress
from rigidfluid.backends.dolfinx.measures import Measures
from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.local_viscosity import StrainRates


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
        self._measures = Measures(space)
        over = self._measures.over
        convected = ufl.dot(ufl.grad(u), self._field) + 0.5 * ufl.div(self._flow) * u
        convection = over(ufl.inner(convected, v), 5)
        inertia = over(self._inertia * ufl.inner(u, v), 4)
        stress = over(self._viscosity * ufl.inner(ufl.grad(u) + ufl.grad(u).T, ufl.grad(v)), 2)
        pressure, divergence = over(-p * ufl.div(v), 2), over(-q * ufl.div(u), 2)
        grad_div = over(self._weight * ufl.div(u) * ufl.div(v), 2)
        self._velocities, self._rest = (u, v, inertia + convection + grad_div), (pressure, divergence)
        self._matrix = compiled([[inertia + convection + stress + grad_div, pressure], [divergence, None]])
        self._without_convection = compiled([[inertia + stress, pressure], [divergence, None]])
        self._mass = compiled(over(ufl.inner(self._field, v), 4))
        strain = ufl.sym(ufl.grad(self._field))
        self._strain_square = compiled(over(2 * ufl.inner(strain, strain), 2))
        self._divergence_square = compiled(over(self._weight * ufl.div(self._field) ** 2, 2))
        self._pressure_mass = compiled(over(self._weight * p * q, 2))
        self.pressure_laplacian = compiled(over(ufl.inner(ufl.grad(p), ufl.grad(q)), 0))

    def new_matrix(self) -> Any:
        """A PETSc matrix for `assemble`: the rows of each process' velocities, then of its pressures."""
        return compat.create_block_matrix(self._matrix)

    def assemble(self, matrix: Any, coefficients: Coefficients) -> None:
        """Overwrite a `new_matrix` by that of these coefficients."""
        self._inertia.value, self._viscosity.value = coefficients.inertia, coefficients.viscosity
        self._space.set(self._field, coefficients.advection)
        self._space.set(self._flow, coefficients.flow)
        self._space.set_cells(self._weight, coefficients.grad_div)
        if coefficients.local.varies:
            self._local.take(coefficients.viscosity, coefficients.local)
            compat.assemble_block_matrix(matrix, self._with_local_stress)
            return
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

    def strain_rates(self, velocity: FloatArray) -> StrainRates:
        """∇u + ∇uᵀ at the points by which viscous stress is integrated over this process' cells."""
        self._space.set(self._field, velocity)
        return self._local.strain_rates()

    def stress_load(self, stress: FloatArray) -> FloatArray:
        """(stress, ∇v) for every nodal test function over this process' cells, (nodes, d), of ``stress`` (N, d, d)."""
        return self._local.load(stress)

    def divergence_square(self, velocity: FloatArray, weight: FloatArray) -> float:
        """∫ w (∇·u)² over this process' cells, ``weight`` w (M,)."""
        self._space.set(self._field, velocity)
        self._space.set_cells(self._weight, weight)
        return float(fem.assemble_scalar(self._divergence_square))

    @cached_property
    def _local(self) -> LocalStress:
        return LocalStress(self._space, self._measures, self._field)

    @cached_property
    def _with_local_stress(self) -> Any:
        (u, v, rest), (pressure, divergence) = self._velocities, self._rest
        return compiled([[rest + self._local.form(u, v), pressure], [divergence, None]])
