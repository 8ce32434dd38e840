"""Run the shipped scenes by two trees of the code, and say which results differ in any bit.

    python tools/same_results.py OLD/src NEW/src [--scenes scenes/*.toml] [--steps 8]

Each scene makes so many steps, with outputs after half of them and at the end; the new tree also resumes its run from
half way. Compared are all tables and fields, and the summary but for what is timed and where it ran. Exits with 1 where
something differs.
"""

from __future__ import annotations

import argparse
import filecmp
import json
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
OF_THE_RUN = ("wall_time", "cpu_time", "wall_time_per_stage", "peak_memory", "versions", "files")


def run(source: Path, scene: Path, out: Path, end: float, every: float, *more: str) -> None:
    """Run a scene in a process of its own."""
    values = (f"time.end={end!r}", f"output.every={every!r}")
    command = [sys.executable, "-m", "rigidfluid", "run", str(scene), "--out", str(out)]
    command += [word for value in values for word in ("--set", value)] + list(more)
    environment = os.environ | {"PYTHONPATH": str(source.resolve()), "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{scene.name} by {source}:\n{done.stderr or done.stdout}")


def differences(old: Path, new: Path) -> list[str]:
    """Names of the results that are not the same in both folders."""
    names = {path.relative_to(folder) for folder in (old, new) for path in folder.rglob("*") if path.is_file()}
    compared = sorted(name for name in names if name.suffix in {".csv", ".vtu", ".pvd"})
    return [str(name) for name in compared if not _same(old / name, new / name)] + _summaries(old, new)


def _same(old: Path, new: Path) -> bool:
    return old.is_file() and new.is_file() and filecmp.cmp(old, new, shallow=False)


def _summaries(old: Path, new: Path) -> list[str]:
    before, after = (json.loads((folder / "summary.json").read_text()) for folder in (old, new))
    keys = (before.keys() | after.keys()) - set(OF_THE_RUN)
    return [f"summary.json: {key}" for key in sorted(keys) if before.get(key) != after.get(key)]


def main() -> None:
    """Run all scenes, and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--scenes", type=Path, nargs="+", default=sorted((ROOT / "scenes").glob("*.toml")))
    parser.add_argument("--steps", type=int, default=8)
    given, differ = parser.parse_args(), False
    for scene in given.scenes:
        half = tomllib.loads(scene.read_text())["time"]["step"] * (given.steps // 2)
        with tempfile.TemporaryDirectory() as folder:
            old, new, resumed = (Path(folder) / name for name in ("old", "new", "resumed"))
            run(given.old, scene, old, 2 * half, half)
            run(given.new, scene, new, 2 * half, half)
            run(given.new, scene, resumed, half, half)
            run(given.new, scene, resumed, 2 * half, half, "--resume")
            found = [*differences(old, new), *(f"resumed: {name}" for name in differences(new, resumed))]
        differ |= bool(found)
        print(f"{scene.name}: {', '.join(found) or 'same'}", flush=True)
    sys.exit(int(differ))


if __name__ == "__main__":
    main()
