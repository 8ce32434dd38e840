"""A state on another mesh, and one after a blow: no divergence, bodies rigid, what is lost is known."""

import numpy as np
import pytest
from falling import falling_disk

import rigidfluid
from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.mechanics.time_scheme import predict_pose
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces, rigid_velocity
from rigidfluid.taylor_hood.linear_solver.projection import SparseProjection
from rigidfluid.taylor_hood.linear_solver.sparse import SparseDiscretisation
from rigidfluid.taylor_hood.stepping.transfer import _scale
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.constraint import Constraint
from rigidfluid.taylor_hood.system.discretisation import kinetic_energy

SHORT = {"time": {"step": 0.004, "end": 0.016}, "mesh": {"size": 0.3, "size_body": 0.05}, "output": {"every": 0.008}}


@pytest.fixture
def spinning():
    simulation = Simulation(
        falling_disk(body={"angular_velocity": 30.0, "velocity": [0.0, -4.0]}, **SHORT), None, False
    )
    simulation.go()
    return simulation


def on(simulation, mesh):
    return simulation.system.backend._discretisation(mesh, simulation.system.prescribed)


def divergence(discretisation, points, velocity):
    still, none = np.zeros_like(velocity), np.zeros(len(discretisation.numbering.cells))
    assembly = CompiledAssembly(discretisation.numbering)
    matrix = assembly.matrix(points, Coefficients(0.0, 0.0, still, still, none))
    return (matrix @ np.concatenate([velocity.ravel(), np.zeros(discretisation.numbering.vertices)]))[velocity.size :]


def test_both_levels_are_carried_over(spinning):
    before = spinning.state
    energy = kinetic_energy(on(spinning, before.mesh), before.mesh.geometry, before.fluid["velocity"])
    spinning.mesh_updater.needs_remesh = lambda *_: True
    after = spinning.mesh_updater.remesh_if_needed(
        before, predict_pose(before.pose, before.twist, before.past_twist, 0.004, before.past_step)
    )
    assert after.mesh is not before.mesh
    new = on(spinning, after.mesh)
    levels = (
        ("", after.mesh.geometry, before.pose, before.twist),
        ("_previous", after.fluid["points_previous"], before.past.pose, before.past.twist),
    )
    fall = np.linalg.norm(before.pose.position - before.past.pose.position)
    for suffix, points, pose, twist in levels:
        velocity, pressure = after.fluid["velocity" + suffix], after.fluid["pressure" + suffix]
        assert np.abs(divergence(new, points, velocity)).max() < 1e-9 * np.abs(velocity).max()
        nodes = new.surfaces.body_nodes[0]
        arm = new.numbering.node_points(points)[nodes] - pose.position[0]
        rigid = twist.velocity[0] + twist.angular_velocity[0] * np.column_stack([-arm[:, 1], arm[:, 0]])
        np.testing.assert_allclose(velocity[nodes], rigid, atol=1e-12)
        # Nodes of a round body go with its centre, and do not turn.
        now = new.numbering.node_points(after.mesh.geometry)[nodes] - before.pose.position[0]
        np.testing.assert_allclose(arm, now, atol=1e-3 * fall)
        assert np.ptp(pressure) > 0.5 * np.ptp(before.fluid["pressure" + suffix])
    lost = energy - kinetic_energy(new, after.mesh.geometry, after.fluid["velocity"])
    assert after.ledger.transfer_loss - before.ledger.transfer_loss == pytest.approx(lost)
    assert before.ledger.kinetic - after.ledger.kinetic == pytest.approx(lost)


@pytest.mark.long
def test_a_new_mesh_in_a_gap_that_closes_keeps_the_energy_of_both_levels():
    """The mesh squeezed with the gap and the new one differ in the disk's added mass, by per cents of the energy."""
    near = {"position": [1.0, 0.325], "velocity": [0.0, -10.0], "density": 3.0}
    fine = {"time": {"step": 0.002, "end": 0.02}, "mesh": {"size": 0.1, "size_body": 0.03}, "output": {"every": 1.0}}
    simulation = Simulation(falling_disk(body=near, **fine))
    simulation.mesh_updater.needs_remesh = lambda *_: False
    while simulation.state.gaps[0] > 0.1:
        simulation.step()
    before = simulation.state
    simulation.mesh_updater.needs_remesh = lambda *_: True
    after = simulation.mesh_updater.remesh_if_needed(before, before.pose)
    for suffix in ("", "_previous"):
        old, new = (
            kinetic_energy(on(simulation, state.mesh), points, state.fluid["velocity" + suffix])
            for state in (before, after)
            for points in [state.fluid["points_previous"] if suffix else state.mesh.geometry]
        )
        assert new == pytest.approx(old, rel=1e-9)
    assert after.ledger.transfer_loss == pytest.approx(0.0, abs=1e-9 * before.ledger.kinetic)


def after_a_new_mesh(simulation, saved):
    simulation.restore(saved)
    simulation.mesh_updater.needs_remesh = lambda state, _: state.tick == saved.state.tick
    return simulation.step()


@pytest.mark.parametrize("solver", ["lu", "schur"])
def test_what_projections_leave_is_no_burst_of_pressure(solver, monkeypatch):
    """Against projections to 1e-12, in the worst case: the flow is still young, and the energy's scale at its limit."""
    scene = falling_disk(body={"angular_velocity": 30.0, "velocity": [0.0, -4.0]}, fluid={"solver": solver}, **SHORT)
    simulation = Simulation(scene)
    simulation.step()
    simulation.step()
    saved = simulation.save()
    found = after_a_new_mesh(simulation, saved)
    nearest = SparseProjection.nearest
    monkeypatch.setattr(
        SparseProjection,
        "nearest",
        lambda self, velocity, _, guess, held=None: nearest(self, velocity, 1e-12, guess, held),
    )
    best = after_a_new_mesh(simulation, saved)
    assert found.mesh.cells is not saved.state.mesh.cells
    pressure = best.fluid["pressure"]
    assert np.abs(found.fluid["pressure"] - pressure).max() < 2e-7 * np.ptp(pressure)
    assert found.ledger.kinetic == pytest.approx(best.ledger.kinetic, rel=1e-8)


