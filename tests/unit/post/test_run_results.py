"""Results read back from a run's folder: complete, going on, cut off, dry, of a model made in Python."""

from __future__ import annotations

import json
import math
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import Table, dry_tables, wet_tables

import rigidfluid
from rigidfluid.api import ArgumentError, OutputError, Simulation, load_results, model_of, scene_from_dict

DISK = {
    "name": "disk",
    "type": "sphere",
    "radius": 0.1,
    "density": 2.0,
    "position": [0.5, 0.5],
    "velocity": [0.0, -0.5],
}
TABLES = ("bodies", "contacts", "joints", "energy", "steps", "probes", "driving", "stresslets")


def wet_scene(**tables: Any) -> Any:
    probes = {"output": {"every": 0.02, "probes": [[0.2, 0.2], [0.8, 0.8]]}}
    return scene_from_dict(wet_tables(DISK, end=0.04, **(probes | tables)))


def dry_scene(*bodies: Table, **tables: Any) -> Any:
    return scene_from_dict(dry_tables(*(bodies or (DISK,)), end=0.04, **({"output": {"every": 0.02}} | tables)))


def test_a_complete_run_is_what_it_was_in_memory(tmp_path: Path) -> None:
    history = rigidfluid.run(wet_scene())
    rigidfluid.run(wet_scene(), tmp_path)
    results = load_results(str(tmp_path))
    for name in TABLES:
        read = results.table(name)
        assert list(read) == list(history.columns[name])
        for column, values in history.table(name).items():
            np.testing.assert_array_equal(read[column], values)
    assert len(results.probes["time"]) == 2 * len(results.energy["time"]) > 10
    assert results.summary["status"] == "complete"
    assert results.scene == wet_scene()
    assert list(results.table("bodies", ("vy",))) == ["vy"]


@pytest.mark.parametrize("dimension", [2, 3])
def test_fields_of_an_output_are_those_of_the_simulation_then(dimension: int, tmp_path: Path) -> None:
    body = DISK | {"position": [0.5] * dimension, "velocity": [0.0, -0.5, 0.0][:dimension], "radius": 0.2}
    mesh = {"size": 0.4, "size_body": 0.2}
    scene = scene_from_dict(wet_tables(body, end=0.02, mesh=mesh, output={"every": 0.01}))
    simulation, kept = Simulation(scene, tmp_path), {}
    kept[0.0] = simulation.fields()
    simulation.observe(lambda now: kept.update({now.time: now.fields()}), every=0.01)
    simulation.go()
    simulation.close()
    results = load_results(tmp_path)
    np.testing.assert_allclose(results.times, [0.0, 0.01, 0.02])
    for time, fields in kept.items():
        read = results.fields(min(time + 0.003, 0.02))
        assert read.time == fields.time == time
        np.testing.assert_array_equal(read.cells, fields.cells)
        np.testing.assert_array_equal(read.points, fields.points)
        np.testing.assert_allclose(read.velocity, fields.velocity, atol=1e-6)
        np.testing.assert_allclose(read.pressure, fields.pressure, rtol=1e-6, atol=1e-6)
    assert results.fields().time == 0.02
    assert np.abs(results.fields().velocity).max() > 0.1


def test_fields_are_those_of_the_fluid_of_a_time_that_has_bodies_and_contacts_too(tmp_path: Path) -> None:
    near = DISK | {"position": [0.5, 0.105], "velocity": [0.0, 0.0]}
    contact = {"law": "normal", "range": 0.02, "epsilon": 1e-4}
    rigidfluid.run(scene_from_dict(wet_tables(near, end=0.01, contact=contact, output={"every": 0.01})), tmp_path)
    listed = [entry.attrib["name"] for entry in ET.parse(tmp_path / "fields.pvd").iter("DataSet")]
    assert listed == 2 * ["fluid", "bodies", "contacts"]
    results = load_results(tmp_path)
    assert len(results.contacts["gap"]) > 0
    assert results.times.tolist() == [0.0, 0.01]
    for time in results.times:
        assert results.fields(time).cells.shape[1] == 6


def test_a_run_that_goes_on_has_whole_states_alone(tmp_path: Path) -> None:
    other = DISK | {"name": "other", "position": [0.8, 0.8]}
    simulation = Simulation(dry_scene(DISK, other), tmp_path)
    simulation.go(until=0.02)
    simulation.close()
    results = load_results(tmp_path)
    assert results.summary == {}
    for table, torn in (("bodies", "0.03,3,disk,0.5,0.48,0.0"), ("energy", "0.03,3,1.")):
        whole = (tmp_path / f"{table}.csv").read_text().splitlines()
        # the next state is written up to its second row
        text = [*whole, whole[-2 if table == "bodies" else -1].replace("0.02,2,", "0.03,3,"), torn]
        (tmp_path / f"{table}.csv").write_text("\n".join(text if table == "bodies" else [*whole, torn]))
    assert results.bodies["step"].tolist() == [0, 0, 1, 1, 2, 2]
    assert results.energy["step"].tolist() == [0, 1, 2]
    assert results.table("bodies", ("vy",))["vy"].shape == (6,)
    assert results.scene == dry_scene(DISK, other)


