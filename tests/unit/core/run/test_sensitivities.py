"""Derivatives of a run by values of its scene, against differences of whole runs."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables, wet_tables

from rigidfluid.api import SceneError, SceneErrors, Simulation, load_results, run, scene_from_dict
from rigidfluid.checks.report import check
from rigidfluid.core.scene.overrides import assign
from rigidfluid.taylor_hood.sparse_backend import SparseBackend
from rigidfluid.taylor_hood.stepping import response

STEPS, FEW, SHARE = 8, 2, 1e-4
EXACT = {"gravity": [0.0, -1.0], "tolerance": 1e-12}
DISK = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.4, 0.6]}
OAR = {
    **{"name": "oar", "type": "ellipsoid", "semi_axes": [0.12, 0.05], "density": 1.5},
    **{"position": [0.65, 0.3], "angle": 0.3},
}
DRIVEN = DISK | {"prescribed": {"amplitude": [0.05, 0.0], "frequency": 1.0}}
BALL = DISK | {"position": [0.5, 0.12], "velocity": [0.0, -1.0]}
BALL_3D = {"name": "ball", "type": "sphere", "radius": 0.25, "density": 2.0, "position": [0.5, 0.45, 0.6]}
LAW = {"law": "centre", "range": 0.02, "epsilon": 1e-6}
SOFT = LAW | {"epsilon": 1e-5}
SUNK = DISK | {"position": [0.5, 0.115]}
PERIODIC = [{"on": "left", "type": "periodic", "pressure_drop": 0.3}, {"on": "right", "type": "periodic"}]
ENDLESS = [{"on": side, "type": "periodic"} for side in ("left", "right", "bottom", "top")]
PUSHED = [
    {"on": "left", "type": "velocity", "velocity": [0.5, 0.0]},
    {"on": "right", "type": "pressure", "pressure": 0.0},
]


def wet(*bodies: dict[str, Any], fluid: dict[str, Any] | None = None, **tables: Any) -> dict[str, Any]:
    return wet_tables(*bodies, fluid=EXACT | (fluid or {}), **tables)


CARREAU = wet(OAR)
CARREAU["fluid"].pop("viscosity")
CARREAU["fluid"]["material"] = {
    **{"type": "carreau", "viscosity": 0.1, "viscosity_infinite": 0.02},
    **{"relaxation_time": 100.0, "exponent": 0.6},
}

CASES = {
    "density of a falling disk": (wet(DISK), "body.0.density"),
    "viscosity, with a body that turns": (wet(DISK, OAR), "fluid.viscosity"),
    "gravity": (wet(DISK), "fluid.gravity.1"),
    "density of the fluid": (wet(OAR), "fluid.density"),
    "amplitude of a driven motion": (wet(DRIVEN, OAR), "body.0.prescribed.amplitude.0"),
    "viscosity without inertia": (wet(DISK, OAR, fluid={"model": "stokes"}), "fluid.viscosity"),
    "inflow": (wet(OAR, boundary=PUSHED), "boundary.0.velocity.0"),
    "drop of pressure": (
        wet(OAR, boundary=PERIODIC),
        "boundary.0.pressure_drop",
    ),
    "viscosity between seams alone": (wet(DISK, OAR, boundary=ENDLESS), "fluid.viscosity"),
    "material": (
        CARREAU,
        "fluid.material.exponent",
    ),
    "three dimensions": (
        wet(BALL_3D, fluid={"gravity": [0.0, 0.0, -1.0]}, mesh={"size": 0.7, "size_body": 0.4}),
        "body.0.density",
    ),
    "law of a contact": (wet(SUNK, contact=SOFT), "contact.epsilon"),
    "law of a contact, dry": (dry_tables(BALL, contact=LAW, fluid={"gravity": [0.0, -1.0]}), "contact.epsilon"),
}


def started(tables: dict[str, Any], *keys: str) -> Simulation:
    tables = deepcopy(tables)
    tables["output"]["sensitivities"] = list(keys)
    simulation = Simulation(scene_from_dict(tables))
    simulation.mesh_updater.needs_remesh = lambda state, pose: False
    return simulation


def gone(simulation: Simulation, steps: int = STEPS) -> Simulation:
    for _ in range(steps):
        simulation.step()
    return simulation


def latest(simulation: Simulation) -> dict[str, np.ndarray]:
    """Numbers of the latest state's row of each body, by column."""
    table, count = simulation.history.bodies, len(simulation.system.bodies)
    return {name: values[-count:] for name, values in table.items() if name not in ("time", "step", "body", "gap")}