def test_a_transfer_assembles_one_matrix_for_each_level(spinning, monkeypatch):
    made, assemble = [], CompiledAssembly.masses
    monkeypatch.setattr(CompiledAssembly, "masses", lambda self, points: made.append(points) or assemble(self, points))
    monkeypatch.setattr(SparseDiscretisation, "solve", None)
    spinning.mesh_updater.needs_remesh = lambda *_: True
    after = spinning.mesh_updater.remesh_if_needed(spinning.state, spinning.state.pose)
    for found, points in zip(made, (after.mesh.geometry, after.fluid["points_previous"]), strict=True):
        np.testing.assert_allclose(found * np.ptp(points) / np.ptp(found), points, rtol=0, atol=1e-12 * np.ptp(points))


def test_flow_beside_potential_flow_is_scaled_by_a_quarter_at_most(spinning):
    """Where the new mesh cannot hold the energy, the rest is lost or gained, and told."""
    state = spinning.state
    target, velocity = on(spinning, state.mesh), state.fluid["velocity"]
    projection = target.projection(state.mesh.geometry, state.pose.position)
    beside = np.where(target.surfaces.velocity_free, velocity, 0.0)
    for square, scale in ((0.0, 0.8), (1e6, 1.25)):
        assert _scale(projection, velocity, beside, square) == scale


def test_a_blow_leaves_the_disk_its_velocity_and_the_energy_in_the_books():
    blow = {"velocity": [0.0, -1.0], "density": 2.0}
    fine = {"time": {"step": 2e-4, "end": 2e-3}, "mesh": {"size": 0.3, "size_body": 0.02}, "output": {"every": 1.0}}
    history = rigidfluid.run(falling_disk(body=blow, fluid={"gravity": [0.0, 0.0]}, **fine))
    assert history.bodies["vy"][1] < -0.9
    added = np.pi * 0.125**2  # the disk's added mass, a little more in a box
    assert history.energy["kinetic"][0] == pytest.approx(0.5 * 3 * added, rel=0.05)
    assert abs(history.summary["energy"]["relative_residual"]) < 0.05


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_constraint_matrix_moves_a_bodys_nodes_rigidly(dimension):
    """P, its transpose by hand and U + ω × r say the same."""
    rng = np.random.default_rng(0)
    size, count = {2: 3, 3: 6}[dimension], 5
    cells = np.arange(dimension + 1)[None]
    numbering = Numbering(cells, dimension + 1)
    nowhere = np.zeros((0, dimension), dtype=np.int64)
    mesh = Mesh(np.zeros((dimension + 1, dimension)), cells, nowhere, np.zeros(0, dtype=np.int64))
    surfaces = Surfaces(numbering, mesh, (), (0,))
    surfaces.body_nodes = [np.arange(count)]
    constraint = Constraint(surfaces, mesh, np.array([False]))
    points, force = rng.normal(size=(numbering.nodes, dimension)), rng.normal(size=(numbering.nodes, dimension))
    position, twist = rng.normal(size=(1, dimension)), rng.normal(size=size)
    constraint.place(points, position)
    everything = np.zeros(constraint.unknowns)
    everything[constraint.twist_start : constraint.twist_start + size] = twist
    moved = (constraint.matrix @ everything)[: numbering.nodes * dimension].reshape(-1, dimension)
    np.testing.assert_allclose(moved[:count], rigid_velocity(twist, points[:count] - position[0]), atol=1e-14)
    padded = np.concatenate([force.ravel(), np.zeros(numbering.vertices)])
    expected = (constraint.transposed @ padded)[constraint.twist_start :][:size]
    np.testing.assert_allclose(surfaces.resultants(force, points, position)[0], expected, atol=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
def test_nodes_go_with_their_own_body_and_push_it_alone(dimension):
    rng = np.random.default_rng(0)
    cells = np.arange(dimension + 1)[None]
    nowhere = np.zeros((0, dimension), dtype=np.int64)
    mesh = Mesh(np.zeros((dimension + 1, dimension)), cells, nowhere, np.zeros(0, dtype=np.int64))
    numbering = Numbering(cells, dimension + 1)
    surfaces = Surfaces(numbering, mesh, (), (0, 1, 2))
    surfaces.body_nodes = on = [np.array([0, 3]), np.array([], dtype=np.int64), np.array([4, 1, 2])]
    points, force, velocity = rng.normal(size=(3, numbering.nodes, dimension))
    position, twist = rng.normal(size=(3, dimension)), rng.normal(size=(3, {2: 3, 3: 6}[dimension]))
    wrench = surfaces.resultants(force, points, position)
    for body, nodes in enumerate(on):
        arm = points[nodes] - position[body]
        by_hand = np.concatenate([force[nodes].sum(axis=0), moment(arm, force[nodes]).sum(axis=0)])
        np.testing.assert_allclose(wrench[body], by_hand, atol=1e-14)
    moved = velocity.copy()
    surfaces.move_with_bodies(moved, points, position, twist, np.array([False, True, True]))
    velocity[on[2]] = rigid_velocity(twist[2], points[on[2]] - position[2])
    np.testing.assert_array_equal(moved, velocity)
