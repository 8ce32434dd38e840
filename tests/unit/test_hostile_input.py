"""Input and streams that no one would use on purpose end in one paragraph, and in no traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from dry_scenes import ball, dry_scene
from falling import SCENES

import rigidfluid
from rigidfluid.errors import SceneError
from rigidfluid.post.reports import report

SCENE = SCENES / "dry_bounce.toml"
COMMAND = (sys.executable, "-m", "rigidfluid")
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="neither devices nor these signals are there")


def refused(*arguments: str) -> str:
    """What a command that is refused says."""
    done = subprocess.run([*COMMAND, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    return done.stderr


@pytest.mark.parametrize("field", ["scene.seed", "domain.file"])
def test_a_number_of_very_many_digits(field: str) -> None:
    with pytest.raises(SceneError, match=rf"{field}: found a number of 320 digits"):
        rigidfluid.load_scene(SCENE, [f"{field}={'1' * 320}"])


def test_a_shortest_step_that_clocks_cannot_tell(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"time.shortest: found 1e-29; allowed is at least"):
        rigidfluid.run(rigidfluid.load_scene(SCENE, ["time.shortest=1e-29"]), tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_folder_s_name_that_is_too_long(tmp_path: Path) -> None:
    assert "File name too long" in refused("run", str(SCENE), "--out", str(tmp_path / ("a" * 300)))


@pytest.mark.parametrize("command", ["report", "movie", "new"])
def test_a_name_that_is_too_long(tmp_path: Path, command: str) -> None:
    assert "File name too long" in refused(command, str(tmp_path / ("a" * 300)))


def test_a_summary_of_brackets(tmp_path: Path) -> None:
    rigidfluid.run(dry_scene({}, ball([0.5, 0.5], [0.1, 0.0]), end=0.02, step=0.01), tmp_path)
    (tmp_path / "summary.json").write_text("[" * 100_000)
    with pytest.raises(rigidfluid.errors.OutputError, match=r"summary.json: found no JSON"):
        report(tmp_path)


@POSIX
def test_an_output_that_is_full(tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        command = [*COMMAND, "run", str(SCENE), "--set", "time.end=0.01", "--out", str(tmp_path / "out")]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert "standard output: found No space left on device" in done.stderr
    assert "Traceback" not in done.stderr
    assert (tmp_path / "out" / "summary.json").exists()


@POSIX
@pytest.mark.parametrize("command", [[], ["--help"], ["run", "--help"], ["--version"], ["plugins"], ["examples"]])
def test_an_output_of_words_alone_that_is_full(command: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([*COMMAND, *command], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("Error: standard output: found No space left on device")
    assert "Traceback" not in done.stderr


@POSIX
def test_an_output_that_nobody_reads() -> None:
    process = subprocess.Popen([*COMMAND, "schema"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == ""
    assert process.wait() == 1
    process.stderr.close()


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252"])
def test_an_output_that_lacks_characters(encoding: str) -> None:
    environment = os.environ | {"PYTHONIOENCODING": encoding}
    done = subprocess.run([*COMMAND, "schema"], capture_output=True, env=environment, check=False)
    assert done.returncode == 0
    assert not done.stderr
    assert "\\u" in done.stdout.decode(encoding)


@POSIX
@pytest.mark.parametrize("number", ["SIGTERM", "SIGHUP"])
def test_the_end_of_a_queue_or_a_terminal_leaves_a_summary(tmp_path: Path, number: str) -> None:
    if signal.getsignal(getattr(signal, number)) is signal.SIG_IGN:
        pytest.skip("nohup, under which this runs, has it ignored, and so would a run")
    command = [*COMMAND, "run", str(SCENE), "--set", "time.end=1e4", "--out", str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    saved: set[int] = set()
    while process.poll() is None and len(saved) < 2:  # the first is that of the start, before a run hears signals
        saved |= {state.stat().st_mtime_ns for state in tmp_path.glob("state.h5")}
        time.sleep(0.02)
    process.send_signal(getattr(signal, number))
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130, said
    assert "Interrupted." in said
    assert '"status": "interrupted"' in (tmp_path / "summary.json").read_text()


@POSIX
def test_ctrl_c_while_the_command_line_is_loaded(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("import signal\nsignal.raise_signal(signal.SIGINT)\n")
    path = os.pathsep.join([str(tmp_path), *filter(None, sys.path)])
    done = subprocess.run(
        [*COMMAND], env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (-signal.SIGINT, "")
