"""The benchmark that counts instructions in two checkouts."""

from pathlib import Path

import pytest
from benchmark_scripts import benchmark

from rigidfluid.errors import OutputError


@pytest.fixture(scope="module")
def module():
    with benchmark("instructions") as found:
        yield found


def test_what_valgrind_tells_is_read(module):
    assert module.counted("==1== \n==1== I   refs:      12,016,511,401\n") == 12_016_511_401
    with pytest.raises(OutputError, match=r"no count in 'Killed'"):
        module.counted("Killed\n")


def test_a_step_is_the_difference_of_two_runs_of_the_same_checkout(module, monkeypatch):
    steps_of = {Path("other"): 3_000_000, module.ROOT: 6_000_000}
    monkeypatch.setattr(module, "instructions", lambda checkout, _, steps: 10**9 + steps * steps_of[checkout])
    row = module.compared(Path("other"), "falling_disk", 4, 20)
    assert (row.start_there, row.start_here) == (1012.0, 1024.0)
    assert (row.step_there, row.step_here, row.step_ratio) == (3.0, 6.0, 2.0)


def test_a_run_that_fails_is_told_by_its_scene(module, tmp_path):
    with pytest.raises(OutputError, match=r"none\.toml 4: "):
        module.instructions(tmp_path, "none", 4)