def by_differences(tables: dict[str, Any], key: str, steps: int) -> dict[str, np.ndarray]:
    """Derivatives of the latest state by differences of two whole runs, which take the same steps."""
    scene = scene_from_dict(deepcopy(tables)).to_dict()
    value: Any = scene
    for part in key.split("."):
        value = value[int(part) if isinstance(value, list | tuple) else part]
    found, sizes = [], []
    for sign in (1.0, -1.0):
        beside = deepcopy(scene)
        assign(beside, key, value * (1.0 + sign * SHARE))
        simulation = gone(started(beside), steps)
        found.append(latest(simulation))
        sizes.append(simulation.history.steps["size"])
    assert np.array_equal(*sizes)
    plus, minus = found
    return {column: (plus[column] - minus[column]) / (2.0 * value * SHARE) for column in plus}


def groups(row: dict[str, np.ndarray], dimension: int) -> dict[str, np.ndarray]:
    """Columns of one quantity together; torques with the forces whose rounding they have."""
    axes = "xyz"[:dimension]
    turns = [""] if dimension == 2 else axes
    return {
        "position": np.array([row[a] for a in axes]),
        "velocity": np.array([row[f"v{a}"] for a in axes]),
        "angular velocity": np.array([row[f"w{a}"] for a in turns]),
        "wrench": np.array([row[f"f{a}"] for a in axes] + [row[f"t{a}"] for a in turns]),
        "contact": np.array([row[f"cf{a}"] for a in axes]),
    }


@pytest.mark.parametrize(
    ("tables", "key"),
    [
        pytest.param(*case, id=name, marks=pytest.mark.long if name == "three dimensions" else ())
        for name, case in CASES.items()
    ],
)
def test_derivatives_are_differences_of_whole_runs(tables: dict[str, Any], key: str) -> None:
    steps = FEW if tables["scene"]["dimension"] == 3 else STEPS
    assert_differences(tables, key, steps, 1e-6)


