"""Forces on the surfaces of the domain, as a table: of flows that are known, of bodies, of contacts, and in files."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from falling import SCENES
from mesh_files import write_by_meshio

import rigidfluid
from rigidfluid.api import FluidBackend, Mesh, load_results, model_of
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History
from rigidfluid.errors import SceneError

VISCOSITY = 0.5


def scene(**tables: Any) -> rigidfluid.Scene:
    """A step of Stokes flow in a box 2 by 1."""
    common: dict[str, Any] = {
        "scene": {"name": "walls", "dimension": 2},
        "fluid": {"model": "stokes", "density": 1.0, "viscosity": VISCOSITY},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
        "mesh": {"size": 0.25, "size_body": 0.1},
        "time": {"end": 0.1, "step": 0.1},
        "output": {"every": 0.1, "walls": True},
    }
    return scene_from_dict(common | tables)


def boundary(**kinds: dict[str, Any]) -> list[dict[str, Any]]:
    return [{"on": name} | keys for name, keys in kinds.items()]


def at_end(history: History, *names: str) -> dict[str, np.ndarray]:
    """The columns of the last step, forces by default, by the name of the wall."""
    walls = history.walls
    last = walls["step"] == walls["step"].max()
    columns = names or [name for name in ("fx", "fy", "fz") if name in walls]
    values = np.stack([walls[name][last] for name in columns], axis=1)
    return dict(zip(walls["wall"][last].tolist(), values, strict=True))


def total(history: History) -> np.ndarray:
    return np.sum(list(at_end(history).values()), axis=0)


@pytest.mark.parametrize("driven", [{"pressure_drop": 8.0}, {"flux": 2.0 / 3.0}])
def test_periodic_surfaces_have_no_row_and_walls_hold_the_drop(driven: dict[str, float]) -> None:
    """Poiseuille flow u = 4 y (1 - y): half of the drop times the height on each wall, wall shear times length."""
    ends = boundary(left={"type": "periodic"} | driven, right={"type": "periodic"})
    found = at_end(rigidfluid.run(scene(boundary=ends)))
    assert list(found) == ["bottom", "top"]
    for force in found.values():
        np.testing.assert_allclose(force, [4.0 * VISCOSITY * 2.0, 0.0], rtol=0, atol=1e-8)


def test_an_inlet_and_an_outlet_have_rows_and_corners_are_divided_exactly() -> None:
    ends = boundary(
        left={"type": "velocity", "velocity": ["4*y*(1-y)", 0.0]}, right={"type": "pressure", "pressure": 1.0}
    )
    history = rigidfluid.run(scene(boundary=ends))
    found = at_end(history)
    wanted = {"left": [-9.0, 0.0], "right": [1.0, 0.0], "bottom": [4.0, -10.0], "top": [4.0, 10.0]}
    assert list(found) == list(wanted)
    for name, force in wanted.items():
        np.testing.assert_allclose(found[name], force, rtol=0, atol=1e-8)
    areas = at_end(history, "area")
    np.testing.assert_allclose(np.ravel(list(areas.values())), [1.0, 1.0, 2.0, 2.0])
    assert history.walls["step"].min() == 1


def test_sliding_walls_feel_the_shear() -> None:
    """Couette flow, drawn along with the lid and held back by the floor."""
    ends = boundary(left={"type": "periodic"}, right={"type": "periodic"}, top={"type": "wall", "velocity": [3.0, 0.0]})
    found = at_end(rigidfluid.run(scene(boundary=ends)))
    np.testing.assert_allclose(found["top"], [-3.0 * VISCOSITY * 2.0, 0.0], rtol=0, atol=1e-8)
    np.testing.assert_allclose(found["bottom"], [3.0 * VISCOSITY * 2.0, 0.0], rtol=0, atol=1e-8)


def test_the_pressure_of_gravity_is_left_out_and_that_of_a_force_is_not() -> None:
    """At rest walls feel nothing of gravity; a uniform force f on the fluid gives p = f·(x - x̄)."""
    still = {"model": "stokes", "density": 1.0, "viscosity": VISCOSITY}
    heavy = at_end(rigidfluid.run(scene(fluid=still | {"gravity": [0.0, -9.0]})))
    np.testing.assert_array_equal(list(heavy.values()), 0.0)
    pushed = at_end(rigidfluid.run(scene(fluid=still | {"force": [0.3, 0.0]})))
    wanted = {"left": [0.3, 0.0], "right": [0.3, 0.0], "bottom": [0.0, 0.0], "top": [0.0, 0.0]}
    for name, force in wanted.items():
        np.testing.assert_allclose(pushed[name], force, rtol=0, atol=1e-10)


def test_a_sloped_wall_has_its_name_and_force(tmp_path: Path) -> None:
    """A triangle at rest, its slope from (2, 0) to (0, 1), under a uniform force f: p (1, 2) there, p = f·(x - x̄)."""
    points = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    facets = np.array([[0, 1], [1, 2], [2, 0]])
    mesh = Mesh(points, np.array([[0, 1, 2]]), facets, np.arange(3))
    write_by_meshio(tmp_path / "wedge.msh", mesh, ["floor", "slope", "side"])
    domain = {"type": "mesh", "file": str(tmp_path / "wedge.msh")}
    fluid = {"model": "stokes", "density": 1.0, "viscosity": VISCOSITY, "force": [0.3, -0.2]}
    history = rigidfluid.run(scene(domain=domain, fluid=fluid))
    found, pressure = at_end(history), np.array([0.3, -0.2]) @ [1.0 / 3.0, 1.0 / 6.0]
    np.testing.assert_allclose(found["slope"], pressure * np.array([1.0, 2.0]), rtol=0, atol=1e-10)
    np.testing.assert_allclose(total(history), [0.3, -0.2], rtol=0, atol=1e-10)
    assert at_end(history, "area")["slope"] == pytest.approx(np.sqrt(5.0))


@pytest.mark.parametrize("bodies", [1, 3])
def test_walls_that_shear_a_suspension_feel_its_viscosity(bodies: int) -> None:
    """The tangential stress of the walls is that of the fluid and of stresslets over the volume."""
    tables = tomllib.loads((SCENES / "sheared_cell.toml").read_text())
    tables["output"]["walls"], tables["mesh"]["size_body"] = True, 0.4
    places = [[8.86225, 8.86225], [4.0, 12.0], [13.0, 5.0]][:bodies]
    tables["body"] = [tables["body"][0] | {"name": f"disk_{i}", "position": place} for i, place in enumerate(places)]
    history, side = rigidfluid.run(scene_from_dict(tables)), 17.7245
    last = history.stresslets["step"] == history.stresslets["step"].max()
    by_stresslets = 1.0 + history.stresslets["sxy"][last].sum() / side**2
    found = at_end(history)
    assert by_stresslets > 1.015
    assert -found["top"][0] / side == pytest.approx(by_stresslets, rel=1e-6)
    assert found["bottom"][0] / side == pytest.approx(by_stresslets, rel=1e-6)


def falling(*bodies: dict[str, Any], **tables: Any) -> rigidfluid.Scene:
    """Balls that fall in a box of side 1."""
    dimension = len(bodies[0]["position"])
    gravity = [0.0, -1.0, 0.0][:dimension]
    common: dict[str, Any] = {
        "scene": {"name": "falling", "dimension": dimension},
        "fluid": {"density": 1.0, "viscosity": 0.1, "gravity": gravity},
        "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
        "body": [{"type": "sphere", "radius": 0.15, "density": 3.0} | body for body in bodies],
    }
    return scene(**(common | tables))


def test_momentum_of_fluid_and_body_changes_by_weight_and_walls() -> None:
    """In a closed box the fluid has the momentum -ρV U, that of the body's volume the other way: the walls take what
    weight gives, less (m - ρV) dU/dt."""
    step, excess = 0.01, 2.0 * np.pi * 0.15**2
    tables = {"mesh": {"size": 0.1, "size_body": 0.04}, "time": {"end": 0.1, "step": step}}
    history = rigidfluid.run(falling({"position": [0.4, 0.6]}, **tables, output={"every": 0.1, "walls": True}))
    velocity = np.column_stack([history.bodies["vx"], history.bodies["vy"]])
    rate = (1.5 * velocity[-1] - 2.0 * velocity[-2] + 0.5 * velocity[-3]) / step
    assert np.linalg.norm(rate) > 0.1
    wanted = excess * (np.array([0.0, -1.0]) - rate)
    np.testing.assert_allclose(total(history), wanted, rtol=0, atol=2e-3 * excess)


@pytest.mark.parametrize("dimension", [2, 3])
def test_in_stokes_flow_walls_hold_the_weight(dimension: int) -> None:
    """To the solver's accuracy, of bodies without inertia."""
    volume = {2: np.pi * 0.15**2, 3: 4.0 / 3.0 * np.pi * 0.15**3}[dimension]
    bodies = [{"position": [0.4, 0.6, 0.45][:dimension], "density": 1e-9}]
    fluid = {"model": "stokes", "density": 1.0, "viscosity": 0.1, "gravity": [0.0, -1.0, 0.2][:dimension]}
    mesh = {"size": 0.3, "size_body": 0.1 if dimension == 3 else 0.05}
    time = {"end": 1e-3, "step": 1e-3}
    history = rigidfluid.run(falling(*bodies, fluid=fluid, mesh=mesh, time=time, output={"every": 1e-3, "walls": True}))
    weight = volume * np.array([0.0, 1.0, -0.2])[:dimension]
    np.testing.assert_allclose(total(history), weight, rtol=0, atol=1e-7)
    assert list(at_end(history)) == ["left", "right", "bottom", "top", "back", "front"][: 2 * dimension]


