"""What memory is left, and that a run says so where it is too little."""

from __future__ import annotations

import importlib.util
import resource
from pathlib import Path

import numpy as np
import pytest
from falling import falling_disk
from scipy import sparse

from rigidfluid.core.model import memory
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import StepError, StepRejected
from rigidfluid.taylor_hood.linear_solver import pardiso
from rigidfluid.taylor_hood.linear_solver.factorization import factorise

SHORT = {"time": {"step": 0.004, "end": 0.016}, "mesh": {"size": 0.5, "size_body": 0.1}, "output": {"every": 1.0}}
MATRIX = sparse.csr_array(sparse.random_array((400, 400), density=0.02, rng=0) + 10.0 * sparse.eye_array(400))

with_pardiso = pytest.mark.skipif(importlib.util.find_spec("pypardiso") is None, reason="MKL is not installed")


@pytest.fixture
def system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A system with 3 MB available, in a group that may have 2 MB, uses 1.5 and has 0.25 of them in files."""
    group = tmp_path / "a" / "b"
    group.mkdir(parents=True)
    for path, text in (
        (tmp_path / "meminfo", "MemTotal:  9000 kB\nMemAvailable:  3000 kB\n"),
        (tmp_path / "cgroup", "1:name=x:/\n0::/a/b\n"),
        (group / "memory.max", "2000000\n"),
        (group / "memory.current", "1500000\n"),
        (group / "memory.stat", "anon 3\ninactive_file 250000\n"),
    ):
        path.write_text(text)
    for name, path in (("_SYSTEM", "meminfo"), ("_GROUP", "cgroup"), ("_GROUPS", ".")):
        monkeypatch.setattr(memory, name, tmp_path / path)
    return group


def test_the_group_leaves_less_than_the_system_has(system: Path) -> None:
    assert memory.available_memory() == 750_000
    (system / "memory.max").write_text("max\n")
    assert memory.available_memory() == 3000 * 1024


def test_a_limit_of_addresses_counts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "status").write_text("VmPeak: 7 kB\nVmSize:\t 1000 kB\n")
    monkeypatch.setattr(memory, "_PROCESS", tmp_path / "status")
    monkeypatch.setattr(resource, "getrlimit", lambda _: (1_500_000, -1))
    assert memory.available_memory() == 1_500_000 - 1_024_000


def test_nothing_is_refused_where_no_system_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("_SYSTEM", "_GROUP", "_GROUPS", "_PROCESS"):
        monkeypatch.setattr(memory, name, Path("/no/such/file"))
    assert memory.available_memory() == np.inf
    memory.require_memory(1e30, "all")


@with_pardiso
@pytest.mark.parametrize(("available", "phases"), [(0.0, []), (300e3, [11])])
def test_factors_that_do_not_fit_are_refused_before_they_are_made(
    available: float, phases: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    made, run = [], pardiso.Pardiso._run

    def recorded(self: pardiso.Pardiso, phase: int, *sides: object) -> None:
        made.append(phase)
        run(self, phase, *sides)

    monkeypatch.setattr(pardiso.Pardiso, "_run", recorded)
    monkeypatch.setattr(memory, "available_memory", lambda: available)
    with pytest.raises(StepError, match=r"factors of 400 unknowns that need .* GiB; .*schur") as refused:
        factorise(MATRIX)
    assert not isinstance(refused.value, StepRejected)
    assert made == phases


@with_pardiso
def test_pardiso_that_is_out_of_memory_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pardiso, "_call", lambda *_: -2)
    with pytest.raises(MemoryError, match="factors of 400 unknowns"):
        factorise(MATRIX)


def test_a_run_out_of_memory_names_what_is_available(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = Simulation(falling_disk(**SHORT))
    monkeypatch.setattr(simulation.stepper, "after", lambda _: np.empty(2**50))
    with pytest.raises(StepError, match=r"too little of it \(Unable to allocate 8.00 PiB"):
        simulation.step()
