"""The block preconditioner: its parts compared with what they approximate, its iterations, and the steps it gives."""

import numpy as np
import pytest
from scenes import wet_tables
from scipy import sparse
from throat import SLIPPERY, throat

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import SceneError
from rigidfluid.taylor_hood import sparse_backend
from rigidfluid.taylor_hood.linear_solver.few_columns import times
from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver
from rigidfluid.taylor_hood.schur.incomplete_lu import IncompleteLU
from rigidfluid.taylor_hood.schur.lagged_schur import LaggedSchur

BALLS = wet_tables(
    {"type": "ellipsoid", "semi_axes": [0.4, 0.3, 0.25], "density": 1.5, "position": [1.0, 1.3, 1.0]},
    {"type": "sphere", "radius": 0.25, "density": 1.5, "position": [1.0, 0.5, 1.0]},
    end=0.1,
    step=0.02,
    fluid={"gravity": [0.0, -10.0, 0.0]},
    domain={"lower": [0.0, 0.0, 0.0], "upper": [2.0, 2.0, 2.0]},
    mesh={"size": 0.8, "size_body": 0.25},
    output={"every": 0.02},
)
MIXED = [
    {"on": "left", "type": "velocity", "velocity": [0.2, 0.0, 0.0], "profile": "parabolic"},
    {"on": "right", "type": "pressure", "pressure": 0.3},
    {"on": "front", "type": "slip"},
]
PERIODIC = [{"on": "left", "type": "periodic", "pressure_drop": 3.0}, {"on": "right", "type": "periodic"}]


def balls(boundary=(), mesh=None, step=0.02, **fluid):
    changed = {"fluid": BALLS["fluid"] | fluid, "boundary": list(boundary), "mesh": mesh or BALLS["mesh"]}
    return scene_from_dict({**BALLS, **changed, "time": {"step": step, "end": 5 * step}, "output": {"every": step}})


def after(scene, steps):
    simulation = Simulation(scene, None, False)
    for _ in range(steps):
        simulation.step()
    return simulation.state


@pytest.fixture
def iterations(monkeypatch):
    counts, solve = [], LaggedSolver.solve

    def counting(self, *given):
        found = solve(self, *given)
        counts.append(found[1])
        return found

    monkeypatch.setattr(LaggedSolver, "solve", counting)
    return counts


def laplacian(n):
    line = sparse.diags_array([2.0, -1.0, -1.0], offsets=[0, 1, -1], shape=(n, n))
    unit = sparse.eye_array(n)
    found = sparse.csr_array(sparse.kron(line, unit) + sparse.kron(unit, line))
    found.sort_indices()
    return found


@pytest.mark.parametrize("columns", [1, 2, 3, 4])
def test_a_matrix_times_a_few_columns(columns):
    rng = np.random.default_rng(0)
    matrix = sparse.random_array((40, 30), density=0.2, rng=rng, format="csr")
    sides = rng.normal(size=(30, columns))
    np.testing.assert_allclose(times(matrix, sides), matrix.toarray() @ sides, atol=1e-14)


def test_factors_without_fill_are_exact_where_there_is_none():
    matrix = sparse.csr_array(sparse.diags_array([4.0, -1.0, -2.0], offsets=[0, 1, -1], shape=(50, 50)))
    sides = np.random.default_rng(0).random((50, 3))
    np.testing.assert_allclose(matrix @ IncompleteLU(matrix).solve(sides), sides, atol=1e-6)


def test_factors_without_fill_are_the_matrix_on_its_pattern():
    """(L U)⁻¹ inverted, as the product itself is nowhere kept."""
    matrix = laplacian(7)
    product = np.linalg.inv(IncompleteLU(matrix).solve(np.eye(49)))
    there = matrix.toarray() != 0.0
    np.testing.assert_allclose(product[there], matrix.toarray()[there], atol=1e-5)
    assert abs(product[~there]).max() > 0.1