def test_contacts_push_walls_as_they_push_bodies() -> None:
    """Two disks in a corner: forces of contacts.csv on each wall, the other way."""
    law = {"law": "spring-dashpot", "range": 0.05, "stiffness": 10.0, "restitution": 0.5}
    bodies = [{"position": [0.17, 0.17], "name": "a"}, {"position": [0.5, 0.17], "name": "b"}]
    tables = {"contact": law, "mesh": {"size": 0.3, "size_body": 0.1}, "time": {"end": 0.01, "step": 0.005}}
    history = rigidfluid.run(falling(*bodies, **tables, output={"every": 0.01, "walls": True}))
    contacts, found = history.contacts, at_end(history, "contact_fx", "contact_fy")
    last = contacts["step"] == contacts["step"].max()
    for wall in ("left", "bottom"):
        on = last & (contacts["b"] == wall)
        pushed = -np.array([contacts["fx"][on].sum(), contacts["fy"][on].sum()])
        assert np.linalg.norm(pushed) > 0.01
        np.testing.assert_allclose(found[wall], pushed, rtol=1e-12)
    np.testing.assert_array_equal([found["right"], found["top"]], 0.0)


def test_rows_are_resumed_to_the_last_bit_and_read_from_the_folder(tmp_path: Path) -> None:
    output, body = {"every": 0.1, "walls": True}, {"position": [0.4, 0.6]}
    whole = rigidfluid.run(falling(body, time={"end": 0.2, "step": 0.05}, output=output), tmp_path / "whole")
    rigidfluid.run(falling(body, time={"end": 0.1, "step": 0.05}, output=output), tmp_path / "parts")
    rigidfluid.run(falling(body, time={"end": 0.2, "step": 0.05}, output=output), tmp_path / "parts", resume=True)
    one, other = ((tmp_path / name / "walls.csv").read_bytes() for name in ("whole", "parts"))
    assert one == other
    assert one.count(b"\n") == 1 + 4 * int(whole.steps["step"][-1]) > 4
    read = load_results(tmp_path / "whole").walls
    np.testing.assert_array_equal(read["fy"], whole.walls["fy"])


def test_a_run_that_does_not_want_them_has_none() -> None:
    assert len(rigidfluid.run(scene(output={"every": 0.1})).walls["fx"]) == 0


def test_a_backend_without_them_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "boundary_forces", FluidBackend.boundary_forces)
    with pytest.raises(SceneError, match=r"output.walls: found true with backend 'scikit-fem'"):
        model_of(scene())
