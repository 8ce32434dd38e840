"""Ctrl-C and SIGTERM still reach Python after MMG has run."""

import contextlib
import signal
import subprocess
import sys
import time

import pytest
from falling import SCENES

import rigidfluid


@pytest.fixture(autouse=True)
def _ctrl_c_is_heard():
    """Programs in a shell's background ignore it, and so would these tests and what they start."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_is_reported_and_leaves_a_summary(tmp_path, number):
    """The handler that Python knows of may differ from the system's: only a real signal tells."""
    command = [sys.executable, "-m", "rigidfluid", "run", str(SCENES / "falling_disk.toml"), "--out", str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "state.h5").exists() and process.poll() is None:
        time.sleep(0.05)
    time.sleep(0.5)
    process.send_signal(number)
    _, complaint = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "--resume" in complaint
    assert "interrupted" in (tmp_path / "summary.json").read_text()


def test_ctrl_c_that_is_lost_in_a_step_ends_the_run_after_it() -> None:
    """Python ignores exceptions in finalisers and callbacks."""
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml")
    steps = []

    def lose(now) -> None:
        steps.append(now.time)
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        rigidfluid.run(scene, progress=lose)
    assert len(steps) == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
