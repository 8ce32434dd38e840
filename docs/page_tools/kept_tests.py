"""What the validation tests of a file have found, kept until the sources or the file are others."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import asdict, dataclass
from pathlib import Path

from page_tools.cpu_time import cpu_seconds
from page_tools.make import PATHS
from page_tools.places import ROOT
from page_tools.provenance import commit, file_digest, source_digest
from rigidfluid.python_process import ONE_THREAD

MARK = "pytest.mark.validation"
OUTCOMES = {"failure": "failed", "error": "failed", "skipped": "skipped"}


@dataclass(frozen=True)
class Found:
    """Names of the tests of a file that ``passed``, ``failed`` and were ``skipped``, the CPU time [s], and by what."""

    passed: list[str]
    failed: list[str]
    skipped: list[str]
    cpu_seconds: float
    commit: str
    source: str
    file: str


def files_of_tests() -> list[Path]:
    """Files in which tests are marked as validation."""
    folders = (ROOT / "tests", *(ROOT / "plugins").glob("*/tests"))
    found = (path for folder in folders for path in sorted(folder.rglob("test_*.py")))
    return [path for path in found if MARK in path.read_text(encoding="utf-8")]


def kept_tests(path: Path, folder: Path, *, fresh: bool = False) -> Found:
    """Run the validation tests of one file, unless it is kept in a folder what they found of these sources."""
    kept = folder / f"{path.stem}.json"
    if kept.exists() and not fresh:
        found = Found(**json.loads(kept.read_text(encoding="utf-8")))
        if (found.source, found.file) == (source_digest(), file_digest(path)):
            return found
    folder.mkdir(parents=True, exist_ok=True)
    found = _run(path, folder / f"{path.stem}.xml")
    kept.write_text(json.dumps(asdict(found)) + "\n", encoding="utf-8")
    return found


def _run(path: Path, told: Path) -> Found:
    """Run them by pytest in a process of its own, in the package that the file is of."""
    told.unlink(missing_ok=True)
    home = next(folder for folder in path.parents if (folder / "pyproject.toml").exists())
    words = ["-m", "pytest", "-q", "-m", "validation", f"--junitxml={told}", str(path)]
    environment = ONE_THREAD | os.environ | {"PYTHONPATH": os.pathsep.join(map(str, PATHS))}
    start = cpu_seconds()
    subprocess.run([sys.executable, *words], cwd=home, env=environment, check=False)
    by_outcome: dict[str, list[str]] = {"passed": [], "failed": [], "skipped": []}
    for case in ElementTree.parse(told).iter("testcase"):
        outcome = next((OUTCOMES[child.tag] for child in case if child.tag in OUTCOMES), "passed")
        by_outcome[outcome].append(case.get("name", ""))
    spent = round(cpu_seconds() - start, 1)
    return Found(**by_outcome, cpu_seconds=spent, commit=commit(), source=source_digest(), file=file_digest(path))
