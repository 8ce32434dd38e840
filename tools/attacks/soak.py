"""Long runs, each in one process: memory, open files and the cost of a step do not grow."""

from __future__ import annotations

import os
import statistics
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import rigidfluid
from attacks.contained import FORK
from attacks.hostile_scenes import SCENES

RUNS = {
    "dry": ("dry_bounce.toml", 20_000, ("time.step=2e-5", "output.every=2e-3")),
    "in a fluid": (
        "falling_disk.toml",
        1_500,
        (
            "time.step=0.002",
            "fluid.gravity=[0.0,-50.0]",
            "mesh.size=0.4",
            "mesh.size_body=0.1",
            "mesh.remesh_every=0.05",
            "output.every=0.02",
        ),
    ),
}
"""Shipped scenes, the steps that are taken of them, and their settings."""

SAMPLES = 40
"""How many times a run is looked at."""

GROWTH = {"memory": 1.05, "files": 1.0, "cost": 1.25}
"""What the median of the last quarter may be over that of the second quarter [1]."""


@dataclass(frozen=True)
class Sample:
    """A process after ``steps``: resident ``memory`` [MiB], open ``files``, and CPU time of a step since the sample
    before, the ``cost`` [ms]."""

    steps: int
    memory: float
    files: int
    cost: float


def soak(share: float = 1.0) -> list[dict[str, Any]]:
    """Rows of all runs, of a ``share`` of their steps: samples, growth and whether it is within the bounds."""
    with FORK.Pool(1, maxtasksperchild=1) as process:
        return [process.apply(_soaked, (name, share)) for name in RUNS]


def settings_of(name: str, share: float = 1.0) -> list[str]:
    """Settings of a run, as after ``--set``."""
    _, steps, settings = RUNS[name]
    step = float(settings[0].partition("=")[2])
    return [*settings, f"time.end={round(share * steps) * step!r}"]


def _soaked(name: str, share: float) -> dict[str, Any]:
    samples = _run(SCENES / RUNS[name][0], settings_of(name, share))
    grown = growth(samples)
    held = all(grown[key] <= most for key, most in GROWTH.items())
    shown = [asdict(sample) for sample in samples]
    made = {"run": name, "scene": RUNS[name][0], "settings": settings_of(name, share)}
    return made | {"samples": shown, "growth": grown, "held": held}


def _run(scene: Path, settings: list[str]) -> list[Sample]:
    loaded = rigidfluid.load_scene(scene, settings)
    every, samples, taken = max(round(loaded.time.end / loaded.time.step / SAMPLES), 1), list[Sample](), 0
    before = time.process_time()

    def look(_: object) -> None:
        nonlocal taken, before
        taken += 1
        if taken % every == 0:
            now = time.process_time()
            samples.append(Sample(taken, _memory(), _open_files(), 1e3 * (now - before) / every))
            before = now

    with tempfile.TemporaryDirectory() as folder:
        rigidfluid.run(loaded, Path(folder) / "out", progress=look)
    return samples


def growth(samples: Sequence[Sample]) -> dict[str, float]:
    """The median of each figure in the last quarter, over that in the second one [1]."""
    quarter = len(samples) // 4
    second, last = samples[quarter : 2 * quarter], samples[3 * quarter :]
    return {
        key: statistics.median(getattr(sample, key) for sample in last)
        / statistics.median(getattr(sample, key) for sample in second)
        for key in GROWTH
    }


def _memory() -> float:
    """Resident memory of this process [MiB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def _open_files() -> int:
    return sum(1 for _ in Path("/proc/self/fd").iterdir())
