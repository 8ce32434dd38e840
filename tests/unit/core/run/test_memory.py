"""The memory that a process has taken at most."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import pytest

from rigidfluid.core.run import process

MEBIBYTE = 2**20


def test_memory_once_taken_counts() -> None:
    ballast = b"x" * (200 * MEBIBYTE)
    taken = process.peak_memory()
    assert taken is not None
    assert len(ballast) < taken < 100 * len(ballast)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux counts what the parent holds")
def test_the_parents_memory_does_not_count() -> None:
    ballast = b"x" * (300 * MEBIBYTE)
    code = "from rigidfluid.core.run.process import peak_memory; print(peak_memory())"
    taken = int(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
    assert taken < len(ballast)


@pytest.mark.parametrize(("platform", "unit"), [("linux", 1024), ("darwin", 1)])
def test_units(platform: str, unit: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "_STATUS", Path("/no/such/file"))
    monkeypatch.setattr(sys, "platform", platform)
    assert process.peak_memory() == resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def test_nothing_is_said_where_the_system_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "win32")
    assert process.peak_memory() is None
