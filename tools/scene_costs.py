"""Write scenes/costs.csv: the CPU time that each shipped scene is expected to take on one core [s].

    python tools/scene_costs.py

Both ends are those of `rigidfluid check`, for a machine as fast as the one of its fits, on which one core makes 50
GFlop/s; so that they come out the same everywhere. A scene without a mesh, for which `check` foretells no time, is run,
and both ends are what it took here.
"""

from __future__ import annotations

import csv
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from rigidfluid import load_scene, run
from rigidfluid.checks import check
from rigidfluid.start.examples import FOLDER, example_names


def foretold(scene: Path) -> tuple[float, float] | None:
    """Least and greatest CPU time by `check` [s], None where it foretells none."""
    found = [finding.found for finding in check(load_scene(scene)).findings if finding.question == "time"]
    return None if not found else (found[0]["least"] * found[0]["speed"], found[0]["most"] * found[0]["speed"])


def measured(scene: Path) -> tuple[float, float]:
    """CPU time of a run, twice, after one of a single step that compiles the loops [s]."""
    loaded = load_scene(scene)
    run(load_scene(scene, [f"time.end={loaded.time.step}"]))
    begun = time.process_time()
    run(loaded)
    return (time.process_time() - begun,) * 2


def rows() -> Iterator[tuple[str, str, str]]:
    """Name, least and most of each scene."""
    for name in example_names():
        scene = FOLDER / f"{name}.toml"
        least, most = foretold(scene) or measured(scene)
        yield name, f"{least:.2g}", f"{most:.2g}"


def main() -> int:
    """0 where the file is written."""
    with (FOLDER / "costs.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([("scene", "least", "most"), *rows()])
    return 0


if __name__ == "__main__":
    sys.exit(main())
