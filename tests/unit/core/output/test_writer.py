"""What lands on disk: checkpoints to the last bit, tables that can be cut back, and a disk that refuses."""

import json
import sys
import tracemalloc
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from falling import falling_disk

import rigidfluid
from rigidfluid.core.mesh.adaptation.mesh_adaptation import MeshUpdater
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.output.history import History
from rigidfluid.core.output.tables import Table, read_rows
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import MeshError, OutputError

SHORT = {"time": {"step": 0.004, "end": 0.016}, "mesh": {"size": 0.3, "size_body": 0.05}, "output": {"every": 0.008}}


def one_ball():
    return dry_scene({}, ball([0.5, 0.5], [0.1, 0.0]), end=0.1, step=0.01)


@pytest.fixture
def scene():
    return falling_disk(**SHORT)


def same(left, right):
    """Equal to the last bit, through all records."""
    if is_dataclass(left):
        return all(same(getattr(left, field.name), getattr(right, field.name)) for field in fields(left))
    if isinstance(left, dict):
        return left.keys() == right.keys() and all(same(left[key], right[key]) for key in left)
    if isinstance(left, np.ndarray):
        return left.dtype == right.dtype and np.array_equal(left, right)
    return left == right


def test_a_checkpoint_comes_back_to_the_last_bit(scene, tmp_path):
    simulation = Simulation(scene, tmp_path, False)
    simulation.go()
    simulation.close()
    assert same(simulation.state, read_checkpoint(tmp_path / "state.h5").state)


def test_disk_and_memory_hold_the_same(scene, tmp_path):
    history, in_memory = rigidfluid.run(scene, tmp_path), rigidfluid.run(scene)
    assert json.loads((tmp_path / "summary.json").read_text()) == history.summary
    for name, rows in in_memory.records.items():
        assert history.records[name] == rows
        for column, values in in_memory.table(name).items():
            assert values.dtype == history.table(name)[column].dtype or len(values) == 0
            np.testing.assert_array_equal(values, history.table(name)[column])
    for figure in ("smallest_gap", "reynolds", "energy"):
        assert history.summary[figure] == in_memory.summary[figure]
    assert all(Path(file).exists() for file in history.summary["files"])


def test_numbers_and_names_survive_a_table(tmp_path):
    names = ("time", "step", "body")
    rows = [(0.1 + 0.2, 3, "disk"), (float("inf"), -1, "1e3")]
    table = Table(tmp_path / "t.csv", names, None)
    table.extend(rows)
    kept = table.written
    table.extend(rows)
    Table(tmp_path / "t.csv", names, kept)
    assert read_rows(tmp_path / "t.csv") == rows


def test_a_table_that_cannot_be_read_is_reported_by_file(tmp_path):
    history = rigidfluid.run(one_ball(), tmp_path)
    path = tmp_path / "bodies.csv"
    path.write_text(path.read_text().replace("\n0.0,", "\nzero,"))
    with pytest.raises(OutputError, match=r"bodies.csv: found a value that is no number in column time"):
        _ = history.bodies


