"""Python processes that this one starts: from the same modules, and with what they said last."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)  # fmt: skip
"""Variables of processes that use one thread each."""


def python(*arguments: str) -> list[str]:
    """The command that runs this interpreter.

    With -P modules come from where they came from here, and not from the working directory.
    """
    return [sys.executable, "-P", *arguments]


def environment() -> dict[str, str]:
    """This process' variables, its modules, and plain text."""
    paths = [path or str(Path.cwd()) for path in sys.path]
    return os.environ | {"PYTHONPATH": os.pathsep.join(paths), "PYTHONIOENCODING": "utf-8", "TERM": "dumb"}


def failure(code: int, said: str) -> str:
    """Why a process ended with ``code``: the signal, or the last line that it ``said``."""
    if code < 0:
        return f"ended by a signal: {signal.strsignal(-code)}"
    return next((line for line in reversed(said.split("\n")) if line.strip()), f"exit code {code}")
