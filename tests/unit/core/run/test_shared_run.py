"""A run that ranks share is that of one process, on all of them; and what goes wrong on one goes wrong on all."""

import errno
import json
import os
from dataclasses import replace
from functools import cache
from threading import BrokenBarrierError

import gathered_backend
import numpy as np
import pytest
from falling import falling_disk
from gathered_backend import Gathered, install_gathered
from threaded_ranks import on_ranks

import rigidfluid
from rigidfluid.core.mesh.adaptation import mesh_adaptation
from rigidfluid.core.model.ranks import ALONE
from rigidfluid.core.output import vtu
from rigidfluid.core.output.checkpoint import read_checkpoint, stage_checkpoint
from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.core.output.writer import earlier_run
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import MeshError, OutputError, SceneError, SharedInterrupt, StepRejected
from rigidfluid.post.reports import report

FALL = {
    "time": {"step": 0.004, "end": 0.056},
    "mesh": {"size": 0.3, "size_body": 0.05},
    "output": {"every": 0.02, "probes": [[1.0, 0.4]]},
    "body": {"position": [1.0, 0.24], "velocity": [0.0, -2.0]},
    "fluid": {"tolerance": 1e-12},
}
"""A disk that nears the floor; its mesh is regenerated on the way."""
GATHERED = FALL["fluid"] | {"backend": "gathered"}


@pytest.fixture(autouse=True)
def plugin(tmp_path_factory, monkeypatch):
    folder = tmp_path_factory.mktemp("plugin")
    install_gathered(folder)
    monkeypatch.syspath_prepend(str(folder))


def fall(end=FALL["time"]["end"], **tables):
    return falling_disk(**FALL | {"time": FALL["time"] | {"end": end}} | tables)


def shared(count, out=None, resume=False, **tables):
    """The histories of all ranks."""
    scene = fall(fluid=GATHERED, **tables)

    def work(ranks):
        gathered_backend.CURRENT.ranks = ranks
        return rigidfluid.run(scene, out, resume=resume)

    return on_ranks(count, work)


@cache
def uninterrupted(count):
    """The histories of all ranks of a run from start to end."""
    return shared(count)


def refused_by_all(count, match, out=None, resume=False, error=OutputError, **tables):
    """Every rank raises the same error, and none waits."""
    scene = fall(fluid=GATHERED, **tables)

    def work(ranks):
        gathered_backend.CURRENT.ranks = ranks
        with pytest.raises(error, match=match):
            rigidfluid.run(scene, out, resume=resume)

    on_ranks(count, work)


def assert_same_tables(one, other):
    assert one.records.keys() == other.records.keys()
    for table in one.records:
        for name, column in other.table(table).items():
            np.testing.assert_array_equal(one.table(table)[name], column, err_msg=f"{table}: {name}")


