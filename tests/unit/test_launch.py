"""What the command line does where several processes were started together."""

import gc

import pytest
from typer.testing import CliRunner

import rigidfluid.core.run.run
from rigidfluid.cli import app, console
from rigidfluid.core.run.process import Launch, no_collection
from rigidfluid.errors import OutputError, SharedInterrupt

OPEN_MPI = {"OMPI_COMM_WORLD_RANK": "1", "OMPI_COMM_WORLD_SIZE": "3"}


def command(monkeypatch, rank, *arguments):
    monkeypatch.setattr(console, "LAUNCH", Launch(rank, 2))
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "300"})


@pytest.mark.parametrize(
    ("environment", "rank", "size"),
    [
        ({}, 0, 1),
        (OPEN_MPI, 1, 3),
        ({"PMI_RANK": "2", "PMI_SIZE": "4"}, 2, 4),
        ({"SLURM_PROCID": "5", "SLURM_STEP_NUM_TASKS": "8", "SLURM_NTASKS": "8"}, 5, 8),
        ({"SLURM_PROCID": "0", "SLURM_NTASKS": "8"}, 0, 1),  # a batch script
        (
            {
                "OMPI_COMM_WORLD_RANK": "1",
                "OMPI_COMM_WORLD_SIZE": "2",
                "SLURM_PROCID": "0",
                "SLURM_STEP_NUM_TASKS": "1",
            },
            1,
            2,
        ),
    ],
)
def test_launchers_say_who_is_who(environment, rank, size):
    assert Launch.read(environment) == Launch(rank, size)


def test_what_loading_makes_is_not_searched_for_garbage():
    before = gc.get_freeze_count()
    with no_collection():
        assert not gc.isenabled()
        made = [[] for _ in range(1000)]
    assert gc.isenabled()
    assert gc.get_freeze_count() >= before + len(made)
    gc.unfreeze()


def test_a_backend_of_one_process_is_refused_before_anything_is_written(monkeypatch, tmp_path):
    result = command(monkeypatch, 0, "run", scene_file(tmp_path), "--out", tmp_path / "out")
    assert result.exit_code == console.BAD_INPUT
    for text in ("fluid.backend", "'dry'", "2 processes", "without mpirun"):
        assert text in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["check", "report", "study"])
def test_other_commands_are_of_one_process(monkeypatch, tmp_path, name):
    result = command(monkeypatch, 0, name, tmp_path)
    assert result.exit_code == console.BAD_INPUT
    assert f"rigidfluid {name}: found 2 processes" in result.stderr


@pytest.mark.parametrize("arguments", [["check", "x"], ["run", "no such file"], ["--version"]])
def test_the_first_process_speaks_for_all(monkeypatch, arguments):
    result = command(monkeypatch, 1, *arguments)
    assert (result.stdout, result.stderr) == ("", "")
    assert result.exit_code == (0 if arguments == ["--version"] else console.BAD_INPUT)


@pytest.mark.parametrize(
    ("failure", "ended", "text"),
    [
        (ZeroDivisionError("1/0"), True, "ZeroDivisionError: 1/0"),
        (KeyboardInterrupt(), True, ""),
        (SharedInterrupt(), False, ""),
        (OutputError("out", "nothing", "a folder", "Make one."), False, ""),
    ],
)
def test_what_one_process_meets_alone_ends_all_and_is_shown(monkeypatch, tmp_path, failure, ended, text):
    def fail(*_, **__):
        raise failure

    ends = []
    monkeypatch.setattr(Launch, "end", lambda launch: ends.append(launch))
    monkeypatch.setattr(rigidfluid.core.run.run, "simulate", fail)
    result = command(monkeypatch, 1, "run", scene_file(tmp_path))
    assert bool(ends) == ended
    assert text in result.stderr
    assert ("Traceback" in result.stderr) == bool(text)


def scene_file(folder):
    path = folder / "scene.toml"
    path.write_text(
        """
        [scene]
        name = "ball"
        dimension = 2
        [fluid]
        backend = "dry"
        [domain]
        lower = [0, 0]
        upper = [1, 1]
        [[body]]
        type = "sphere"
        radius = 0.1
        density = 1.0
        position = [0.5, 0.5]
        [time]
        end = 0.1
        step = 0.1
        [output]
        every = 0.1
        """
    )
    return path
