"""Error bars: estimates beside true errors, columns, resumption, and what refuses them."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from falling import SCENES
from scenes import wet_tables

import rigidfluid
from rigidfluid.api import FluidBackend, Simulation, model_of
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.generation.refined_mesh import refined_mesh
from rigidfluid.core.model.flow_error import RefinedFlow
from rigidfluid.errors import SceneError, StepError
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.stepping.refined_flow import prolonged

COARSE = ("mesh.size=0.05", "mesh.size_body=0.02", "time.step=1.0", "time.end=2.0", "output.every=2.0")
DRAG, LIFT = 5.57953523384, 0.010618948146
"""Coefficients of DFG 2D-1, converged (John and Matthies 2001)."""


def falling(**tables):
    disk = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 1.5, "position": [0.5, 0.5]}
    common = {"fluid": {"gravity": [0.0, -1.0]}, "output": {"every": 0.1, "error_bars": True}}
    return scene_from_dict(wet_tables(disk, end=0.2, step=0.02, **(common | tables)))


@pytest.mark.parametrize("order", [1, 2])
def test_the_mesh_estimate_is_the_true_error_of_drag_and_lift(order: int) -> None:
    """On straight cells most of it is the error of the geometry."""
    wanted = ["fluid.initial=steady", "output.error_bars=true", f"mesh.order={order}", *COARSE]
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "dfg_cylinder.toml", wanted))
    for name, reference in (("fx", DRAG), ("fy", LIFT)):
        missing = reference / 500.0 - history.bodies[name][-1]
        assert 0.9 < history.error_estimates[f"{name}_mesh"][-1] / missing < 1.4
        assert abs(history.error_estimates[f"{name}_steps"][-1]) < 1e-6 * DRAG


@pytest.mark.long
def test_errors_of_a_flow_that_was_steady_grow_once_its_inflow_varies() -> None:
    """Compared with cells of half the length. Errors of drag go through zero at the end."""
    inflow = "boundary.0.velocity=['0.3*(1 + 0.5*sin(pi*t))', 0.0]"
    times = ("time.step=0.1", "time.end=2.0", "output.every=1.0", inflow)
    coarse, fine = (
        rigidfluid.run(
            rigidfluid.load_scene(
                SCENES / "dfg_cylinder.toml",
                [
                    "fluid.initial=steady",
                    f"output.error_bars={bars}",
                    f"mesh.size={size}",
                    f"mesh.size_body={body}",
                    *times,
                ],
            )
        )
        for bars, size, body in (("true", 0.05, 0.02), ("false", 0.025, 0.01))
    )
    for name in ("fx", "fy"):
        missing = (fine.bodies[name] - coarse.bodies[name])[[10, 20]]
        found = coarse.error_estimates[f"{name}_mesh"]
        assert np.abs(found - missing)[1] < 0.15 * np.abs(missing).max()


def test_estimates_lead_from_coarse_cells_and_long_steps_to_finer_and_shorter_ones() -> None:
    """Steps of a quarter and cells of a half leave a fourteenth and at most a quarter of the errors."""
    coarse = rigidfluid.run(falling(mesh={"size": 0.2, "size_body": 0.06}))
    short = falling(mesh={"size": 0.2, "size_body": 0.06}, time={"step": 0.005})
    fine = falling(mesh={"size": 0.1, "size_body": 0.03})
    here = coarse.bodies["vy"][-1]
    by_steps, by_mesh = (rigidfluid.run(one).bodies["vy"][-1] - here for one in (short, fine))
    found = coarse.error_estimates
    assert 0.5 < found["vy_steps"][-1] / by_steps < 3.0
    assert 0.5 < found["vy_mesh"][-1] / by_mesh < 3.0


def test_estimates_change_nothing_and_are_resumed_to_the_last_bit(tmp_path: Path) -> None:
    rigidfluid.run(falling(), tmp_path / "whole")
    rigidfluid.run(falling(time={"end": 0.1}), tmp_path / "parts")
    rigidfluid.run(falling(), tmp_path / "parts", resume=True)
    without = rigidfluid.run(falling(output={"error_bars": False}), tmp_path / "without")
    for name in ("error_estimates", "bodies"):
        whole, parts = ((tmp_path / folder / f"{name}.csv").read_bytes() for folder in ("whole", "parts"))
        assert whole == parts
    assert whole == (tmp_path / "without" / "bodies.csv").read_bytes()
    assert len(without.error_estimates["time"]) == 0


def test_sensitivities_go_on_with_error_bars() -> None:
    common = {"every": 0.04, "sensitivities": ["body.0.density"]}
    with_bars, without = (
        rigidfluid.run(falling(time={"end": 0.08}, output=common | {"error_bars": wanted})) for wanted in (True, False)
    )
    assert with_bars.sensitivities["time"][-1] == pytest.approx(0.08)
    np.testing.assert_array_equal(with_bars.sensitivities["vy"], without.sensitivities["vy"])


def test_estimates_are_the_same_after_going_back() -> None:
    """An output right after the saved state compares with that one, which the longer steps have reached."""
    simulation = Simulation(model_of(falling(time={"end": 0.1})))
    simulation.go(0.08)
    saved = simulation.save()
    simulation.go()
    before = simulation.history.error_estimates
    simulation.restore(saved)
    simulation.go()
    assert np.isfinite(before["vy_steps"]).all()
    for name, values in simulation.history.error_estimates.items():
        np.testing.assert_array_equal(values, before[name])


def test_a_run_in_a_folder_keeps_nothing_of_the_one_beside_it_but_the_latest_states(tmp_path: Path) -> None:
    with closing(Simulation(model_of(falling()), tmp_path)) as simulation:
        simulation.go()
    bars = simulation.recorder.companions._bars
    assert bars is not None
    assert bars._beside.history.lengths == {}
    assert len(bars._other) == 1


def test_nothing_is_asked_of_a_scene_after_its_end() -> None:
    ends = {"on": "left", "type": "velocity", "velocity": ["0.1*sqrt(0.09 - t)", 0.0]}
    scene = falling(boundary=[ends, {"on": "right", "type": "pressure", "pressure": 0.0}], time={"end": 0.08})
    found = rigidfluid.run(scene).error_estimates
    assert np.isfinite(found["vy_steps"][-1])


def test_steps_that_are_too_long_beside_are_told_with_their_length_and_leave_earlier_results(tmp_path: Path) -> None:
    rigidfluid.run(falling(output={"error_bars": False}), tmp_path)
    before = (tmp_path / "bodies.csv").read_bytes()
    with pytest.raises(SceneError, match=r"output.error_bars, with steps of 0.04: mesh.remesh_every: found 0.03"):
        rigidfluid.run(falling(mesh={"remesh_every": 0.03}), tmp_path)
    assert (tmp_path / "bodies.csv").read_bytes() == before


def test_the_start_tells_nothing_of_the_error_by_steps() -> None:
    """Before the longer steps have been taken once both runs are at the start, where they are the same."""
    found = rigidfluid.run(falling(output={"every": 0.02, "error_bars": True}, time={"end": 0.04})).error_estimates
    assert np.isnan(found["vy_steps"]).tolist() == [True, False]


def test_memory_that_halved_edges_lack_is_told_with_the_key(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(ScikitFem, "refinement", refuse)
    with pytest.raises(StepError, match=r"output.error_bars, with halved edges: memory: found too little of it"):
        rigidfluid.run(falling())


def test_a_velocity_that_is_given_has_no_error_and_its_force_has_one() -> None:
    moved = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 1.5, "position": [0.5, 0.5]}
    tables = wet_tables(moved | {"prescribed": {"velocity": [0.0, 1.0]}}, end=0.1, step=0.02)
    found = rigidfluid.run(scene_from_dict(tables | {"output": {"every": 0.1, "error_bars": True}})).error_estimates
    assert not any(found[f"{name}_{cause}"].any() for name in ("vx", "vy", "w") for cause in ("mesh", "steps"))
    assert found["fy_mesh"].all()


def test_what_a_caller_does_to_bodies_leaves_the_error_by_steps_unknown() -> None:
    simulation = Simulation(model_of(falling()))
    simulation.apply("disk", force=[0.1, 0.0])
    simulation.go()
    assert np.isnan(simulation.history.error_estimates["vy_steps"]).all()
    assert np.isfinite(simulation.history.error_estimates["vy_mesh"]).all()


def test_a_backend_without_them_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "refinements", FluidBackend.refinements)
    with pytest.raises(SceneError, match=r"output.error_bars: found true with backend 'scikit-fem'"):
        model_of(falling())


def test_bodies_that_leave_are_refused() -> None:
    with pytest.raises(SceneError, match=r"output.error_bars: found true with bodies that enter or leave"):
        model_of(falling(sink=[{"on": "bottom"}]))


def test_other_bodies_leave_the_error_by_steps_unknown() -> None:
    simulation = Simulation(model_of(falling()))
    simulation.add({"name": "other", "type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.2, 0.2]})
    simulation.go(0.1)
    found = simulation.history.error_estimates
    assert found["body"].tolist() == ["disk", "other"]
    assert np.isnan(found["vy_steps"]).all()
    assert np.isfinite(found["vy_mesh"]).all()


def test_the_summary_has_the_latest_and_the_greatest() -> None:
    history = rigidfluid.run(falling())
    table, found = history.error_estimates, history.summary["error_estimates"]["disk"]["velocity"]
    sizes = np.hypot(table["vx_mesh"], table["vy_mesh"])
    assert (found["mesh"], found["greatest_mesh"]) == pytest.approx((sizes[-1], sizes.max()))
    assert found["steps"] > 0.0
    assert found["bar"] == pytest.approx(1.25 * (found["mesh"] + found["steps"]))


def test_cells_that_follow_an_accuracy_have_estimates_too_and_are_the_same_with_them() -> None:
    mesh = {"size": "auto", "size_body": "auto", "accuracy": 0.02}
    found, without = (rigidfluid.run(falling(mesh=mesh, output={"error_bars": bars})) for bars in (True, False))
    assert found.summary["remeshes"] == without.summary["remeshes"] >= 1
    for name in ("vy", "fy"):
        np.testing.assert_array_equal(found.bodies[name], without.bodies[name])
        assert np.isfinite(found.error_estimates[f"{name}_mesh"]).all()
        assert np.isfinite(found.error_estimates[f"{name}_steps"]).all()


def test_errors_of_a_fall_decay_as_they_do() -> None:
    """The force is the disk's mass times its acceleration: its error is its mass times the rate of the speed's."""
    end = {"end": 0.4}
    coarse = rigidfluid.run(falling(mesh={"size": 0.2, "size_body": 0.06}, time=end))
    finer = falling(mesh={"size": 0.07, "size_body": 0.015}, time=end, output={"error_bars": False})
    fine, found = rigidfluid.run(finer), coarse.error_estimates
    for name in ("vy", "fy"):
        missing = fine.bodies[name][-1] - coarse.bodies[name][-1]
        assert 0.7 < found[f"{name}_mesh"][-1] / missing < 1.4


def test_the_mesh_follows_the_error_of_a_fast_disk() -> None:
    """With the run's own mesh velocity the estimate is 2.8 times as large as the error."""
    common = ["time.step=0.008", "time.end=0.24", "output.every=0.04"]
    coarse, fine = (
        rigidfluid.run(rigidfluid.load_scene(SCENES / "falling_disk.toml", [*common, *mesh]))
        for mesh in (
            ["mesh.size=0.4", "mesh.size_body=0.06", "output.error_bars=true"],
            ["mesh.size=0.15", "mesh.size_body=0.015"],
        )
    )
    assert 1.0 < coarse.error_estimates["vy_mesh"][-1] / (fine.bodies["vy"][-1] - coarse.bodies["vy"][-1]) < 1.7


