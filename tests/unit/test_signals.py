"""Ctrl-C still reaches Python after MMG has run."""

import signal
import subprocess
import sys
import time

from falling import SCENES


def test_ctrl_c_is_reported_and_leaves_a_summary(tmp_path):
    """The handler that Python knows of may differ from the system's: only a real signal tells."""
    command = [sys.executable, "-m", "rigidfluid", "run", str(SCENES / "falling_disk.toml"), "--out", str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "state.h5").exists() and process.poll() is None:
        time.sleep(0.05)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, complaint = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "--resume" in complaint
    assert "interrupted" in (tmp_path / "summary.json").read_text()
