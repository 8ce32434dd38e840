"""Attack the program, print what was tried and what held, and keep it for the page.

    python tools/attack.py KIND [--count N] [--seed S]

KIND is one of `scenes`, `overrides`, `parts`, `geometry`, `checkpoints`, `kills`, `soak`; `page` writes
docs/attack.md from what is kept of them all in out/attack. Exits with 1 where something did not hold. Needs
the extra `test`, and a system with fork and /proc.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Callable, Iterable
from datetime import date
from typing import Any

from attacks.page import write_attack_page
from attacks.trials import Trial, failures, keep, rows
from checkout import commit

KINDS: dict[str, tuple[str, str, int]] = {
    "scenes": ("attacks.scenes", "attack_scenes", 1500),
    "overrides": ("attacks.scenes", "attack_settings", 750),
    "parts": ("attacks.parts", "attack_by_parts", 1000),
    "geometry": ("attacks.geometry", "attack_geometry", 350),
    "checkpoints": ("attacks.checkpoints", "attack_checkpoints", 400),
    "kills": ("attacks.kills", "attack_by_kills", 125),
}
"""Module, function and number of trials of each kind."""


def attack(kind: str, count: int, seed: int) -> dict[str, Any]:
    """The record of one kind of attack, with what did not hold in full."""
    module, function, _ = KINDS[kind]
    attempts: Callable[[int, int], Iterable[Trial]] = getattr(importlib.import_module(module), function)
    trials = []
    for trial in attempts(count, seed):
        trials.append(trial)
        if not trial.held:
            print(f"did not hold: {trial}", flush=True)
    return {"groups": rows(trials), "failures": failures(trials)}


def soak() -> dict[str, Any]:
    """The record of the long runs."""
    from attacks.soak import GROWTH, soak

    runs = soak()
    return {"most": GROWTH, "runs": runs, "failures": [run["run"] for run in runs if not run["held"]]}


def made(kind: str, count: int, seed: int) -> dict[str, Any]:
    """The record of an attack, with what it was made by."""
    command = f"python tools/attack.py {kind}" + ("" if kind == "soak" else f" --count {count} --seed {seed}")
    origin = {"command": command, "date": f"{date.today()}", "commit": commit()}
    found = soak() if kind == "soak" else attack(kind, count, seed)
    return origin | {"cpu_seconds": round(sum(os.times()[:4]))} | found


def main() -> int:
    """0 where all held."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=[*KINDS, "soak", "page"])
    parser.add_argument("--count", type=int)
    parser.add_argument("--seed", type=int, default=20261125)
    given = parser.parse_args()
    if given.kind == "page":
        print(f"wrote {write_attack_page()}")
        return 0
    record = made(given.kind, given.count or KINDS.get(given.kind, ("", "", 0))[2], given.seed)
    for line in record.get("groups", record.get("runs")):
        print({key: value for key, value in line.items() if key != "samples"})
    print(f"wrote {keep(given.kind, record)}")
    return int(bool(record["failures"]))


if __name__ == "__main__":
    sys.exit(main())
