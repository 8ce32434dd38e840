"""Stress of a viscosity that varies from point to point, against the kernels of a constant one and naive sums."""

from dataclasses import replace

import numpy as np
import pytest
from sheared_materials import materials

from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly, reference_tables
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.linear_solver.sparse import SparseDiscretisation
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.linearised import linearised
from rigidfluid.taylor_hood.system.local_viscosity import LocalViscosity
from rigidfluid.testing.fluid.curved import ball_in_a_box
from rigidfluid.testing.fluid.exact import problem


@pytest.fixture(params=[2, 3])
def mesh(request):
    """Straight and curved cells around a ball."""
    return ball_in_a_box(request.param, 2)


@pytest.fixture
def assembly(mesh):
    return CompiledAssembly(Numbering.from_mesh(mesh))


def random_velocity(assembly):
    return np.random.default_rng(0).normal(size=(assembly.numbering.nodes, assembly.numbering.dimension))


def stress_matrix(assembly, mesh, local, viscosity=1.0, grad_div=0.0):
    n = assembly.numbering
    still, weight = np.zeros((n.nodes, n.dimension)), np.full(len(n.cells), grad_div)
    return assembly.matrix(mesh.geometry, Coefficients(0.0, viscosity, still, still, weight, local))


def unvaried(strain):
    """The viscosity of a matrix, at each of its points."""
    count, d = len(strain.weight), strain.tensor.shape[1]
    return LocalViscosity(np.ones(count), np.zeros(count), np.zeros((count, d, d)), np.ones(strain.cell.max() + 1))


def test_one_that_does_not_vary_gives_the_matrix_of_a_constant_one(assembly, mesh):
    strain = assembly.strain_rates(mesh.geometry, random_velocity(assembly))
    local = stress_matrix(assembly, mesh, unvaried(strain), 0.3, 0.2)
    n = assembly.numbering
    still = np.zeros((n.nodes, n.dimension))
    constant = assembly.matrix(mesh.geometry, Coefficients(0.0, 0.3, still, still, np.full(len(n.cells), 0.2)))
    assert constant.nnz == local.nnz
    assert abs(local - constant).max() < 1e-14 * abs(constant).max()


def test_dissipation_is_that_of_a_constant_one(assembly, mesh):
    velocity = random_velocity(assembly)
    strain = assembly.strain_rates(mesh.geometry, velocity)
    square = float(strain.weight @ strain.shear_rate**2)
    assert square == pytest.approx(assembly.strain_square(mesh.geometry, velocity), rel=1e-13)


def test_a_load_is_the_naive_sum_over_points(assembly, mesh):
    numbering, d = assembly.numbering, assembly.numbering.dimension
    strain = assembly.strain_rates(mesh.geometry, random_velocity(assembly))
    stress = np.random.default_rng(1).normal(size=strain.tensor.shape)
    stress = stress + np.swapaxes(stress, 1, 2)
    wanted, nodes = np.zeros((numbering.nodes, d)), numbering.node_points(mesh.geometry)
    tables, curved = reference_tables(d), set(numbering.curved_cells)
    count: dict[int, int] = {}
    for point, cell in enumerate(strain.cell):
        rule = tables.curved if cell in curved else tables.flat
        q = count[cell] = count.get(cell, -1) + 1
        at = numbering.cell_nodes[cell]
        jacobian = nodes[at].T @ rule.gradient[q]
        assert strain.weight[point] == pytest.approx(abs(np.linalg.det(jacobian)) * rule.weight[q], rel=1e-12)
        gradient = rule.gradient[q] @ np.linalg.inv(jacobian)
        wanted[at] += strain.weight[point] * gradient @ stress[point]
    np.testing.assert_allclose(assembly.stress_load(mesh.geometry, stress), wanted, atol=1e-12)


@pytest.mark.parametrize("name", ["carreau", "thickening", "bingham"])
def test_the_tangent_is_the_derivative_of_the_stress(assembly, mesh, name):
    """K w + load = ∫ μ(γ̇)(∇u + ∇uᵀ):∇v to first order in w - u, and equal to it at w = u."""
    material, velocity = materials(assembly.numbering.dimension)[name], random_velocity(assembly)
    change = np.random.default_rng(2).normal(size=velocity.shape)

    def force(flow):
        strain = assembly.strain_rates(mesh.geometry, flow)
        return assembly.stress_load(mesh.geometry, material.viscosity(strain.shear_rate)[:, None, None] * strain.tensor)

    posed = replace(problem(assembly.numbering.dimension, bodies=1), material=material)
    discretisation = SparseDiscretisation(posed, assembly, None, mesh, np.ones(1, dtype=bool))
    stress = linearised(discretisation, mesh.geometry, velocity)
    matrix = stress_matrix(assembly, mesh, stress.local, material.dynamic_viscosity)[: velocity.size, : velocity.size]
    of_flow = (matrix @ velocity.ravel()).reshape(velocity.shape) - stress.load
    np.testing.assert_allclose(of_flow, force(velocity), atol=1e-9 * np.abs(of_flow).max())
    ends = (force(velocity + sign * 1e-5 * change) for sign in (1.0, -1.0))
    wanted = np.subtract(*ends) / 2e-5
    found = (matrix @ change.ravel()).reshape(velocity.shape)
    np.testing.assert_allclose(found, wanted, atol=1e-6 * np.abs(wanted).max())
    plain = replace(stress.local, slope=np.zeros_like(stress.local.slope))
    matrix = stress_matrix(assembly, mesh, plain, material.dynamic_viscosity)[: velocity.size, : velocity.size]
    np.testing.assert_allclose((matrix @ velocity.ravel()).reshape(velocity.shape), force(velocity), atol=1e-12)
