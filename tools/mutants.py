"""Run the tests on mutations of the sources, and tell which of them no test sees.

    python tools/mutants.py [--only TEXT] [--page FILE]

Mutations are in `mutants.toml`: files, texts in them, what each becomes, and the tests that should fail then. Sources
and tests are copied to a folder of their own; the checkout is left alone. There the tests must first pass, and fail
where a file cannot be imported, which shows that they test the copy. Then each mutation is tested until a first test
fails. One with which the tests take far too long is killed, too. A file of compiled kernels is tested with an empty
cache. Exits with 1 where fewer than 95 % are killed.
"""

from __future__ import annotations

import argparse
import importlib
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import date
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
LIST = Path(__file__).with_suffix(".toml")
SOURCES = Path("src", "rigidfluid")
COPIED = "src", "tests", "docs", "scenes", "studies", "benchmarks", "plugins", "tools"
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.png", "*.gif", "*.egg-info")

PRELOADED = (
    *("numba", "pluggy", "pydantic", "pytest", "skfem", "netgen.meshing", "mmgpy", "h5py", "pypardiso", "rich"),
    *(f"scipy.{name}" for name in ("interpolate", "optimize", "sparse.csgraph", "sparse.linalg", "spatial", "special")),
)
"""Packages that tests need, none of which imports the sources."""

WANTED = 0.95
"""Share of mutations that must be killed."""

PATIENCE = 600.0
"""Seconds after which tests are ended."""


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

    def __init__(self, folder: Path) -> None:
        self._folder, self._stamp = folder, 0.0
        for name in COPIED:
            shutil.copytree(ROOT / name, folder / name, ignore=LEFT_OUT)
        for path in ROOT.glob("*.*"):
            if path.is_file():
                shutil.copy2(path, folder)
        for name in PRELOADED:
            importlib.import_module(name)

    def source(self, file: str) -> str:
        """Text of a file of the sources."""
        return (self._folder / SOURCES / file).read_text(encoding="utf-8")

    def verdict(self, tests: Sequence[str], file: str = "", text: str | None = None) -> str:
        """Verdict of ``tests`` where a file has this ``text``; without one, of the sources as they are."""
        kernels = self._folder / "kernels"
        if text is None:
            return self._run(tests, kernels)
        if "njit" not in text:
            with self._replaced(file, text):
                return self._run(tests, kernels)
        with self._replaced(file, text), tempfile.TemporaryDirectory(dir=self._folder) as empty:
            return self._run(tests, Path(empty))

    @property
    def output(self) -> str:
        """Output of the latest tests."""
        return (self._folder / "output").read_text(encoding="utf-8", errors="replace")

    @contextmanager
    def _replaced(self, file: str, text: str) -> Iterator[None]:
        """Another text in a file, of a time that no compiled file is of."""
        path = self._folder / SOURCES / file
        kept = path.with_suffix(".kept")
        path.rename(kept)
        path.write_text(text, encoding="utf-8")
        self._stamp += 10.0
        os.utime(path, (self._stamp, self._stamp))
        try:
            yield
        finally:
            kept.replace(path)

    def _run(self, tests: Sequence[str], kernels: Path) -> str:
        process = get_context("fork").Process(target=_test, args=(self._folder, tests, kernels))
        process.start()
        process.join(PATIENCE)
        if process.exitcode is None:
            os.killpg(process.pid or 0, signal.SIGKILL)
            process.join()
            return "timeout"
        return "killed" if process.exitcode else "survived"


def _test(folder: Path, tests: Sequence[str], kernels: Path) -> None:
    """Run ``tests`` in the ``folder`` until one fails, in a process of their own, and exit by their result."""
    import numba
    import pytest

    os.setsid()
    os.chdir(folder)
    with open("output", "w", encoding="utf-8") as output:
        for stream in (1, 2):
            os.dup2(output.fileno(), stream)
    os.environ |= {"PYTHONPATH": str(folder / "src"), "NUMBA_CACHE_DIR": str(kernels)}
    numba.config.CACHE_DIR = str(kernels)
    sys.path.insert(0, str(folder / "src"))
    options = "-qx", "--tb=line", "-p", "no:cacheprovider", "-m", "not validation"
    code = pytest.main([*options, *(f"tests/{test}" for test in tests)])
    sys.stdout.flush()
    os._exit(int(code))


def refuse_useless_tests(workshop: Workshop, chosen: Sequence[Mutation]) -> None:
    """Raise MutationError where tests do not pass without a mutation, or pass without the file that it is in."""
    for tests in dict.fromkeys(mutation.tests for mutation in chosen):
        if workshop.verdict(tests) != "survived":
            raise MutationError(f"without a mutation fail {', '.join(tests)}:\n{workshop.output}")
    for file, tests in dict.fromkeys((mutation.file, mutation.tests) for mutation in chosen):
        if workshop.verdict(tests, file, "raise ImportError\n") == "survived":
            raise MutationError(f"{file} is imported by none of {', '.join(tests)}")


def outcomes(workshop: Workshop, chosen: Iterable[Mutation]) -> Iterator[Outcome]:
    """Test all mutations, one after the other."""
    for mutation in chosen:
        before = _cpu_of_children()
        verdict = workshop.verdict(mutation.tests, mutation.file, mutation.applied(workshop.source(mutation.file)))
        yield Outcome(mutation, verdict, _cpu_of_children() - before)


def page(found: Sequence[Outcome], seconds: float, commit: str) -> str:
    """Page of all outcomes, after so many CPU ``seconds`` for everything."""
    verdicts = Counter(outcome.verdict for outcome in found)
    seen = len(found) - verdicts["survived"]
    late = f", {verdicts['timeout']} of them since the tests took more than {PATIENCE:g} s" if verdicts["timeout"] else ""
    lines = [
        "# Mutations",
        "",
        f"Made on {date.today()} by `python tools/mutants.py --page docs/validation/mutants.md`, at commit {commit}, in"
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


def _commit() -> str:
    """Commit of the checkout, and whether anything differs from it."""
    git = ["git", "-C", str(ROOT)]
    head = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True)
    changed = subprocess.run([*git, "status", "--porcelain", "src", "tests"], capture_output=True, text=True, check=True)
    return head.stdout.strip() + (" with changes" if changed.stdout else "")


def main() -> int:
    """Test the mutations, print a line for each, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="TEXT", help="mutations of which file or text has this in it")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write the page of all outcomes")
    given = parser.parse_args()
    chosen = [one for one in mutations() if given.only in one.file or given.only in one.text]
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        workshop, found = Workshop(Path(folder)), list[Outcome]()
        for mutation in chosen:
            mutation.applied(workshop.source(mutation.file))
        refuse_useless_tests(workshop, chosen)
        for outcome in outcomes(workshop, chosen):
            found.append(outcome)
            one = outcome.mutation
            print(f"{outcome.verdict:8s} {outcome.seconds:6.1f} s  {one.file}: {one.text!r} -> {one.becomes!r}", flush=True)
    seen = sum(outcome.verdict != "survived" for outcome in found)
    print(f"{seen} of {len(found)} killed in {_cpu_of_children() / 60.0:.1f} CPU minutes")
    if given.page:
        given.page.write_text(page(found, _cpu_of_children(), _commit()), encoding="utf-8")
    return int(seen < WANTED * len(found))


if __name__ == "__main__":
    sys.exit(main())