def test_derivatives_go_on_through_a_touch(monkeypatch: pytest.MonkeyPatch) -> None:
    """With impulse responses that do not depend on the age of factors, which differs between a run and its neighbours:
    as they are solved otherwise, both differ by 1e-5 of the contact's force."""
    monkeypatch.setattr(response, "_TOLERANCE", 1e-10)
    sinking = wet(DISK | {"position": [0.5, 0.122]}, contact=SOFT, fluid={"gravity": [0.0, -40.0]})
    simulation = assert_differences(sinking, "fluid.gravity.1", STEPS, 1e-6)
    pressed = simulation.history.sensitivities["cfy"]
    assert pressed[0] == pressed[STEPS // 2] == 0.0 != pressed[-1]


def assert_differences(tables: dict[str, Any], key: str, steps: int, tolerance: float) -> Simulation:
    """Compare the derivatives after some steps with differences; returns the run."""
    simulation = gone(started(tables, key), steps)
    count, dimension = len(simulation.system.bodies), simulation.model.dimension
    found = {name: values[-count:] for name, values in simulation.history.sensitivities.items()}
    assert set(found["parameter"]) == {key}
    assert found["step"][-1] == steps
    expected = groups(by_differences(tables, key, steps), dimension)
    assert np.any(expected["position"])
    for name, values in groups(found, dimension).items():
        scale, rounding = np.linalg.norm(expected[name]), 1e-9 * (name == "angular velocity")
        assert np.linalg.norm(values - expected[name]) <= tolerance * scale + rounding, name
    return simulation


def test_a_run_goes_on_as_without_its_derivatives() -> None:
    tables = wet(DISK, OAR, fluid={"tolerance": 1e-9})
    alone, watched = gone(started(tables)), gone(started(tables, "fluid.viscosity", "body.1.density"))
    for name, values in alone.history.bodies.items():
        np.testing.assert_array_equal(values, watched.history.bodies[name])


def remade(simulation: Simulation) -> None:
    simulation.mesh_updater.needs_remesh = lambda state, pose: True


def driven_elsewhere(simulation: Simulation) -> None:
    simulation.prescribe("disk", velocity=[0.0, 0.1])


@pytest.mark.parametrize(
    ("change", "reason"), [(remade, "domain was re-meshed"), (driven_elsewhere, "changed from outside")]
)
def test_derivatives_end_where_there_are_none(change: Any, reason: str) -> None:
    simulation = gone(started(wet(DISK | {"prescribed": {"velocity": [0.1, 0.0]}}), "fluid.viscosity"), FEW)
    change(simulation)
    gone(simulation, FEW)
    simulation.finish("complete")
    table = simulation.history.sensitivities
    assert table["step"][-1] == FEW
    texts = [remark["text"] for remark in simulation.history.summary["remarks"]]
    assert any(reason in text and f"at time {table['time'][-1]:.6g}" in text for text in texts)


def test_derivatives_go_on_after_going_back() -> None:
    simulation = gone(started(wet(DISK), "fluid.viscosity"), FEW)
    saved = simulation.save()
    before = gone(simulation, FEW).history.sensitivities
    remade(simulation)
    gone(simulation, 1)
    simulation.restore(saved)
    simulation.mesh_updater.needs_remesh = lambda state, pose: False
    after = gone(simulation, FEW).history.sensitivities
    assert after["step"].tolist() == before["step"].tolist() == list(range(2 * FEW + 1))
    for name in ("y", "vy", "fy"):
        np.testing.assert_allclose(after[name], before[name], rtol=1e-9, atol=0)


def test_a_resumed_run_has_those_until_its_checkpoint(tmp_path: Path) -> None:
    tables = wet(DISK, end=0.04)
    tables["output"] |= {"every": 0.02, "sensitivities": ["fluid.viscosity"]}
    scene = scene_from_dict(tables)
    simulation = Simulation(scene, tmp_path)
    simulation.go(until=0.02)
    simulation.close()
    history = run(scene, tmp_path, resume=True)
    table = load_results(tmp_path).sensitivities
    assert set(table["body"]) == {"disk"}
    assert table["time"][-1] == pytest.approx(0.02)
    assert any("resumed" in remark["text"] for remark in history.summary["remarks"])


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("fluid.thickness", "a key that the scene has"),
        ("body.0.name", "a number other than 0"),
        ("fluid.gravity.0", "a number other than 0"),
        ("body.3.density", "a key that the scene has"),
        ("mesh.size", "a key of another table"),
        ("body.0.radius", "no shape and no place depends"),
        ("body.0.position.0", "no shape and no place depends"),
    ],
)
def test_keys_without_a_derivative_are_refused(key: str, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        started(wet(DISK), key)
    with pytest.raises(SceneError, match=words):
        check(scene_from_dict(wet(DISK, output={"every": 1.0, "sensitivities": [key]})))


def test_all_keys_without_a_derivative_are_told_at_once() -> None:
    keys = ["fluid.viscositi", "body.3.density", "fluid.viscosity", "fluid.viscosity"]
    with pytest.raises(SceneErrors) as told:
        check(scene_from_dict(wet(DISK, output={"every": 1.0, "sensitivities": keys})))
    assert [error.subject for error in told.value.single_errors] == [f"output.sensitivities.{n}" for n in (0, 1, 3)]
    assert "Did you mean 'viscosity'?" in str(told.value)


def test_a_lone_number_in_a_list_has_a_derivative() -> None:
    table = started(wet(DISK | {"angular_velocity": 2.0}), "body.0.angular_velocity").history.sensitivities
    assert table["w"][0] == pytest.approx(1.0)


def test_backends_without_derivatives_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SparseBackend, "tangents", False)
    with pytest.raises(SceneError, match=r"output\.sensitivities: found backend 'scikit-fem'"):
        started(wet(DISK), "fluid.viscosity")


def test_held_bodies_are_refused() -> None:
    with pytest.raises(SceneError, match="held directions"):
        started(wet(DISK | {"free": ["y"]}), "fluid.viscosity")