def test_errors_on_a_new_mesh_are_those_from_the_flow_before() -> None:
    """The sum of flow and error is the same at all nodes that both finer meshes have."""
    simulation = Simulation(model_of(falling()))
    simulation.go()
    state, system = simulation.state, simulation.system
    around, backend = fluid_domain_at(system, state.pose), system.backend
    assert state.flow_error is not None
    mesh = refined_mesh(state.mesh, around)
    fluid, _ = backend.transfer(state.fluid, state.mesh, mesh)
    old = RefinedFlow(state.fluid, state.mesh, mesh)
    new = RefinedFlow(fluid, mesh, refined_mesh(mesh, around))
    carried = backend.carried_errors(state.flow_error.velocity, old, new)
    before = prolonged(
        state.fluid, *(numbered for place in old[1:] for numbered in (Numbering.from_mesh(place), place))
    )
    shared = len(before["velocity"])
    sums = before["velocity"] + state.flow_error.velocity
    assert carried.shape == (2, len(Numbering.from_mesh(new.finer).edges) + shared, 2)
    assert np.abs(fluid["velocity"] + carried[:, :shared] - sums).max() < 1e-12 * np.abs(sums).max()
    assert np.abs(carried[:, :shared] - state.flow_error.velocity).max() > 1e-9 * np.abs(sums).max()


def test_a_scene_without_bodies_has_no_rows() -> None:
    disk = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 1.5, "position": [0.5, 0.5]}
    empty = {"body": [], "output": {"every": 0.04, "error_bars": True}}
    history = rigidfluid.run(scene_from_dict(wet_tables(disk, end=0.04, step=0.02) | empty))
    assert len(history.error_estimates["time"]) == 0
