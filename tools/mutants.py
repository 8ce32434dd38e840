"""Run the tests on mutations of the sources, and tell which of them no test sees.

    python tools/mutants.py [--only TEXT] [--page FILE]

Mutations are in `mutants.toml`: files, texts in them, what each becomes, and the tests that should fail then. Sources
and tests are copied to out/mutants; the checkout is left alone. For each file the tests must first pass as it is, and
must have imported it. Then each mutation is tested until a first test fails; one with which they take far too long is
killed, too. Files of compiled kernels are tested without the compiler. What is known of the same sources and tests is
not tested again, so that a stopped run goes on. Exits with 1 where fewer than 95 % are killed.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib
import json
import os
import resource
import shutil
import signal
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import date
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from checkout import ROOT, commit

LIST = Path(__file__).with_suffix(".toml")
FOLDER = ROOT / "out" / "mutants"
SOURCES = Path("src", "rigidfluid")
COPIED = "src", "tests", "docs", "scenes", "studies", "benchmarks", "plugins", "tools"
SHARED = "tests/support", "scenes"
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.png", "*.gif", "*.egg-info")

PRELOADED = (
    *("numba", "pluggy", "pydantic", "pytest", "skfem", "netgen.meshing", "mmgpy", "h5py", "pypardiso", "rich"),
    *(f"scipy.{name}" for name in ("interpolate", "optimize", "sparse.csgraph", "sparse.linalg", "spatial", "special")),
)
"""Packages that tests need, none of which imports the sources."""

WANTED = 0.95
"""Share of mutations that must be killed."""

PATIENCE = 150
"""CPU seconds after which tests are ended."""

ASLEEP = 30
"""Times of that which pass on the clock before tests are ended that do nothing, or are given little of a machine."""

KERNEL = "njit"
"""Word in files with compiled kernels."""

UNUSED = 100
"""Exit code of tests that pass without the file that is mutated."""


class MutationError(Exception):
    """A list that does not fit the sources, or tests that do not pass without a mutation."""


@dataclass(frozen=True)
class Mutation:
    """A ``text`` in a ``file`` of the sources, and what it ``becomes``; the ``tests`` that should see it, and the
    ``reason`` why none does, where that is known."""

    file: str
    text: str
    becomes: str
    tests: tuple[str, ...]
    reason: str = ""

    def applied(self, source: str) -> str:
        """The ``source`` with this mutation; raises MutationError unless the text is there exactly once."""
        if (times := source.count(self.text)) != 1:
            raise MutationError(f"{self.file}: {self.text!r} is there {times} times, not once; amend {LIST.name}")
        return source.replace(self.text, self.becomes)


class Outcome(NamedTuple):
    """What became of a ``mutation``: killed, timeout or survived; and the CPU ``seconds`` that this took."""

    mutation: Mutation
    verdict: str
    seconds: float


def mutations(path: Path = LIST) -> list[Mutation]:
    """All mutations of a list."""
    tables = tomllib.loads(path.read_text(encoding="utf-8"))["file"]
    return [
        Mutation(table["path"], text, becomes, tuple(table["tests"]), *reason)
        for table in tables
        for text, becomes, *reason in table["changes"]
    ]


class Workshop:
    """Copy of sources and tests in a ``folder``; one file at a time is another one.

    Tests run in forks of this process, which has imported what is not mutated.
    """

    def __init__(self, folder: Path = FOLDER) -> None:
        self._folder, self._stamp = folder, 0.0
        for name in COPIED:
            shutil.rmtree(folder / name, ignore_errors=True)
            shutil.copytree(ROOT / name, folder / name, ignore=LEFT_OUT)
        for path in ROOT.glob("*.*"):
            if path.is_file():
                shutil.copy2(path, folder)
        sources = sorted((folder / SOURCES).rglob("*.py"))
        kernels = (path for path in sources if KERNEL in path.read_text(encoding="utf-8"))
        self._kernels = folder / "kernels" / _digest(kernels)  # numba does not see that one that is called has changed
        shared = (path for name in SHARED for path in sorted((folder / name).rglob("*")) if path.is_file())
        self._common = _digest([*sources, *shared])
        (folder / "outcomes").mkdir(exist_ok=True)
        for name in PRELOADED:
            importlib.import_module(name)

    def source(self, file: str) -> str:
        """Text of a file of the sources."""
        return (self._folder / SOURCES / file).read_text(encoding="utf-8")

    def outcome(self, mutation: Mutation) -> Outcome:
        """Outcome of a mutation; raises MutationError where its tests do not pass without it, or do not import its
        file."""
        plain = replace(mutation, text="", becomes="", reason="")
        if (verdict := self._known(plain)[0]) != "survived":
            raise MutationError(f"{mutation.file} without a mutation is {verdict} by {mutation.tests}:\n{self.output}")
        return Outcome(mutation, *self._known(mutation))

    @property
    def output(self) -> str:
        """Output of the latest tests."""
        return (self._folder / "output").read_text(encoding="utf-8", errors="replace")

    def _known(self, mutation: Mutation) -> tuple[str, float]:
        """Verdict on a mutation and CPU seconds, as they were with the same sources and tests, or else are now."""
        tests = _digest(self._folder / "tests" / test.split("::")[0] for test in mutation.tests)
        name = hashlib.sha256(repr((replace(mutation, reason=""), self._common, tests)).encode()).hexdigest()
        known = self._folder / "outcomes" / f"{name}.json"
        if not known.exists():
            before = _cpu_of_children()
            verdict = self._verdict(mutation)
            known.write_text(json.dumps((verdict, _cpu_of_children() - before)), encoding="utf-8")
        verdict, seconds = json.loads(known.read_text(encoding="utf-8"))
        return verdict, seconds

    def _verdict(self, mutation: Mutation) -> str:
        """Verdict of the tests of a mutation; its file has a time of which no compiled file is."""
        if not mutation.text:
            return self._run(mutation)
        text, path = mutation.applied(self.source(mutation.file)), self._folder / SOURCES / mutation.file
        kept = path.with_suffix(".kept")
        path.rename(kept)
        path.write_text(text, encoding="utf-8")
        self._stamp += 10.0
        os.utime(path, (self._stamp, self._stamp))
        try:
            return self._run(mutation)
        finally:
            kept.replace(path)

    def _run(self, mutation: Mutation) -> str:
        process = get_context("fork").Process(target=_test, args=(self._folder, mutation, self._kernels))
        process.start()
        process.join(ASLEEP * PATIENCE)
        if process.exitcode is None:
            os.killpg(process.pid or 0, signal.SIGKILL)
            process.join()
            return "timeout"
        known = {0: "survived", UNUSED: "not imported", -signal.SIGXCPU: "timeout"}
        return known.get(process.exitcode, "killed")


def _test(folder: Path, mutation: Mutation, kernels: Path) -> None:
    """Run the tests of a mutation in the ``folder`` until one fails, and exit by their result.

    A file of compiled kernels is not compiled: numba does not know which compiled ones call it.
    """
    import numba
    import pytest

    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE + 10))
    os.chdir(folder)
    with Path("output").open("w", encoding="utf-8") as output:
        for stream in (1, 2):
            os.dup2(output.fileno(), stream)
    os.environ["PYTHONPATH"] = str(folder / "src")
    numba.config.CACHE_DIR = str(kernels)
    numba.config.DISABLE_JIT = KERNEL in (folder / SOURCES / mutation.file).read_text(encoding="utf-8")
    sys.path.insert(0, str(folder / "src"))
    options = "-qx", "--tb=line", "-p", "no:cacheprovider", "-m", "not validation"
    code = int(pytest.main([*options, *(f"tests/{test}" for test in mutation.tests)]))
    module = sys.modules.get("rigidfluid." + mutation.file.removesuffix(".py").replace("/", "."))
    if code == 0 and (module is None or module.__file__ != str(folder / SOURCES / mutation.file)):
        code = UNUSED
    sys.stdout.flush()
    os._exit(code)


def outcomes(workshop: Workshop, chosen: Sequence[Mutation]) -> Iterator[Outcome]:
    """Test all mutations, one after the other."""
    for mutation in chosen:
        mutation.applied(workshop.source(mutation.file))
    for mutation in chosen:
        yield workshop.outcome(mutation)


def _digest(files: Iterable[Path]) -> str:
    """Digest of the names and contents of files."""
    whole = hashlib.sha256()
    for path in files:
        whole.update(str(path).encode() + b"\0" + path.read_bytes())
    return whole.hexdigest()


def page(found: Sequence[Outcome], commit: str) -> str:
    """Page of all outcomes."""
    seconds = sum(outcome.seconds for outcome in found)
    verdicts = Counter(outcome.verdict for outcome in found)
    seen = len(found) - verdicts["survived"]
    late = f", {verdicts['timeout']} of them as tests took {PATIENCE} s of CPU time" if verdicts["timeout"] else ""
    lines = [
        "# Mutations",
        "",
        f"Made on {date.today()} by `python tools/mutants.py --page docs/mutants.md`, at commit {commit}, in"
        f" {seconds / 60.0:.0f} CPU minutes.",
        "",
        "Each mutation in `tools/mutants.toml` changes one place of the sources: a sign, a factor, a term, an index, a",
        "stage. The tests named there are run until one fails. A mutation that no test sees survives.",
        "",
        f"Of {len(found)} mutations in {len({one.mutation.file for one in found})} files {seen} are killed{late}:"
        f" {100.0 * seen / len(found):.1f} %.",
        "",
        "| survivor in | text | becomes | why |",
        "|---|---|---|---|",
        *(
            f"| {one.file} | {_code(one.text)} | {_code(one.becomes)} | {one.reason or 'a gap'} |"
            for one, verdict, _ in found
            if verdict == "survived"
        ),
        "",
        "| file | mutations | killed | CPU seconds each |",
        "|---|---|---|---|",
    ]
    for file in dict.fromkeys(one.mutation.file for one in found):
        mine = [one for one in found if one.mutation.file == file]
        killed = sum(one.verdict != "survived" for one in mine)
        lines.append(f"| {file} | {len(mine)} | {killed} | {sum(one.seconds for one in mine) / len(mine):.1f} |")
    return "\n".join(lines) + "\n"


def _code(text: str) -> str:
    return "`" + " ".join(text.split()).replace("|", "\\|") + "`" if text.strip() else "nothing"


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> int:
    """Test the mutations, print a line for each, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="TEXT", help="mutations of which file or text has this in it")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write the page of all outcomes")
    given = parser.parse_args()
    chosen = [one for one in mutations() if given.only in one.file or given.only in one.text]
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    FOLDER.mkdir(parents=True, exist_ok=True)
    found = []
    for outcome in outcomes(Workshop(), chosen):
        found.append(outcome)
        one = outcome.mutation
        print(f"{outcome.verdict:8s} {outcome.seconds:6.1f} s  {one.file}: {one.text!r} -> {one.becomes!r}", flush=True)
    seen = sum(outcome.verdict != "survived" for outcome in found)
    print(f"{seen} of {len(found)} killed, in {sum(outcome.seconds for outcome in found) / 60.0:.1f} CPU minutes")
    if given.page:
        given.page.write_text(page(found, commit()), encoding="utf-8")
    return int(seen < WANTED * len(found))


if __name__ == "__main__":
    sys.exit(main())