def test_memory_does_not_grow_with_a_run_that_is_on_disk(tmp_path):
    """Fifty balls took 32 kB each step."""
    places = [[0.2 + 0.4 * (i % 10), 0.2 + 0.4 * (i // 10)] for i in range(50)]
    balls = [ball(place, [0.0, 0.0]) for place in places]
    simulation = Simulation(dry_scene({}, *balls, end=1.0, step=0.01, upper=[5.0, 3.0]), tmp_path, False)
    held = []
    tracemalloc.start()
    simulation.observe(lambda _: held.append(tracemalloc.get_traced_memory()[0]))
    simulation.go()
    tracemalloc.stop()
    simulation.close()
    assert held[-1] - held[20] < 80 * 1000


def test_a_resumed_run_knows_its_extremes(tmp_path):
    law = {"law": "centre", "range": 0.05, "epsilon": 1e-5, "epsilon_wall": 1e-5}
    bounce = {"gravity": [0.0, -10.0], "step": 0.01}
    thrown = ball([0.5, 0.3], [0.0, -2.0])
    whole = rigidfluid.run(dry_scene(law, thrown, end=0.4, **bounce)).summary
    for end in (0.2, 0.4):
        scene = dry_scene(law, thrown, end=end, **bounce).to_dict() | {"output": {"every": 0.1}}
        parts = rigidfluid.run(rigidfluid.scene_from_dict(scene), tmp_path, resume=end > 0.2).summary
    assert parts["smallest_gap"] == whole["smallest_gap"]


@pytest.mark.skipif(sys.platform == "win32", reason="files have no limit there")
@pytest.mark.parametrize(("most", "name"), [(300, "energy.csv"), (3000, "state.h5")])
def test_a_full_disk_is_reported_by_file_and_leaves_no_torn_summary(tmp_path, most, name):
    import resource

    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, limits[1]))
    try:
        with pytest.raises(OutputError, match=rf"{name}: found File too large"):
            rigidfluid.run(one_ball(), tmp_path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert not list(tmp_path.glob("summary.json*"))


def test_a_folder_that_cannot_be_made_is_reported(scene, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match=r"file/out: found Not a directory"):
        rigidfluid.run(scene, tmp_path / "file" / "out")


def test_a_bad_scene_leaves_earlier_output_untouched(scene, tmp_path):
    rigidfluid.run(scene, tmp_path)
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    with pytest.raises(rigidfluid.errors.RigidfluidError):
        rigidfluid.run(falling_disk(**SHORT, body={"position": [1.0, 0.1]}), tmp_path)
    assert before == {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}


def test_resuming_another_scene_is_refused(scene, tmp_path):
    rigidfluid.run(scene, tmp_path)
    with pytest.raises(OutputError, match="body"):
        rigidfluid.run(falling_disk(**SHORT, body={"density": 2.0}), tmp_path, resume=True)


def test_a_finished_run_can_be_taken_further(scene, tmp_path):
    rigidfluid.run(scene, tmp_path)
    longer = {**SHORT, "time": {"step": 0.004, "end": 0.028}}
    resumed = rigidfluid.run(falling_disk(**longer), tmp_path, resume=True)
    assert resumed.records == rigidfluid.run(falling_disk(**longer)).records


@pytest.mark.long
def test_a_run_that_gets_stuck_says_where_and_keeps_what_it_has(tmp_path):
    """A heavy disk whose floor is far too weak to stop it."""
    heavy = {**SHORT, "time": {"step": 0.004, "end": 0.1}, "body": {"density": 100.0, "position": [1.0, 0.3]}}
    with pytest.raises(rigidfluid.errors.StepError, match=r"body disk is .* from the nearest surface"):
        rigidfluid.run(falling_disk(**heavy), tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["status"].startswith("stopped")
    assert summary["smallest_gap"] > 0
    assert read_rows(tmp_path / "bodies.csv")[-1][0] == pytest.approx(summary["time"])


def test_a_body_that_leaves_through_an_opening_is_named_with_it():
    open_floor = {"boundary": [{"on": "bottom", "type": "pressure", "pressure": 0.0}]}
    heavy = {**SHORT, "time": {"step": 0.004, "end": 0.1}, "body": {"density": 100.0, "position": [1.0, 0.3]}}
    with pytest.raises(rigidfluid.errors.StepError, match=r"body disk is .* from 'bottom'.*make the domain longer"):
        rigidfluid.run(rigidfluid.scene_from_dict(falling_disk(**heavy).to_dict() | open_floor))


def test_a_failed_remesh_leaves_the_mesh_that_still_serves_and_is_counted(monkeypatch):
    """It is tried again once a nominal step, and not at each of the short ones at the start."""
    tried = []

    def fail(*given):
        tried.append(given)
        raise MeshError("mesh", "nothing", "a mesh", "None.")

    monkeypatch.setattr("rigidfluid.core.mesh.adaptation.mesh_adaptation.remesh", fail)
    monkeypatch.setattr(MeshUpdater, "is_worn", lambda *_: True)
    shown = []
    scene = falling_disk(**SHORT, body={"velocity": [0.0, -1.0]})
    summary = rigidfluid.run(scene, progress=lambda now: shown.append(now.failed_remeshes)).summary
    assert summary["status"] == "complete"
    assert 0 < summary["failed_remeshes"] == len(tried) <= 4
    assert summary["steps"] > 8
    assert sorted({0, *shown}) == list(range(len(tried) + 1))
    assert summary["latest_failed_remesh"] == "at time 0.012: mesh: found nothing; allowed is a mesh. None."


def test_why_a_remesh_failed_is_still_known_after_a_resumption(monkeypatch, tmp_path):
    def fail(*_):
        raise MeshError("mesh", "nothing", "a mesh", "None.")

    monkeypatch.setattr("rigidfluid.core.mesh.adaptation.mesh_adaptation.remesh", fail)
    monkeypatch.setattr(MeshUpdater, "is_worn", lambda *_: True)
    told = rigidfluid.run(falling_disk(**SHORT), tmp_path).summary["latest_failed_remesh"]
    monkeypatch.setattr(MeshUpdater, "is_worn", lambda *_: False)
    longer = {**SHORT, "time": {"step": 0.004, "end": 0.028}}
    resumed = rigidfluid.run(falling_disk(**longer), tmp_path, resume=True).summary
    assert resumed["latest_failed_remesh"] == told is not None


def test_a_body_without_any_wall_has_no_gap(tmp_path):
    data = falling_disk(**SHORT).to_dict() | {"boundary": [{"on": "all", "type": "slip"}]}
    rigidfluid.run(rigidfluid.scene_from_dict(data), tmp_path)
    assert json.loads((tmp_path / "summary.json").read_text())["smallest_gap"] is None


def test_a_table_that_has_lost_rows_is_refused(scene, tmp_path):
    rigidfluid.run(scene, tmp_path)
    whole = (tmp_path / "bodies.csv").read_bytes()
    (tmp_path / "bodies.csv").write_bytes(whole[:300])
    with pytest.raises(OutputError, match=r"bodies.csv: found 300 bytes"):
        rigidfluid.run(scene, tmp_path, resume=True)
    assert (tmp_path / "bodies.csv").read_bytes() == whole[:300]


def test_a_scene_whose_first_step_fails_leaves_earlier_output_untouched(scene, tmp_path):
    rigidfluid.run(scene, tmp_path)
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    with pytest.raises(rigidfluid.errors.StepError):
        rigidfluid.run(falling_disk(**SHORT, body={"velocity": [1e7, 0.0]}), tmp_path)
    assert before == {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}


def test_running_again_gives_the_same(scene, tmp_path):
    first = rigidfluid.run(scene, tmp_path).records
    assert rigidfluid.run(scene, tmp_path).records == first


def test_a_table_of_an_earlier_version_has_the_columns_that_it_knew(tmp_path):
    (tmp_path / "energy.csv").write_text("time,step,kinetic\n0.0,0,1.5\n")
    energy = History(2, folder=tmp_path).energy
    assert list(energy) == ["time", "step", "kinetic"]
    assert energy["kinetic"].tolist() == [1.5]
