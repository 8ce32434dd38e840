"""The DOLFINx backend compared with scikit-fem's: two engines, one scheme, the same answer."""

import importlib.util
import signal

import numpy as np
import pytest
from falling import falling_disk
from scenes import wet_tables
from sheared_materials import materials, moved_flow

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.testing.fluid.flow import components

pytestmark = pytest.mark.skipif(importlib.util.find_spec("dolfinx") is None, reason="DOLFINx is not installed")

BALLS = wet_tables(
    {"type": "ellipsoid", "semi_axes": [0.4, 0.3, 0.25], "density": 1.5, "position": [1.0, 1.3, 1.0]},
    {"type": "sphere", "radius": 0.25, "density": 1.5, "position": [1.0, 0.5, 1.0]},
    end=0.1,
    step=0.02,
    fluid={"gravity": [0.0, -10.0, 0.0]},
    domain={"lower": [0.0, 0.0, 0.0], "upper": [2.0, 2.0, 2.0]},
    boundary=[{"on": "left", "type": "velocity", "velocity": [0.2, 0.0, 0.0], "profile": "parabolic"}]
    + [{"on": "right", "type": "pressure", "pressure": 0.3}, {"on": "front", "type": "slip"}],
    mesh={"size": 0.6, "size_body": 0.2},
)


def three_dimensional(**fluid):
    driven = {**BALLS["body"][1], "prescribed": {"velocity": [0.0, -0.2, 0.0], "angular_velocity": [0.0, 0.0, 1.0]}}
    return scene_from_dict({**BALLS, "fluid": BALLS["fluid"] | fluid, "body": [BALLS["body"][0], driven]})


def two_dimensional(**fluid):
    sizes = {"mesh": {"size": 0.3, "size_body": 0.05}, "time": {"step": 0.004, "end": 0.02}, "output": {"every": 0.02}}
    return falling_disk(fluid=fluid, body={"angular_velocity": 5.0}, **sizes)


def after(scene, steps):
    simulation = Simulation(scene, None, False)
    for _ in range(steps):
        simulation.step()
    return simulation


def assert_same(one, other, tolerance):
    for name, field in one.state.fluid.items():
        scale = np.abs(field).max()
        np.testing.assert_allclose(other.state.fluid[name], field, rtol=0, atol=tolerance * scale, err_msg=name)
    force = one.state.hydrodynamic_wrench.force
    np.testing.assert_allclose(
        other.state.hydrodynamic_wrench.force, force, rtol=0, atol=tolerance * np.abs(force).max()
    )
    assert other.state.ledger.kinetic == pytest.approx(one.state.ledger.kinetic, rel=tolerance)


@pytest.mark.parametrize("make", [two_dimensional, three_dimensional])
@pytest.mark.parametrize("model", ["stokes", "navier-stokes"])
def test_both_backends_take_the_same_steps_on_one_mesh(make, model):
    engines = {"backend": "scikit-fem"}, {"backend": "dolfinx", "solver": "lu"}
    runs = [after(make(model=model, tolerance=1e-11, **engine), 3) for engine in engines]
    assert type(runs[0].system.backend) is not type(runs[1].system.backend)
    assert_same(*runs, 1e-8)


@pytest.mark.parametrize("make", [two_dimensional, three_dimensional])
@pytest.mark.parametrize("model", ["stokes", "navier-stokes"])
def test_the_schur_complement_gives_what_factors_give(make, model):
    """The first steps are short: next to the bodies' inertia in their residual the pressure is small."""
    runs = [after(make(backend="dolfinx", model=model, tolerance=1e-13, solver=kind), 4) for kind in ("lu", "schur")]
    assert_same(*runs, 1e-7)


@pytest.mark.parametrize("solver", ["lu", "schur"])
def test_ctrl_c_within_petsc_is_ctrl_c(monkeypatch, solver):
    """PETSc tells of an error of its own where what it calls fails."""
    from rigidfluid.backends.dolfinx.krylov import _Operator

    run, apply = after(two_dimensional(backend="dolfinx", solver=solver), 1), _Operator.mult

    def pressed(operator, *arguments):
        apply(operator, *arguments)
        signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # in a shell's background it is ignored
    monkeypatch.setattr(_Operator, "mult", pressed)
    with pytest.raises(KeyboardInterrupt):
        run.step()
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("name", ["carreau", "bingham"])
def test_a_viscosity_varies_where_all_cells_are_curved(name):
    from rigidfluid.backends.dolfinx import Dolfinx

    twist, given = np.array([1.0, 0.5, 3.0]), []
    for engine in (ScikitFem, Dolfinx):
        flow = moved_flow(materials(2)[name], 1, twist, engine)
        assert flow.backend.numbering_of(flow.mesh).curved_cells.size == len(flow.mesh.cells)
        given.append(-float(np.sum(components(flow.advance.hydrodynamic_wrench) * twist)))
        assert flow.advance.dissipation + flow.advance.grad_div == pytest.approx(given[-1], rel=1e-9)
    assert given[1] == pytest.approx(given[0], rel=1e-2)


def test_petscs_options_are_those_of_the_scene():
    run = after(two_dimensional(backend="dolfinx", petsc={"pc_factor_mat_solver_type": "umfpack"}), 1)
    assert run.system.backend._solvers.viscous._ksp.getPC().getFactorSolverType() == "umfpack"


