"""NGSolve's integrals are scikit-fem's, to round-off, on the same cells in the same numbers."""

from __future__ import annotations

import resource

import numpy as np
import pytest
from skfem import MeshTet, MeshTri

from rigidfluid.api import FloatArray
from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.local_viscosity import LocalViscosity, StrainRates
from rigidfluid.testing.fluid.curved import ball_in_a_box
from rigidfluid_ngsolve.assembly import FormAssembly

SIZE = 0.25


def scattered(dimension: int, refinements: int = 2) -> tuple[Numbering, FloatArray]:
    """A square or cube of cells, its vertices in random order and a little out of place."""
    grid = (MeshTri if dimension == 2 else MeshTet)().refined(refinements)
    random = np.random.default_rng(3)
    number = random.permutation(grid.nvertices)
    points = np.empty((grid.nvertices, dimension))
    points[number] = grid.p.T + 0.1 * SIZE * random.uniform(-1, 1, size=grid.p.T.shape)
    return Numbering(number[grid.t.T], grid.nvertices), points


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_integrals_are_those_of_scikit_fem_wherever_the_mesh_moves(dimension: int) -> None:
    numbering, points = scattered(dimension)
    expected, found = CompiledAssembly(numbering), FormAssembly(numbering, convection=True)
    random = np.random.default_rng(4)
    for inertia, viscosity in ((2.0, 0.3), (0.0, 1.0), (1.0, 0.0)):
        points = points + 0.05 * SIZE * random.uniform(-1, 1, size=points.shape)
        field, flow = random.normal(size=(2, numbering.nodes, dimension))
        grad_div = viscosity * random.uniform(size=len(numbering.cells))
        given = Coefficients(inertia, viscosity, field, flow, grad_div)
        matrix, theirs = (a.matrix(points, given) for a in (found, expected))
        assert abs(matrix - theirs).max() < 1e-13 * abs(theirs).max()
        load, theirs = (a.mass_times(points, field) for a in (found, expected))
        np.testing.assert_allclose(load, theirs, rtol=0, atol=1e-13 * np.abs(theirs).max())
        assert found.strain_square(points, field) == pytest.approx(expected.strain_square(points, field), rel=1e-13)
        square, theirs = (a.divergence_square(points, field, grad_div) for a in (found, expected))
        assert square == pytest.approx(theirs, rel=1e-13)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_integrals_are_those_of_scikit_fem_on_curved_cells(dimension: int) -> None:
    """But for the stress, whose integrand is a ratio of polynomials there."""
    mesh = ball_in_a_box(dimension, 2)
    numbering, points = Numbering.from_mesh(mesh), mesh.geometry
    expected, found = CompiledAssembly(numbering), FormAssembly(numbering, convection=True)
    field, flow = np.random.default_rng(4).normal(size=(2, numbering.nodes, dimension))
    none, weight = np.zeros(len(numbering.cells)), np.ones(len(numbering.cells))
    matrix, theirs = (a.matrix(points, Coefficients(2.0, 0.0, field, flow, none)) for a in (found, expected))
    assert abs(matrix - theirs).max() < 1e-13 * abs(theirs).max()
    load, theirs = (a.mass_times(points, field) for a in (found, expected))
    np.testing.assert_allclose(load, theirs, rtol=0, atol=1e-13 * np.abs(theirs).max())
    viscous = Coefficients(0.0, 1.0, 0.0 * field, 0.0 * flow, weight)
    matrix, theirs = (a.matrix(points, viscous) for a in (found, expected))
    assert abs(matrix - theirs).max() < (1e-4 if dimension == 2 else 5e-3) * abs(theirs).max()
    assert found.strain_square(points, field) == pytest.approx(expected.strain_square(points, field), rel=1e-3)


def test_what_is_returned_stays_as_it_is() -> None:
    """The next assembly does not write where an earlier result is."""
    numbering, points = scattered(2)
    made = FormAssembly(numbering, convection=True)
    field, none = np.ones((numbering.nodes, 2)), np.zeros(len(numbering.cells))
    matrix = made.matrix(points, Coefficients(1.0, 1.0, field, field, none))
    load = made.mass_times(points, field)
    before = matrix.copy(), load.copy()
    made.matrix(2.0 * points, Coefficients(3.0, 1.0, -field, -field, none + 1.0))
    made.mass_times(2.0 * points, -field)
    assert abs(matrix - before[0]).max() == 0.0
    np.testing.assert_array_equal(load, before[1])


