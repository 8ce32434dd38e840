"""Recipes in packaging/: one list of Debian's packages, conda's requirements and pip's, a job that comes back."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from paths import ROOT

import rigidfluid

PACKAGING = ROOT / "packaging"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
RECIPE = (PACKAGING / "conda" / "recipe.yaml").read_text(encoding="utf-8")
HOOK = "packaging/long_description.py"
CONDA_NAMES = {"matplotlib": "matplotlib-base", "netgen-mesher": "netgen"}
"""conda-forge's names where they are other than pip's; its `matplotlib` brings Qt."""
needs_bash = pytest.mark.skipif(sys.platform == "win32", reason="a script of bash")


def recipe_list(name: str) -> set[str]:
    """Entries of one list of the recipe's requirements."""
    found = re.search(rf"^  {name}:\n((?:    - .*\n)+)", RECIPE, re.MULTILINE)
    assert found is not None
    return set(re.findall(r"- (.*)", found[1]))


def test_conda_asks_for_what_pip_does() -> None:
    asked = map(Requirement, PROJECT["dependencies"])
    wanted = {f"{CONDA_NAMES.get(one.name, one.name)} {one.specifier}" for one in asked}
    assert recipe_list("run") == wanted | {"python >=${{ python_min }}"}
    python = re.search(r'python_min: "(.*)"', RECIPE)
    assert python is not None
    assert PROJECT["requires-python"] == f">={python[1]}"
    assert f'version: "{rigidfluid.__version__}"' in RECIPE


@pytest.mark.parametrize("name", ["packaging/Dockerfile", "packaging/apptainer.def", "tools/dolfinx"])
def test_debian_packages_are_listed_once(name: str) -> None:
    """All that build on Debian call the one script, and name no package themselves."""
    text = (ROOT / name).read_text(encoding="utf-8")
    assert re.search(r"packaging/debian\"? packages", text)
    assert re.search(r"packaging/debian\"? rigidfluid", text)
    assert not re.search(r"(apt-get install|pip install)(?! debootstrap)", text)


def test_images_get_the_same_files_and_they_are_there() -> None:
    definition = (PACKAGING / "apptainer.def").read_text(encoding="utf-8")
    copied = set(re.findall(r"^ +(\S+) /opt/source/", definition, re.MULTILINE))
    docker = re.findall(r"^COPY (.*) /opt/source", (PACKAGING / "Dockerfile").read_text(encoding="utf-8"), re.MULTILINE)
    assert copied == {name for line in docker for name in line.split()}
    assert [name for name in copied if not (ROOT / name).exists()] == []
    assert copied >= {"pyproject.toml", "src", "scenes", "README.md", HOOK, *PROJECT["license-files"]}


STUBS = {
    # As a queue that sends SIGTERM once a checkpoint is there, unless it has done so before.
    "srun": """#!/bin/bash
        echo "threads $OMP_NUM_THREADS, last ${*: -1}" >>calls
        while [[ $1 == -* ]]; do shift; done
        "$PYTHON" -m "$@" &
        if [[ ! -e stopped ]]; then
            until [[ -s out/dry_bounce/state.h5 ]]; do sleep .05; done
            touch stopped
            kill -TERM $!
        fi
        wait $!""",
    "scontrol": """#!/bin/bash
        echo "scontrol $*" >>calls""",
}
SHORT = ("--set", "time.end=0.02")


def job(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the body of the job with stand-ins for what a cluster has."""
    for name, text in STUBS.items():
        (folder / name).write_text(text, encoding="utf-8")
        (folder / name).chmod(0o755)
    environment = os.environ | {"PATH": f"{folder}:{os.environ['PATH']}", "PYTHON": sys.executable}
    environment |= {"SLURM_JOB_ID": "7", "PYTHONPATH": str(ROOT / "src")}
    shutil.copy(ROOT / "scenes" / "dry_bounce.toml", folder)
    command = ["bash", str(PACKAGING / "slurm" / "job.sh"), "dry_bounce.toml", "--set", "fluid.backend=dry", *arguments]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)


@needs_bash
def test_a_job_is_queued_again_where_it_was_stopped_and_goes_on(tmp_path: Path) -> None:
    first = job(tmp_path, *SHORT)
    assert (first.returncode, "Interrupted" in first.stderr) == (0, True), first.stderr
    assert (tmp_path / "calls").read_text().splitlines() == ["threads 1, last time.end=0.02", "scontrol requeue 7"]
    second = job(tmp_path, *SHORT)
    assert second.returncode == 0, second.stderr
    assert (tmp_path / "calls").read_text().splitlines()[2:] == ["threads 1, last --resume"]
    assert json.loads((tmp_path / "out" / "dry_bounce" / "summary.json").read_text())["status"] == "complete"


@needs_bash
def test_a_job_that_comes_to_no_checkpoint_is_not_queued_for_ever(tmp_path: Path) -> None:
    job(tmp_path, *SHORT)
    (tmp_path / "stopped").unlink()
    stopped = job(tmp_path, *SHORT)
    assert stopped.returncode == 1
    assert "no checkpoint was written before the time limit" in stopped.stderr
    assert (tmp_path / "calls").read_text().count("scontrol") == 1


@needs_bash
def test_a_job_that_fails_says_so(tmp_path: Path) -> None:
    (tmp_path / "stopped").touch()
    failed = job(tmp_path, "--set", "time.end=nothing")
    assert failed.returncode == 2
    assert "time.end" in failed.stderr