def test_petscs_flags_are_true_in_the_scene(capfd):
    after(two_dimensional(backend="dolfinx", petsc={"ksp_monitor": True}), 1)
    assert "Residual norms for rigidfluid_ solve." in capfd.readouterr().out


def test_factors_on_a_kept_pattern_are_those_made_anew():
    """To the last bit, as a run that is resumed has none to keep."""
    kept, anew = (after(two_dimensional(backend="dolfinx"), 1) for _ in range(2))
    solver = kept.system.backend._solvers.viscous
    analysed = solver._ksp
    for _ in range(3):
        solver._wasted, solver._corrections = np.inf, ()  # renews, and recycles nothing
        anew.system.backend.drop_factors()
        kept.step()
        anew.step()
    assert solver._ksp is analysed
    for name in ("velocity", "pressure", "twist"):
        np.testing.assert_array_equal(kept.state.fluid[name], anew.state.fluid[name])


def test_bodies_apart_have_no_entries_in_common():
    """Each would be a new nonzero of PETSc's matrix: many bodies would take minutes."""
    scene = scene_from_dict({**BALLS, "fluid": BALLS["fluid"] | {"backend": "dolfinx"}})
    run = after(scene, 1)
    velocity, _ = run.system.backend._solvers.viscous._ksp.getPC().getFieldSplitSchurGetSubKSP()
    _, matrix = velocity.getOperators()
    first = matrix.getSize()[0] - 12  # twists come after velocities
    columns, _ = matrix.getRow(first)
    assert set(range(first, first + 6)) <= set(columns)
    assert not set(range(first + 6, first + 12)) & set(columns)


def iterations(scene, steps=2):
    return after(scene_from_dict(scene), steps).system.backend._solvers.viscous._ksp.getIterationNumber()


def test_iterations_depend_neither_on_the_cells_nor_on_the_step():
    scene = three_dimensional(backend="dolfinx", solver="schur", tolerance=1e-8).to_dict()
    meshes = [{"size": 3 * size, "size_body": size} for size in (0.25, 0.125)]
    steps = [scene["time"] | {"step": step} for step in (0.0002, 0.02)]
    counts = [iterations({**scene, "mesh": mesh, "time": step}) for mesh in meshes for step in steps]
    assert max(counts) <= min(2 * min(counts), 45), counts


def test_a_narrow_gap_takes_few_iterations():
    """Viscosity dominates in its cells, mass in most others."""
    fluid = BALLS["fluid"] | {"backend": "dolfinx", "viscosity": 2.0, "tolerance": 1e-8}
    times = {"time": {"step": 0.05, "end": 0.25}, "output": {"every": 0.25}}
    scene = {**BALLS, **times, "fluid": fluid, "mesh": {"size": 1.0, "size_body": 0.2}, "boundary": []}
    balls = [{**BALLS["body"][1], "position": [1.0, 0.25 + gap, 1.0]} for gap in (0.25, 0.02)]
    counts = [iterations({**scene, "body": [ball]}, 1) for ball in balls]
    assert max(counts) <= 12, counts


def test_linear_functions_have_what_is_linear_along_each_edge():
    """Also between a free node and a body that turns."""
    from rigidfluid.backends.dolfinx.linear_functions import linear_functions

    run = after(scene_from_dict({**BALLS, "fluid": BALLS["fluid"] | {"backend": "dolfinx"}}), 1)
    discretisation = run.system.backend._latest[1].inner
    constraint, space = discretisation._constraint, discretisation._topology.space
    constraint_matrix = constraint.matrix(space.numbering.node_points(run.state.mesh.geometry), run.state.pose.position)
    basis = linear_functions(constraint, constraint_matrix)
    coarse, fine = basis.createVecs()
    coarse.array[:] = np.random.default_rng(0).normal(size=coarse.size)
    basis.mult(coarse, fine)
    whole, everything = constraint_matrix.createVecs()
    whole.array[: fine.size] = fine.array
    constraint_matrix.mult(whole, everything)
    velocity = space.velocities(everything.array[: space.owned_nodes.size * 3])
    vertices, free = space.numbering.vertices, discretisation.surfaces.velocity_free
    expected = space.numbering.interpolate_to_nodes(velocity[:vertices])
    np.testing.assert_allclose(velocity[vertices:][free[vertices:]], expected[vertices:][free[vertices:]], atol=1e-12)
    np.testing.assert_array_equal(fine.array[-12:], coarse.array[-12:])  # twists are themselves


def test_a_projection_in_the_place_of_another_is_that_made_anew():
    from petsc4py import PETSc
    from scipy import sparse

    from rigidfluid.backends.dolfinx.products import projected

    random = np.random.default_rng(0)
    parts = [sparse.random_array(shape, density=0.2, format="csr", rng=random) for shape in ((40, 40), (40, 25))]
    made = None
    for factor in (1.0, 3.0):
        matrix, basis = (
            PETSc.Mat().createAIJ(part.shape, csr=(part.indptr, part.indices, factor * part.data)) for part in parts
        )
        made = projected(matrix, basis, made)
        expected = factor**3 * (parts[1].T @ parts[0] @ parts[1]).toarray()
        np.testing.assert_allclose(made[:, :], expected, rtol=1e-12, atol=1e-12)
