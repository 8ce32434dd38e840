"""Runs that are killed at random moments, taken up, killed again and at last left alone: their results are those of an
unbroken run to the last bit."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from random import Random

from attacks.small_runs import DRY, WET, SmallRun, differences
from attacks.trials import Trial

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
PER_CHAIN = 5
"""Kills of one run before it is left alone."""

AT_ONCE = 4
"""Chains that run at the same time."""

LONGEST = 300.0
"""Time in which a command ends [s]."""


@dataclass(frozen=True)
class Kill:
    """One kill of a chain: the signal, seconds after the start, the exit code, and what the command said."""

    number: signal.Signals
    after: float
    code: int
    said: str

    @property
    def orderly(self) -> bool:
        """Whether the command ended as the signal, or its own end, asks, and without a traceback; before the command
        line begins to load, in the first tenth of a second, Python has one of its own, and at times a code."""
        if "Traceback" in self.said and "rigidfluid/cli" not in self.said:
            return True
        codes = {-self.number, 0} if self.number == signal.SIGKILL else {-self.number, 130, 0}
        return self.code in codes and "Traceback" not in self.said


def attack_by_kills(count: int, start: int) -> Iterator[Trial]:
    """Chains of kills, each fifth one in a fluid; some at once, so that they disturb each other's time."""
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(AT_ONCE) as pool:
        place, chains = Path(name), range(-(-count // PER_CHAIN))
        runs = {small.name: small for small in map(_run_of_chain, chains)}
        spans = {small.name: _run_unbroken(small, place / small.name) for small in runs.values()}

        def kill(chain: int) -> list[Trial]:
            small, kills = _run_of_chain(chain), min(PER_CHAIN, count - chain * PER_CHAIN)
            return _chain(small, place, chain, Random(f"{start} {chain}"), kills, spans[small.name])

        for trials in pool.map(kill, chains):
            yield from trials


def _run_of_chain(chain: int) -> SmallRun:
    return WET if chain % 5 == 4 else DRY


def _run_unbroken(small: SmallRun, folder: Path) -> float:
    """Run to the end; the seconds that it takes."""
    before = time.perf_counter()
    subprocess.run(command(small, folder), check=True, stdout=subprocess.DEVNULL, timeout=LONGEST)
    return time.perf_counter() - before


def _chain(small: SmallRun, place: Path, chain: int, chosen: Random, count: int, span: float) -> list[Trial]:
    """Kills of one run within a ``span``, and whether it comes to the results of the unbroken one at last."""
    out, kills = place / f"chain {chain}", list[Kill]()
    while sum(kill.code != 0 for kill in kills) < count:
        kills.append(killed(command(small, out), chosen.choice(SIGNALS), chosen.uniform(0.0, span)))
        if kills[-1].code == 0:  # the end came first
            shutil.rmtree(out)
    last = subprocess.run(command(small, out), capture_output=True, text=True, check=False, timeout=LONGEST)
    other = [f"no end: {last.stderr}"] if last.returncode else differences(out, place / small.name)
    shutil.rmtree(out, ignore_errors=True)
    return [_trial(small, chain, kill, other) for kill in kills]


def killed(command: list[str], number: signal.Signals, after: float) -> Kill:
    """Start a command, and send it a signal some seconds after."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        _, said = process.communicate(timeout=after)
    except subprocess.TimeoutExpired:
        process.send_signal(number)
        _, said = process.communicate(timeout=LONGEST)
    return Kill(number, after, process.returncode, said)


def command(small: SmallRun, out: Path) -> list[str]:
    """The run's command, which goes on where there is a checkpoint."""
    settings = [part for assignment in small.assignments() for part in ("--set", assignment)]
    resume = ["--resume"] if (out / "state.h5").exists() else []
    return [sys.executable, "-m", "rigidfluid", "run", str(small.path), "--out", str(out), *settings, *resume]


def _trial(small: SmallRun, chain: int, kill: Kill, other: list[str]) -> Trial:
    what = f"chain {chain}: {kill.number.name} after {kill.after:.3f} s"
    how = "ended first" if kill.code == 0 else "killed, and the same results"
    if other or not kill.orderly:
        how = f"other results: {', '.join(other)}" if other else f"exit code {kill.code}"
    return Trial(f"{small.name}: {kill.number.name}", what, how, kill.said[-1000:], not other and kill.orderly)
