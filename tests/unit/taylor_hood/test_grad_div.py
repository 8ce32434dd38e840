"""Grad-div stabilisation: where it acts, what it adds to the matrix, and what it takes."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, BilinearForm, ElementTetP2, ElementTriP2, ElementVector, MeshTet, MeshTri
from skfem.helpers import ddot, div, dot, grad, mul, transpose

from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix
from rigidfluid.taylor_hood.system.grad_div import grad_div_coefficient
from rigidfluid.testing.fluid.boxes import box


def grid(dimension, refinements=2):
    mesh = (MeshTri if dimension == 2 else MeshTet)().refined(refinements)
    points = mesh.p.T + 0.02 * np.random.default_rng(3).uniform(-1, 1, size=mesh.p.T.shape)
    return Numbering(mesh.t.T.astype(np.int64), mesh.nvertices), points


def matrix_of(numbering, points, flow, viscosity):
    d = numbering.dimension
    still, none = np.zeros((numbering.nodes, d)), np.zeros((0, d))
    return CoupledMatrix(
        points=points,
        node_points=numbering.node_points(points),
        inertia=1.0,
        viscosity=viscosity,
        advection=still,
        flow=np.tile(flow, (numbering.nodes, 1)),
        position=none,
        mass_matrix=np.zeros((0, 3, 3)),
        prescribed=np.zeros(0, dtype=bool),
        frame=np.zeros(d),
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_it_acts_above_a_cell_reynolds_number_of_two(dimension):
    """γ = 2 ρ|u|h - 4 μ, where d! cells fill a cube of edge h."""
    mesh, size = box(dimension, 4), 0.25
    numbering = Numbering(mesh.cells, len(mesh.points))
    flow = 8.0 * np.eye(dimension)[0]
    for viscosity in (0.1, 0.4):
        found = grad_div_coefficient(numbering, matrix_of(numbering, mesh.points, flow, viscosity))
        np.testing.assert_allclose(found, 2.0 * 8.0 * size - 4.0 * viscosity, rtol=1e-12)
    resolved = grad_div_coefficient(numbering, matrix_of(numbering, mesh.points, flow, 8.0 * size / 1.99))
    assert not resolved.any()


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.long)])
def test_the_compiled_matrix_is_that_of_the_forms(dimension):
    """The naive twin: scikit-fem's own assembly of inertia, convection, viscosity and grad-div."""
    numbering, points = grid(dimension, 2 if dimension == 2 else 1)
    random = np.random.default_rng(5)
    field, flow = random.normal(size=(2, numbering.nodes, dimension))
    gamma = random.uniform(size=len(numbering.cells))
    found = CompiledAssembly(numbering).matrix(points, Coefficients(2.0, 0.3, field, flow, gamma))
    mesh = (MeshTri if dimension == 2 else MeshTet)(points.T, numbering.cells.T, sort_t=False)
    element = ElementVector((ElementTriP2 if dimension == 2 else ElementTetP2)())
    basis = Basis(mesh, element, intorder=5 if dimension == 2 else 6)
    order = _unknowns(basis, numbering)

    def nodal(values):
        dofs = np.empty(basis.N)
        dofs[order] = values.ravel()
        return basis.interpolate(dofs)

    @BilinearForm
    def momentum(u, v, w):
        convected = mul(grad(u), w.field) + 0.5 * div(w.flow) * u
        stress = 0.3 * ddot(grad(u) + transpose(grad(u)), grad(v))
        return 2.0 * dot(u, v) + dot(convected, v) + stress + w.gamma * div(u) * div(v)

    count = len(basis.quadrature[1])
    given = {"field": nodal(field), "flow": nodal(flow), "gamma": np.tile(gamma[:, None], count)}
    expected = momentum.assemble(basis, **given).tocsr()[order][:, order]
    size = numbering.nodes * dimension
    assert abs(found[:size, :size] - expected).max() < 1e-12 * abs(expected).max()


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_it_takes_is_the_weighted_square_of_the_divergence(dimension):
    """u = (x², 0, …): ∇·u = 2x, and ∫ 4x² = 4/3 over the unit box, with any numbering."""
    mesh = box(dimension, 3)
    numbering = Numbering(mesh.cells, len(mesh.points))
    velocity = np.zeros((numbering.nodes, dimension))
    velocity[:, 0] = numbering.node_points(mesh.points)[:, 0] ** 2
    assembly, weight = CompiledAssembly(numbering), np.full(len(numbering.cells), 3.0)
    assert assembly.divergence_square(mesh.points, velocity, weight) == pytest.approx(4.0, rel=1e-12)


def _unknowns(basis, numbering):
    """scikit-fem's number of each of our velocities, flat."""
    d = numbering.dimension
    where = {tuple(np.round(x, 9)): i for i, x in enumerate(numbering.node_points(basis.mesh.p.T))}
    order = np.empty((numbering.nodes, d), dtype=np.int64)
    for dof in range(basis.N):
        node = where[tuple(np.round(basis.doflocs[:, dof], 9))]
        order[node, _component(basis, dof)] = dof
    return order.ravel()


def _component(basis, dof):
    """Of a vector element's unknowns at one place, they follow each other."""
    same = np.flatnonzero(np.all(np.abs(basis.doflocs - basis.doflocs[:, dof : dof + 1]) < 1e-12, axis=0))
    return int(np.searchsorted(np.sort(same), dof))