def assert_nearly_same_tables(one, other):
    """But for sums of another order."""
    for table in ("bodies", "probes", "energy"):
        for name, column in other.table(table).items():
            if column.dtype.kind == "f":
                np.testing.assert_allclose(one.table(table)[name], column, rtol=1e-9, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("detector", ["sphere", pytest.param("narrow_band", marks=pytest.mark.long)])
def test_the_run_is_that_of_one_process(detector):
    """But for the impulse responses of bodies, by factors of single precision."""
    serial = rigidfluid.run(fall(contact={"detector": detector}))
    assert serial.summary["remeshes"] > 0
    for count in (1, 3):
        histories = shared(count, contact={"detector": detector})
        for history in histories:
            assert_same_tables(history, histories[0])
            assert history.summary["ranks"] == count
            for figure in ("cells", "unknowns", "steps", "remeshes", "rejected_steps"):
                assert history.summary[figure] == serial.summary[figure]
            assert_nearly_same_tables(history, serial)


def test_steps_by_a_tolerance_are_those_of_one_process():
    time = {"step": 0.008, "end": 0.056, "tolerance": 1e-2}
    serial = rigidfluid.run(fall(time=time))
    assert len(set(serial.steps["size"])) > 2
    for history in shared(2, time=time):
        np.testing.assert_array_equal(history.steps["size"], serial.steps["size"])
        np.testing.assert_allclose(history.steps["error"], serial.steps["error"], rtol=1e-6)


@pytest.mark.long
def test_a_resumed_run_is_the_uninterrupted_one_to_the_last_bit(tmp_path):
    expected = uninterrupted(2)
    shared(2, tmp_path, end=0.02)
    for history, wanted in zip(shared(2, tmp_path, resume=True), expected, strict=True):
        assert_same_tables(history, wanted)


def test_each_rank_keeps_its_part_and_the_root_what_is_there_once(tmp_path):
    histories = shared(2, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        *(
            "bodies.csv",
            "contacts.csv",
            "joints.csv",
            "energy.csv",
            "steps.csv",
            "probes.csv",
            "driving.csv",
            "stresslets.csv",
            "walls.csv",
            "statistics.csv",
            "exchanges.csv",
            "mesh_error.csv",
            "sensitivities.csv",
            "error_estimates.csv",
            "scalar.csv",
            "scalar_fluxes.csv",
        ),
        *("state.h5", "state.1.h5", "fields.pvd", "fields", "summary.json", "run.lock"),
    }
    assert histories[0].summary["files"] == histories[1].summary["files"]
    assert str(tmp_path / "state.1.h5") in histories[1].summary["files"]
    first, second = (read_checkpoint(tmp_path / name).state for name in ("state.h5", "state.1.h5"))
    assert len(first.mesh.cells) + len(second.mesh.cells) == histories[0].summary["cells"]
    assert np.array_equal(np.union1d(first.mesh.part.cells, second.mesh.part.cells), range(first.mesh.part.counts[1]))


@pytest.mark.long
def test_pieces_make_the_fields_of_the_whole(tmp_path):
    rigidfluid.run(fall(), tmp_path / "one")
    shared(3, tmp_path / "three")
    series = zip(read_pvd(tmp_path / "one" / "fields.pvd"), read_pvd(tmp_path / "three" / "fields.pvd"), strict=True)
    for (time, path), (shared_time, shared_path) in series:
        one, three = read_vtu(path), read_vtu(shared_path)
        assert (time, shared_path.suffix) == (shared_time, ".pvtu")
        assert len(one.points) == len(three.points)
        order, shared_order = np.lexsort(one.points.round(9).T), np.lexsort(three.points.round(9).T)
        np.testing.assert_allclose(three.points[shared_order], one.points[order], atol=1e-12)
        np.testing.assert_allclose(three.velocity[shared_order], one.velocity[order], atol=1e-5)
        np.testing.assert_allclose(three.pressure[shared_order], one.pressure[order], rtol=1e-4, atol=1e-3)
        corners = [np.sort(f.points[f.cells].sum(axis=1)[:, 0]) for f in (one, three)]
        np.testing.assert_allclose(*corners, atol=1e-10)


def test_other_programs_find_the_pieces(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    histories = shared(2, tmp_path, end=0.02)
    read = pyvista.read(tmp_path / "fields" / "000001.pvtu")
    assert read.n_cells == histories[0].summary["cells"]
    assert {"velocity", "pressure", "vorticity"} <= set(read.point_data.keys())
    points = {path.name for path in (tmp_path / "fields").iterdir() if "s.vtu" in path.name}
    assert points == {f"00000{number}.{name}.vtu" for number in (0, 1) for name in ("bodies", "contacts")}


@pytest.mark.long
def test_a_report_is_made_of_a_shared_run(tmp_path, monkeypatch):
    shared(2, tmp_path)
    monkeypatch.setattr(gathered_backend.CURRENT, "ranks", ALONE, raising=False)
    assert all(path.exists() for path in report(tmp_path))


@pytest.mark.long
@pytest.mark.parametrize(("before", "after"), [(1, 2), (2, 1), (2, 3), (3, 2)])
def test_another_number_of_ranks_goes_on_as_those_before(tmp_path, before, after):
    """A new mesh is made before the checkpoint, and after it."""
    expected, *_ = uninterrupted(before)
    shared(before, tmp_path, end=0.04)
    assert 0 < json.loads((tmp_path / "summary.json").read_text())["remeshes"] < expected.summary["remeshes"]
    for history in shared(after, tmp_path, resume=True):
        assert history.summary["ranks"] == after
        assert history.summary["remeshes"] == expected.summary["remeshes"]
        assert_nearly_same_tables(history, expected)
    checkpoints = {path.name for path in tmp_path.glob("state*")}
    assert checkpoints == {"state.h5", *(f"state.{rank}.h5" for rank in range(1, after))}
    for _, path in read_pvd(tmp_path / "fields.pvd"):
        assert len(read_vtu(path).cells) > 0


def test_a_backend_that_cannot_cut_its_state_is_resumed_by_as_many_ranks(tmp_path, monkeypatch):
    monkeypatch.setattr(Gathered, "state_format", None)
    shared(2, tmp_path, end=0.008)
    for count in (1, 3):
        refused_by_all(count, rf"found a run of 2 processes; allowed is a run of {count}", tmp_path, resume=True)


@pytest.mark.long
def test_a_kill_between_checkpoints_of_fewer_ranks_than_before_loses_nothing(tmp_path):
    expected, *_ = uninterrupted(2)
    shared(3, tmp_path, end=0.02)
    names = ("state.h5", "state.1.h5", "state.2.h5")
    before = [(tmp_path / name).read_bytes() for name in names]
    shared(2, tmp_path, resume=True, end=0.04)
    (tmp_path / "state.h5").rename(tmp_path / "state.h5.part")
    for name in ("state.h5", "state.2.h5"):
        (tmp_path / name).write_bytes(before[names.index(name)])
    for history in shared(2, tmp_path, resume=True):
        assert_nearly_same_tables(history, expected)


def test_checkpoints_of_different_times_are_refused(tmp_path):
    shared(2, tmp_path, end=0.008)
    kept = (tmp_path / "state.1.h5").read_bytes()
    shared(2, tmp_path, resume=True, end=0.016)
    (tmp_path / "state.1.h5").write_bytes(kept)
    refused_by_all(2, "found checkpoints of different times", tmp_path, resume=True)


def test_a_kill_between_the_replacements_of_two_checkpoints_loses_nothing(tmp_path):
    expected = uninterrupted(2)
    shared(2, tmp_path, end=0.02)
    own, staged = tmp_path / "state.1.h5", tmp_path / "state.1.h5.part"
    before = own.read_bytes()
    shared(2, tmp_path, resume=True, end=0.04)
    after = own.read_bytes()
    own.rename(staged)
    own.write_bytes(before)
    on_ranks(2, lambda ranks: earlier_run(tmp_path, ranks))
    assert (own.read_bytes(), staged.exists()) == (after, False)
    for history, wanted in zip(shared(2, tmp_path, resume=True), expected, strict=True):
        assert_same_tables(history, wanted)


def test_what_another_time_left_staged_is_not_taken(tmp_path):
    shared(2, tmp_path, end=0.008)
    before = (tmp_path / "state.1.h5").read_bytes()
    shared(2, tmp_path, resume=True, end=0.016)
    for name in ("state.1.h5", "state.1.h5.part"):
        (tmp_path / name).write_bytes(before)
    refused_by_all(2, "found checkpoints of different times, 2048 and 4096", tmp_path, resume=True)
    assert (tmp_path / "state.1.h5").read_bytes() == before


def test_a_missing_part_is_named(tmp_path):
    shared(2, tmp_path, end=0.008)
    (tmp_path / "state.1.h5").unlink()
    refused_by_all(2, r"state.1.h5: found no such file", tmp_path, resume=True)


def test_a_new_run_clears_the_parts_of_more_ranks(tmp_path):
    shared(3, tmp_path, end=0.008)
    (tmp_path / "state.1.h5.part").touch()
    rigidfluid.run(fall(0.008), tmp_path)
    assert [path.name for path in tmp_path.glob("state*")] == ["state.h5"]
    assert {path.suffix for path in (tmp_path / "fields").iterdir()} == {".vtu"}
    assert len(list((tmp_path / "fields").iterdir())) == 6


def test_a_rank_s_full_disk_is_everyone_s_and_leaves_the_checkpoint_before(tmp_path, monkeypatch):
    shared(2, tmp_path, end=0.008)
    before = [(tmp_path / name).read_bytes() for name in ("state.h5", "state.1.h5")]

    def stage(path, checkpoint):
        if path.name == "state.1.h5":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        stage_checkpoint(path, checkpoint)

    monkeypatch.setattr("rigidfluid.core.output.writer.stage_checkpoint", stage)
    refused_by_all(2, r"state.1.h5: found No space left", tmp_path, resume=True)
    assert before == [(tmp_path / name).read_bytes() for name in ("state.h5", "state.1.h5")]


def test_no_mesh_for_the_root_is_none_for_all(monkeypatch):
    def fail(*_):
        raise MeshError("mesh", "nothing", "a mesh", "Try again.")

    monkeypatch.setattr(mesh_adaptation, "initial_mesh", fail)
    refused_by_all(2, "mesh: found nothing", error=MeshError)


def test_the_present_mesh_serves_all_where_none_can_be_made(monkeypatch):
    tries = []

    def fail(*_):
        tries.append(1)
        raise MeshError("mesh", "nothing", "a mesh", "Try again.")

    monkeypatch.setattr(mesh_adaptation, "remesh", fail)
    assert [history.summary["remeshes"] for history in shared(2)] == [0, 0]
    assert tries


def test_a_step_that_one_rank_rejects_is_tried_shorter_by_all(monkeypatch):
    advance, rejected = Gathered.advance, []

    def picky(backend, fluid, mesh, step):
        made = advance(backend, fluid, mesh, step)
        if backend.ranks.rank == 1 and not rejected:
            rejected.append(step.time)
            raise StepRejected("fluid", "a whim", "none", "Try again.")
        return made

    monkeypatch.setattr(Gathered, "advance", picky)
    histories = shared(2, end=0.02)
    assert [history.summary["rejected_steps"] for history in histories] == [1, 1]
    assert_same_tables(*histories)


def test_a_tangled_cell_of_one_rank_is_everyone_s(monkeypatch):
    quality, bad = mesh_adaptation.cell_quality, []

    def tangled(points, cells):
        worst = 0.0 if not bad else 1.0  # of the rank that comes first
        bad.append(True)
        return worst * quality(points, cells)

    scene = fall(0.02, fluid=GATHERED)

    def work(ranks):
        gathered_backend.CURRENT.ranks = ranks
        simulation = Simulation(scene, None, False)
        if ranks.rank == 1:
            monkeypatch.setattr(mesh_adaptation, "cell_quality", tangled)
        ranks.allgather(None)
        with pytest.raises(StepRejected, match=r"a cell of quality 0\.000"):
            simulation.mesh_updater.deform(simulation.state, simulation.state.pose)

    on_ranks(2, work)


def test_an_interrupt_of_one_rank_waits_for_nobody(tmp_path):
    scene = fall(0.02, fluid=GATHERED)

    def work(ranks):
        def interrupt(progress):
            if ranks.rank == 1:
                raise KeyboardInterrupt

        gathered_backend.CURRENT.ranks = ranks
        rigidfluid.run(scene, tmp_path, progress=interrupt)

    with pytest.raises(KeyboardInterrupt):
        on_ranks(2, work)
    assert not (tmp_path / "summary.json").exists()
    assert len(shared(2, tmp_path, resume=True, end=0.02)) == 2


@pytest.mark.parametrize("moment", ["in a step", "after it"])
def test_ctrl_c_on_one_rank_ends_all_with_a_summary(tmp_path, monkeypatch, moment):
    scene = fall(0.02, fluid=GATHERED)
    advance = Gathered.advance

    def press(ranks):
        if ranks.rank == 1:
            ranks.interrupt()

    def pressed(backend, *arguments):
        press(backend.ranks)
        return advance(backend, *arguments)

    def work(ranks):
        gathered_backend.CURRENT.ranks = ranks
        after = press if moment == "after it" else lambda ranks: None
        with pytest.raises(SharedInterrupt):
            rigidfluid.run(scene, tmp_path, progress=lambda _: after(ranks))

    if moment == "in a step":
        monkeypatch.setattr(Gathered, "advance", pressed)
    on_ranks(2, work)
    assert json.loads((tmp_path / "summary.json").read_text())["status"] == "interrupted"


def test_a_backend_of_one_process_is_not_started_by_two(tmp_path):
    with pytest.raises(SceneError, match=r"fluid.backend: found 'scikit-fem', which runs in 1, and 2 processes"):
        rigidfluid.run(fall(), tmp_path / "out", processes=2)
    assert not (tmp_path / "out").exists()
    assert rigidfluid.run(fall(0.004), processes=1).summary["status"] == "complete"


def test_nodes_that_pieces_share_are_one(tmp_path):
    corners = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1]])

    def piece(cell):
        corner = corners[cell]
        points = np.concatenate([corner, 0.5 * (corner + np.roll(corner, -1, axis=0))])
        return vtu.Fields(points, np.arange(6)[None], points, points[:, 0])

    first, second = piece([0, 1, 2]), piece([1, 3, 2])
    second = replace(second, points=second.points * (1 + 1e-15))
    vtu.write_vtu(tmp_path / "a.0.vtu", first)
    vtu.write_vtu(tmp_path / "a.1.vtu", second)
    vtu.write_pvtu(tmp_path / "a.pvtu", ["a.0.vtu", "a.1.vtu"], first)
    read = read_vtu(tmp_path / "a.pvtu")
    assert len(read.points) == 9
    np.testing.assert_allclose(read.points[read.cells[1]], second.points, atol=1e-14)
    np.testing.assert_allclose(read.velocity, read.points, atol=1e-6)
    (tmp_path / "a.1.vtu").unlink()
    with pytest.raises(OutputError, match=r"a.1.vtu"):
        read_vtu(tmp_path / "a.pvtu")


def test_a_rank_that_leaves_ends_the_others():
    def work(ranks):
        if ranks.rank == 0:
            ranks.abort()
        ranks.allgather(None)

    with pytest.raises(BrokenBarrierError):
        on_ranks(2, work)
