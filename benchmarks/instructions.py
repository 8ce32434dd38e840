"""Compare the instructions of a step with those of another checkout, as Valgrind counts them, whatever the load.

python benchmarks/instructions.py OTHER [--scenes falling_disk dry_bounce] [--first 4] [--steps 20]

OTHER is a folder with sources of another time, as `git worktree add` makes it. Each scene must be in both. What is
counted is the difference of two runs, so that it has no start in it, but steps with all that goes with them.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from row_command import at_least, row_parser, show_rows

from rigidfluid.errors import OutputError
from rigidfluid.python_process import ONE_THREAD

ROOT = Path(__file__).resolve().parents[1]
STEPS = """
import sys
from rigidfluid.api import Simulation, load_scene
run = Simulation(load_scene(sys.argv[1]))
for _ in range(int(sys.argv[2])):
    run.step()
"""
PROCESSOR = {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": "+sse4.2,+avx,+avx2,+fma,+popcnt,+bmi,+bmi2"}
"""One that Valgrind knows, for which loops are compiled."""
COUNTER = ("valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null")


@dataclass(frozen=True)
class Row:
    """Millions of instructions until the end of the first steps, and of each step after them, in the other checkout and
    in this one."""

    scene: str
    start_there: float
    start_here: float
    step_there: float
    step_here: float
    step_ratio: float


def counted(told: str) -> int:
    """Number of instructions, in what Valgrind tells.

    Raises OutputError if it does not tell it.
    """
    found = re.search(r"I\s+refs:\s+([\d,]+)", told)
    if found is None:
        raise OutputError("valgrind", f"no count in {told.strip()[-300:]!r}", "a count", "See whether it runs here.")
    return int(found[1].replace(",", ""))


def instructions(checkout: Path, scene: str, steps: int) -> int:
    """Number of instructions of a run of so many steps, whose modules and loops a run before has compiled."""
    cache = str(checkout / "out" / "valgrind_cache")
    own = {"PYTHONPATH": str(checkout / "src"), "PYTHONHASHSEED": "0", "NUMBA_CACHE_DIR": cache}
    own |= {"PYTHONPYCACHEPREFIX": cache, "PYTHONDONTWRITEBYTECODE": ""}
    command = [sys.executable, "-c", STEPS, str(checkout / "scenes" / f"{scene}.toml"), str(steps)]
    _said(command, checkout, own)
    return counted(_said([*COUNTER, *command], checkout, own))


def _said(command: list[str], checkout: Path, own: dict[str, str]) -> str:
    """Errors and counts that a command in a checkout tells.

    Raises OutputError if it fails.
    """
    variables = os.environ | ONE_THREAD | PROCESSOR | own
    done = subprocess.run(command, env=variables, cwd=checkout, capture_output=True, text=True, check=False)
    if done.returncode:
        raise OutputError(
            " ".join(command[-2:]), f"it ended with {done.stderr.strip()[-300:]!r}", None, "Run it alone."
        )
    return done.stderr


def compared(other: Path, scene: str, first: int, steps: int) -> Row:
    """Row of a scene."""
    starts, wholes = (
        [instructions(checkout, scene, number) for checkout in (other, ROOT)] for number in (first, first + steps)
    )
    there, here = ((whole - start) / steps for start, whole in zip(starts, wholes, strict=True))
    return Row(scene, *(start / 1e6 for start in starts), there / 1e6, here / 1e6, here / there)


def rows(other: Path, scenes: list[str], first: int, steps: int) -> Iterator[Row]:
    """Rows of the scenes."""
    for scene in scenes:
        yield compared(other, scene, first, steps)


def main() -> None:
    """Read the arguments, count and print."""
    parser = row_parser(__doc__)
    parser.add_argument("other", type=Path, metavar="OTHER", help="folder with sources of another time")
    parser.add_argument("--scenes", nargs="+", default=["falling_disk", "dry_bounce"], help="names in scenes/")
    parser.add_argument("--first", type=at_least(1), default=4, help="steps that count as the start")
    parser.add_argument("--steps", type=at_least(1), default=20, help="steps after them")
    given = parser.parse_args()
    show_rows(rows(given.other.resolve(), given.scenes, given.first, given.steps), given.json)


if __name__ == "__main__":
    main()