def test_tables_grow_while_the_run_goes_on(tmp_path: Path) -> None:
    simulation = Simulation(wet_scene(), tmp_path)
    results = load_results(tmp_path)
    assert (results.bodies["time"].tolist(), results.times.tolist()) == ([0.0], [0.0])
    simulation.go()
    simulation.close()
    assert results.bodies["step"].tolist() == list(range(simulation.state.count + 1))
    assert results.fields().time == pytest.approx(0.04)


def test_an_interrupted_run_says_so(tmp_path: Path) -> None:
    def interrupt(now: Any) -> None:
        if now.time > 0.015:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rigidfluid.run(dry_scene(), tmp_path, progress=interrupt)
    results = load_results(tmp_path)
    assert results.summary["status"] == "interrupted"
    assert results.bodies["step"].tolist() == [0, 1, 2]


def test_coordinates_of_all_joints_have_their_columns(tmp_path: Path) -> None:
    slider = {"name": "rail", "type": "slider", "between": ["disk"], "axis": [0.0, 1.0]}
    history = rigidfluid.run(dry_scene(joint=[slider]), tmp_path)
    results = load_results(tmp_path)
    assert "displacement" in results.joints
    np.testing.assert_array_equal(results.joints["displacement"], history.joints["displacement"])


def test_without_a_fluid_there_are_no_fields(tmp_path: Path) -> None:
    rigidfluid.run(dry_scene(), tmp_path)
    results = load_results(tmp_path)
    assert results.times.shape == (0,)
    with pytest.raises(OutputError, match="fields: found none; allowed is those of a run with a fluid"):
        results.fields()


def test_a_time_outside_the_outputs_is_refused(tmp_path: Path) -> None:
    simulation = Simulation(wet_scene(), tmp_path)
    simulation.go(until=0.02)
    simulation.close()
    results = load_results(tmp_path)
    assert results.fields(0.02 * (1 + 1e-12)).time == pytest.approx(0.02)
    for time in (-0.001, 0.021, math.inf, math.nan, "x"):
        with pytest.raises(OutputError, match=f"time of fields: found {time}; allowed is 0 to 0.02"):
            results.fields(time)


def test_a_name_that_no_table_or_column_has_is_refused(tmp_path: Path) -> None:
    history = rigidfluid.run(dry_scene())
    rigidfluid.run(dry_scene(), tmp_path)
    for results in (history, load_results(tmp_path)):
        with pytest.raises(ArgumentError, match="table: found 'body'; allowed is one of bodies, contacts, joints"):
            results.table("body")
        with pytest.raises(ArgumentError, match="bodies, column: found 'vz'; allowed is one of time, step, body, x"):
            results.table("bodies", ("vy", "vz"))


@pytest.mark.parametrize(
    "edited",
    [
        {"scene": 1},
        {"scene": {}},
        {"scene": {"scene": {"name": "dry", "dimension": "2"}}},
        {"scene": {"scene": {"name": "dry", "dimension": 4}}},
        {"energy": 1},
    ],
)
def test_an_edited_summary_is_refused(edited: Table, tmp_path: Path) -> None:
    rigidfluid.run(dry_scene(), tmp_path)
    path = tmp_path / "summary.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | edited))
    with pytest.raises(OutputError, match=r"summary\.json: found no tables `scene` and `energy` of a run"):
        load_results(tmp_path)


def test_a_table_of_joints_that_is_no_text_is_refused(tmp_path: Path) -> None:
    rigidfluid.run(dry_scene(), tmp_path)
    (tmp_path / "joints.csv").write_bytes(b"\xff\xfe")
    with pytest.raises(OutputError, match=r"joints\.csv: found 'utf-8' codec"):
        load_results(tmp_path)


def test_results_of_a_model_made_in_python_have_tables_and_no_scene(tmp_path: Path) -> None:
    rigidfluid.run(replace(model_of(dry_scene()), name="mine"), tmp_path)
    results = load_results(tmp_path)
    assert len(results.bodies["time"]) == 5
    with pytest.raises(OutputError, match="results of the model 'mine', made in Python"):
        _ = results.scene
    assert "scene: mine" in repr(results)


@pytest.mark.parametrize(("name", "found"), [("", "neither summary.json nor state.h5"), ("missing", "no folder")])
def test_a_folder_of_no_run_is_refused(name: str, found: str, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=f"found {found}; allowed is the folder of a run"):
        load_results(tmp_path / name)


def test_tables_are_frames_of_pandas(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    frame = rigidfluid.run(dry_scene(), tmp_path).frame("bodies")
    assert frame.groupby("body")["y"].last()["disk"] == pytest.approx(0.48)
    assert load_results(tmp_path).frame("energy").equals(rigidfluid.run(dry_scene()).frame("energy"))


def test_who_lacks_a_package_is_told_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    history, fields = rigidfluid.run(dry_scene()), Simulation(wet_scene()).fields()
    for name, extra, ask in (("pandas", "notebooks", lambda: history.frame("bodies")), ("pyvista", "vtk", fields.grid)):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(OutputError, match=rf"{name}: the package is not installed.*rigidfluid\[{extra}\]"):
            ask()
