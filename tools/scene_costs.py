"""Write scenes/costs.csv: the CPU time that each shipped scene is expected to take on one core [s].

    python tools/scene_costs.py

Both ends are those of `rigidfluid check`, for a machine as fast as the one of its fits, on which one core makes 50
GFlop/s; so that they come out the same everywhere.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path

from rigidfluid import load_scene
from rigidfluid.checks import check
from rigidfluid.start.examples import FOLDER, example_names


def foretold(scene: Path) -> tuple[float, float]:
    """Least and greatest CPU time by `check` [s]."""
    (found,) = [one.found for one in check(load_scene(scene)).findings if one.question == "time"]
    return found["least"] * found["speed"], found["most"] * found["speed"]


def rows() -> Iterator[tuple[str, str, str]]:
    """Name, least and most of each scene."""
    for name in example_names():
        scene = FOLDER / f"{name}.toml"
        least, most = foretold(scene)
        yield name, f"{least:.2g}", f"{most:.2g}"


def main() -> int:
    """0 where the file is written."""
    with (FOLDER / "costs.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([("scene", "least", "most"), *rows()])
    return 0


if __name__ == "__main__":
    sys.exit(main())