@pytest.mark.long
@pytest.mark.parametrize("model", ["stokes", "navier-stokes"])
@pytest.mark.parametrize("boundary", [(), MIXED, PERIODIC], ids=["walls", "open and slip", "periodic"])
def test_blocks_give_what_factors_give(model, boundary):
    by_factors, by_blocks = (
        after(balls(boundary, model=model, tolerance=1e-12, solver=kind), 2) for kind in ("lu", "schur")
    )
    for name, field in by_factors.fluid.items():
        scale = np.abs(field).max()
        np.testing.assert_allclose(by_blocks.fluid[name], field, rtol=0, atol=1e-7 * scale, err_msg=name)


def test_blocks_know_slip_on_curved_walls_of_a_plane_domain(iterations):
    settings = [throat(SLIPPERY, step=0.04, end=0.2).to_dict() for _ in range(2)]
    found = []
    for each, kind in zip(settings, ("lu", "schur"), strict=True):
        each["fluid"] |= {"solver": kind, "tolerance": 1e-11}
        found.append(after(scene_from_dict(each), 3).fluid["velocity"])
    np.testing.assert_allclose(found[1], found[0], atol=1e-7 * np.abs(found[0]).max())
    assert max(iterations) < 60


@pytest.mark.long
def test_iterations_depend_neither_on_the_cells_nor_on_the_step(iterations):
    most = []
    for size in (0.25, 0.125):
        for step in (0.0005, 0.005, 0.05):
            after(balls(mesh={"size": 3 * size, "size_body": size}, step=step, tolerance=1e-8, solver="schur"), 2)
            most.append(max(iterations))
            iterations.clear()
    assert max(most) <= 2 * min(most), most
    assert max(most) <= 30, most


@pytest.mark.long
def test_light_bodies_and_viscous_fluids_take_few_more(iterations):
    """Bodies turn with the fluid: without the velocities' response their own inertia would be far too heavy."""
    for body in BALLS["body"]:
        assert body["density"] > 1.0
    scene = balls(viscosity=100.0, tolerance=1e-8, solver="schur").to_dict()
    for body in scene["body"]:
        body |= {"density": 0.01, "angular_velocity": [0.0, 0.0, 5.0]}
    after(scene_from_dict(scene), 2)
    assert max(iterations) <= 35, iterations


@pytest.mark.long
@pytest.mark.parametrize(
    ("solver", "most", "taken"), [("auto", 10**9, 0), ("auto", 0, 1), ("lu", 0, 0), ("schur", 10**9, 1)]
)
def test_auto_takes_blocks_for_large_meshes_in_3d(monkeypatch, solver, most, taken):
    made, make = [], LaggedSchur.make
    monkeypatch.setattr(LaggedSchur, "make", lambda self, parts: made.append(1) or make(self, parts))
    monkeypatch.setattr(sparse_backend, "_DEAR", most)
    after(balls(solver=solver), 1)
    assert bool(made) == bool(taken)


@pytest.mark.parametrize(
    ("model", "by_blocks"), [pytest.param("navier-stokes", False, marks=pytest.mark.long), ("stokes", True)]
)
def test_a_steady_start_with_convection_is_solved_by_factors(monkeypatch, model, by_blocks):
    """Without inertia blocks do not master convection."""
    made, make = [], LaggedSchur.make
    monkeypatch.setattr(LaggedSchur, "make", lambda self, parts: made.append(1) or make(self, parts))
    scene = balls(MIXED[:2], model=model, initial="steady", solver="schur", gravity=[0.0, 0.0, 0.0]).to_dict()
    for body in scene["body"]:
        body["fixed"] = True
    start = Simulation(scene_from_dict(scene), None, False).state
    assert np.abs(start.fluid["velocity"]).max() > 0.1
    assert bool(made) == by_blocks


def test_another_solver_is_refused_by_name():
    with pytest.raises(SceneError, match=r"fluid\.solver"):
        after(balls(solver="multigrid"), 1)


@pytest.mark.long
def test_a_run_by_blocks_is_resumed_to_the_last_bit(tmp_path):
    scene = balls(solver="schur").to_dict()
    first = scene | {"time": scene["time"] | {"end": 0.06}}
    rigidfluid.run(scene_from_dict(scene), tmp_path / "whole")
    rigidfluid.run(scene_from_dict(first), tmp_path / "parts")
    rigidfluid.run(scene_from_dict(scene), tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
