"""What validation tests have found is kept until they or the sources are others."""

from __future__ import annotations

from pathlib import Path

import pytest
from page_tools import kept_tests as module
from page_tools.kept_tests import MARK, files_of_tests, kept_tests
from paths import ROOT

TESTS = f"""
import pytest

@{MARK}
def test_that_passes():
    pass

@{MARK}
def test_that_fails():
    assert False

@{MARK}
def test_that_is_skipped():
    pytest.skip()

def test_of_no_validation():
    assert False
"""


def test_outcomes_are_told_and_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "pyproject.toml").write_text('[tool.pytest.ini_options]\nmarkers = ["validation"]\n')
    (path := tmp_path / "test_some.py").write_text(TESTS)
    found = kept_tests(path, tmp_path / "kept")
    assert (found.passed, found.failed, found.skipped) == (
        ["test_that_passes"], ["test_that_fails"], ["test_that_is_skipped"],
    )  # fmt: skip
    assert found.cpu_seconds > 0.0
    run: list[Path] = []
    monkeypatch.setattr(module, "_run", lambda path, told: run.append(path) or found)
    assert kept_tests(path, tmp_path / "kept") == found
    assert run == []
    path.write_text(TESTS + "# more\n")
    kept_tests(path, tmp_path / "kept")
    assert run == [path]
    kept_tests(path, tmp_path / "kept", fresh=True)
    assert run == [path, path]


def test_all_files_with_validation_tests_are_run() -> None:
    names = {str(path.relative_to(ROOT)) for path in files_of_tests()}
    assert {"tests/validation/test_dfg_cylinder.py", "tests/stability/test_extreme_contacts.py"} <= names
    assert "plugins/rigidfluid-lammps/tests/test_sphere_gas.py" in names
