"""One run in a process of its own, so that memory, threads and a crash stay with its backend."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from rigidfluid.core.output.disk import open_new, writing
from rigidfluid.python_process import environment, failure, python

_POLL = 1.0
"""Seconds between two looks at the process."""
_GRACE = 5.0
"""Seconds that it has to end by itself after Ctrl-C, which reaches it too; a signal to us alone does not."""


def run_apart(scene: Path, folder: Path, log: Path, *, resume: bool, watch: Callable[[], None]) -> str:
    """Run ``rigidfluid run`` and wait for its end; return why it failed, or "".

    ``watch`` is called about once a second; the output goes to ``log``; ``resume`` from the checkpoint in ``folder``.
    Raises OutputError if the log cannot be written.
    """
    command = python("-m", "rigidfluid", "run", str(scene), "--out", str(folder))
    with writing(log), open_new(log) as output:
        process = subprocess.Popen(
            [*command, "--resume"] if resume else command,
            env=environment(),
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
        )
        try:
            _await(process, watch)
        except KeyboardInterrupt:
            with suppress(subprocess.TimeoutExpired):
                process.wait(_GRACE)
            raise
        finally:
            process.kill()
            process.wait()
    return "" if process.returncode == 0 else _failure(process.returncode, log)


def _await(process: subprocess.Popen[bytes], watch: Callable[[], None]) -> None:
    while True:
        try:
            process.wait(_POLL)
        except subprocess.TimeoutExpired:
            watch()
        else:
            return


def _failure(code: int, log: Path) -> str:
    """The signal that ended it, or the error that it printed last."""
    last = failure(code, log.read_text(encoding="utf-8", errors="replace"))
    if code < 0 or last.startswith("Error: "):
        return last.removeprefix("Error: ")
    return f"{last} (more in {log.name})"
