"""The weak form in UFL, compiled by DOLFINx."""

from __future__ import annotations

from typing import Any

import ufl
from dolfinx import default_scalar_type, fem

from rigidfluid.backends.dolfinx import compat
from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.model.types import FloatArray

_COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"]}


class Forms:
    """Integrals over the cells of one space, evaluated where its mesh is now; all exact for straight simplices."""

    def __init__(self, space: Space) -> None:
        self._space = space
        u, v = ufl.TrialFunction(space.velocity), ufl.TestFunction(space.velocity)
        p, q = ufl.TrialFunction(space.pressure), ufl.TestFunction(space.pressure)
        self._field, self._flow = fem.Function(space.velocity), fem.Function(space.velocity)
        self._inertia, self._viscosity = (fem.Constant(space.mesh, default_scalar_type(0.0)) for _ in range(2))
        dx = ufl.dx
        convected = ufl.dot(ufl.grad(u), self._field) + 0.5 * ufl.div(self._flow) * u
        convection = ufl.inner(convected, v) * dx(degree=5)
        inertia = self._inertia * ufl.inner(u, v) * dx(degree=4)
        stress = self._viscosity * ufl.inner(ufl.grad(u) + ufl.grad(u).T, ufl.grad(v)) * dx(degree=2)
        pressure, divergence = -p * ufl.div(v) * dx(degree=2), -q * ufl.div(u) * dx(degree=2)
        self._matrix = _compiled([[inertia + convection + stress, pressure], [divergence, None]])
        self._without_convection = _compiled([[inertia + stress, pressure], [divergence, None]])
        self._mass = _compiled(ufl.inner(self._field, v) * dx(degree=4))
        strain = ufl.sym(ufl.grad(self._field))
        self._strain_square = _compiled(2 * ufl.inner(strain, strain) * dx(degree=2))
        self.pressure_mass = _compiled(p * q * dx(degree=2))
        self.pressure_laplacian = _compiled(ufl.inner(ufl.grad(p), ufl.grad(q)) * dx(degree=0))

    def new_matrix(self) -> Any:
        """A PETSc matrix for `assemble`: the rows of each process' velocities, then of its pressures."""
        return compat.create_block_matrix(self._matrix)

    def assemble(self, matrix: Any, inertia: float, viscosity: float, advection: FloatArray, flow: FloatArray) -> None:
        """Overwrite it by inertia (u, v) + (a·∇u, v) + ½ ((∇·c) u, v) + viscosity (∇u + ∇uᵀ, ∇v) - (p, ∇·v) - (∇·u, q).

        ``advection`` a and ``flow`` c, (nodes, d), already hold the density.
        """
        self._inertia.value, self._viscosity.value = inertia, viscosity
        self._space.set(self._field, advection)
        self._space.set(self._flow, flow)
        moving = advection.any() or flow.any()
        compat.assemble_block_matrix(matrix, self._matrix if moving else self._without_convection)

    def mass_times(self, field: FloatArray) -> FloatArray:
        """(field, v) for every nodal test function over this process' cells, (nodes, d)."""
        self._space.set(self._field, field)
        return self._space.as_nodal(fem.assemble_vector(self._mass).array)

    def strain_square(self, velocity: FloatArray) -> float:
        """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) over this process' cells."""
        self._space.set(self._field, velocity)
        return float(fem.assemble_scalar(self._strain_square))


def _compiled(form: Any) -> Any:
    return fem.form(form, jit_options=_COMPILER)
