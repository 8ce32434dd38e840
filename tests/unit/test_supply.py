"""Packages of others: lower bounds, the lock file, their licences, and the limits that SECURITY.md names."""

from __future__ import annotations

import re
import runpy

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from paths import ROOT

from rigidfluid import regular_file
from rigidfluid.core.mesh.generation.inserter import MESHER_TIMEOUT
from rigidfluid.core.nested import expressions
from rigidfluid.core.nested.rows import MOST_ROWS
from rigidfluid.core.scene.validation import LARGEST, SMALLEST
from rigidfluid.core.setup.model_checks import MOST_STEPS
from rigidfluid.domains import trial
from rigidfluid.post.studies.model import MOST_RUNS

LOWEST = runpy.run_path(str(ROOT / "tools" / "lowest.py"))
REQUIREMENTS: dict[str, Requirement] = {str(one): one for one in LOWEST["requirements"]()}
LOCKED = (ROOT / "requirements.lock").read_text(encoding="utf-8").splitlines()
PROSE, _, TABLE = (ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8").partition("## All packages")
ROWS = re.findall(r"^\| (\S+) (\S+) \| (.+) \| (.*) \|$", TABLE, re.MULTILINE)
ASKS_MORE = re.compile("GPL|General Public|Mozilla|MPL|CeCILL|Intel|Proprietary|LicenseRef|not stated")
SECURITY = (ROOT / "SECURITY.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("wanted", REQUIREMENTS.values(), ids=REQUIREMENTS)
def test_a_requirement_has_a_lower_bound_alone_and_the_lock_file_meets_it(wanted: Requirement) -> None:
    assert LOWEST["lower_bound"](wanted)
    assert [one.operator for one in wanted.specifier] == [">="], "an upper bound hides what is newer"
    pinned = {canonicalize_name(name): version for name, version in (line.split("==") for line in LOCKED)}
    assert pinned[canonicalize_name(wanted.name)] in wanted.specifier, "run make lock"


def test_the_lock_file_holds_names_and_versions_alone() -> None:
    assert [line for line in LOCKED if not re.fullmatch(r"[\w.-]+==[\w.+]+", line)] == []


def test_third_parties_are_the_packages_of_the_lock_file() -> None:
    assert [f"{name}=={version}" for name, version, *_ in ROWS] == LOCKED, "run python tools/third_party.py"


@pytest.mark.parametrize(("name", "licence"), [(name, licence) for name, _, licence, _ in ROWS])
def test_a_licence_that_asks_for_more_than_a_notice_is_spoken_of(name: str, licence: str) -> None:
    assert f"`{name}`" in PROSE or not ASKS_MORE.search(licence)


def test_every_package_is_brought_by_something() -> None:
    assert [name for name, *_, brought_by in ROWS if not brought_by] == []


@pytest.mark.parametrize(
    "limit",
    [
        f"at most {regular_file.MOST_TEXT >> 20} MiB (scenes",
        f"or {regular_file.MOST_GEOMETRY >> 20} MiB (geometry)",
        f"{expressions.LONGEST:,} characters, {expressions.DEEPEST} levels",
        f"0, or from {SMALLEST:g} to {LARGEST:g} in size",
        f"| {MOST_ROWS:,} rows |",
        f"| {MOST_RUNS:,} runs |",
        f"in {trial.SECONDS:g} s, {trial._MEMORY >> 30} GiB and {trial._PER_BYTE} bytes for each byte",
        f"{MESHER_TIMEOUT:g} s unless the scene says otherwise",
    ],
)
def test_limits_in_the_notes_on_security_are_those_of_the_code(limit: str) -> None:
    assert limit in SECURITY


def test_the_most_steps_in_the_notes_on_security_are_those_of_the_code() -> None:
    assert MOST_STEPS == 10**9
    assert "10⁹ steps" in SECURITY
