"""The list of mutations fits the sources, and the command sees what tests see."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from paths import ROOT


@pytest.fixture(scope="module")
def mutants() -> ModuleType:
    spec = spec_from_file_location("mutants", ROOT / "tools" / "mutants.py")
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules["mutants"] = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_text_of_the_list_is_in_its_file_once_and_leaves_code(mutants: ModuleType) -> None:
    seen = set()
    for one in mutants.mutations():
        source = (ROOT / mutants.SOURCES / one.file).read_text(encoding="utf-8")
        mutated = one.applied(source)
        assert mutated != source
        compile(mutated, one.file, "exec")
        seen.add((one.file, one.text, one.becomes))
    assert len(seen) == len(mutants.mutations()) >= 150


def test_every_test_of_the_list_is_there(mutants: ModuleType) -> None:
    for test in {test for one in mutants.mutations() for test in one.tests}:
        file, _, name = test.partition("::")
        text = (ROOT / "tests" / file).read_text(encoding="utf-8")
        assert all(f"class {part}" in text for part in name.split("::")[:-1])
        if "::test_" in test and "contract" not in file:
            assert f"def {name.split('[')[0]}(" in text, test


def test_a_text_that_is_not_there_once_is_told_by_name(mutants: ModuleType) -> None:
    one = mutants.Mutation("core/file.py", "a + b", "a - b", ())
    assert one.applied("return a + b") == "return a - b"
    for source in ("return a", "return a + b + a + b"):
        with pytest.raises(mutants.MutationError, match=r"core/file.py: 'a \+ b' is there [02] times"):
            one.applied(source)


@pytest.fixture
def project(mutants: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of one function, and two files of tests, one of which does not ask it."""
    root = tmp_path / "project"
    for name in ("src/rigidfluid", "tests"):
        (root / name).mkdir(parents=True)
    (root / "src" / "rigidfluid" / "__init__.py").write_text("")
    (root / "src" / "rigidfluid" / "sums.py").write_text("def total(a, b):\n    return a + b\n")
    (root / "tests" / "test_sums.py").write_text(
        "from rigidfluid.sums import total\n\ndef test_total():\n    assert total(2, 0) == 2\n"
    )
    (root / "tests" / "test_else.py").write_text("def test_else():\n    pass\n")
    for name, value in (("ROOT", root), ("COPIED", ("src", "tests")), ("PRELOADED", ())):
        monkeypatch.setattr(mutants, name, value)
    # as in the command, which has not imported what it copies
    for name in [name for name in sys.modules if name.split(".")[0] == "rigidfluid"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "path", [*sys.path])
    return tmp_path / "copy"


def outcome(mutants: ModuleType, folder: Path, becomes: str, *tests: str, text: str = "a + b") -> Any:
    folder.mkdir(exist_ok=True)
    return mutants.Workshop(folder).outcome(mutants.Mutation("sums.py", text, becomes, tests))


def test_a_mutation_is_killed_where_a_test_fails_and_survives_else(mutants: ModuleType, project: Path) -> None:
    assert outcome(mutants, project, "a - b + 1", "test_sums.py").verdict == "killed"
    assert outcome(mutants, project, "a - b", "test_sums.py").verdict == "survived"
    assert (mutants.ROOT / "src" / "rigidfluid" / "sums.py").read_text().endswith("a + b\n")


def test_tests_that_fail_anyway_or_do_not_ask_the_file_are_refused(mutants: ModuleType, project: Path) -> None:
    with pytest.raises(mutants.MutationError, match="not imported"):
        outcome(mutants, project, "a - b", "test_else.py")
    file = mutants.ROOT / "tests" / "test_sums.py"
    file.write_text("from rigidfluid.sums import total\n\nassert total(2, 1) == 2\n")
    with pytest.raises(mutants.MutationError, match="without a mutation is killed"):
        outcome(mutants, project, "a - b", "test_sums.py")


def test_outcomes_are_known_until_sources_or_tests_change(mutants: ModuleType, project: Path) -> None:
    survivor = outcome(mutants, project, "a - b", "test_sums.py")
    assert outcome(mutants, project, "a - b", "test_sums.py") == survivor
    with (mutants.ROOT / "tests" / "test_sums.py").open("a") as file:
        file.write("    assert total(2, 1) == 3\n")
    assert outcome(mutants, project, "a - b", "test_sums.py").verdict == "killed"


@pytest.mark.long
def test_tests_without_an_end_are_killed(mutants: ModuleType, project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutants, "PATIENCE", 5)
    loop = "def total(a, b):\n    while b <= 0:\n        pass"
    found = outcome(mutants, project, loop, "test_sums.py", text="def total(a, b):")
    assert found.verdict == "timeout"


def test_the_page_has_totals_and_survivors(mutants: ModuleType) -> None:
    one, other = (mutants.Mutation("a.py", text, "0", ()) for text in ("x | y", "z"))
    reasoned = mutants.Mutation("b.py", "w", "", (), "it is the same")
    found = [mutants.Outcome(one, "survived", 1.0), mutants.Outcome(other, "timeout", 89.0)]
    page = mutants.page([*found, mutants.Outcome(reasoned, "survived", 30.0)], "abc")
    late = f"1 of them as tests took {mutants.PATIENCE} s of CPU time"
    assert f"Of 3 mutations in 2 files 1 are killed, {late}: 33.3 %" in page
    assert "at commit abc, in 2 CPU minutes" in page
    assert "| a.py | `x \\| y` | `0` | a gap |" in page
    assert "| b.py | `w` | nothing | it is the same |" in page
    assert "| a.py | 2 | 1 | 45.0 |" in page