@pytest.mark.parametrize("dimension", [2, 3])
def test_without_convection_the_rest_is_the_same(dimension: int) -> None:
    numbering, points = scattered(dimension)
    still, none = np.zeros((numbering.nodes, dimension)), np.zeros(len(numbering.cells))
    given = Coefficients(1.0, 0.5, still, still, none)
    theirs = CompiledAssembly(numbering).matrix(points, given)
    assert abs(FormAssembly(numbering, convection=False).matrix(points, given) - theirs).max() < 1e-14


def test_memory_does_not_grow_with_the_number_of_meshes() -> None:
    """Each takes about 1.5 MB."""
    numbering, points = scattered(2, refinements=4)
    field, none = np.ones((numbering.nodes, 2)), np.zeros(len(numbering.cells))
    given = Coefficients(1.0, 1.0, field, field, none)
    most = []
    for _ in range(200):
        FormAssembly(numbering, convection=True).matrix(points, given)
        most.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    assert most[-1] < most[20] + 20_000  # KiB


def _local(strain: StrainRates) -> LocalViscosity:
    """A viscosity that is a function of the cell and of the strain rate, whatever the order of points in a cell."""
    rate = strain.shear_rate
    relative, slope = 1.0 + 1.0 / (1.0 + rate), -rate / (1.0 + rate) ** 2
    return LocalViscosity(relative, slope, strain.tensor / rate[:, None, None], strain.cell_means(relative))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_viscosity_that_varies_has_the_stress_of_scikit_fem(dimension: int) -> None:
    """A velocity of second degree, whose strain rates are linear: rules of the same degree agree but for the viscosity,
    and with one that is the same in each cell to round-off."""
    numbering, points = scattered(dimension)
    at = numbering.node_points(points)
    velocity = np.stack([at[:, 1] ** 2 + at[:, 0], *(at[:, 0] * at[:, axis] for axis in range(1, dimension))], axis=1)
    none, still = np.zeros(len(numbering.cells)), np.zeros_like(velocity)
    loads, squares, matrices = [], [], []
    for made in (CompiledAssembly(numbering), FormAssembly(numbering, convection=True)):
        strain = made.strain_rates(points, velocity)
        squares.append(np.bincount(strain.cell, strain.weight * strain.shear_rate**2))
        loads.append(made.stress_load(points, strain.tensor))
        cells = np.cos(strain.cell.astype(float))
        constant = np.broadcast_to(np.eye(dimension)[::-1], strain.tensor.shape).copy()
        by_cell = LocalViscosity(2.0 + cells, cells, constant, 2.0 + np.cos(np.arange(len(none))))
        matrices.append(made.matrix(points, Coefficients(1.0, 0.3, still, still, none, by_cell)))
    np.testing.assert_allclose(squares[1], squares[0], rtol=1e-11)
    np.testing.assert_allclose(loads[1], loads[0], rtol=0, atol=1e-13 * np.abs(loads[0]).max())
    assert abs(matrices[1] - matrices[0]).max() < 1e-13 * abs(matrices[0]).max()


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_tangent_is_the_derivative_of_the_stress(dimension: int) -> None:
    """Compare it with differences, in curved cells too."""
    mesh = ball_in_a_box(dimension, 2)
    numbering, points = Numbering.from_mesh(mesh), mesh.geometry
    made, random = FormAssembly(numbering, convection=True), np.random.default_rng(5)
    velocity, change = random.normal(size=(2, numbering.nodes, dimension))
    still, none = np.zeros_like(velocity), np.zeros(len(numbering.cells))

    def force(field: FloatArray) -> FloatArray:
        strain = made.strain_rates(points, field)
        return made.stress_load(points, (0.3 * _local(strain).relative)[:, None, None] * strain.tensor)

    difference = (force(velocity + 1e-5 * change) - force(velocity - 1e-5 * change)) / 2e-5
    local = _local(made.strain_rates(points, velocity))
    tangent = made.matrix(points, Coefficients(0.0, 0.3, still, still, none, local))
    found = (tangent[: velocity.size, : velocity.size] @ change.ravel()).reshape(velocity.shape)
    np.testing.assert_allclose(found, difference, rtol=0, atol=1e-7 * np.abs(difference).max())
    uniform = made.matrix(points, Coefficients(0.0, 0.3, still, still, none))
    assert abs(uniform - tangent).max() > 0.01 * abs(tangent).max()
