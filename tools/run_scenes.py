"""Run the shipped scenes to their ends, and say how each ended and what it warned of.

    python tools/run_scenes.py OUT [--scenes scenes/*.toml] [--processes 2]

Runs that are complete in OUT stay as they are, and those that stopped go on. Exits with 1 where one did not come to its
end or ended with a warning.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from rigidfluid.core.run.summary import warnings_of
from rigidfluid.python_process import ONE_THREAD

ROOT = Path(__file__).parents[1]


def run(scene: Path, folder: Path) -> dict[str, Any]:
    """Run a scene to its end, in a process of its own with one thread; its summary, or why there is none."""
    if read_summary(folder).get("status") != "complete":
        command = [sys.executable, "-m", "rigidfluid", "run", str(scene), "--out", str(folder)]
        command += ["--resume"] if (folder / "state.h5").exists() else []
        done = subprocess.run(command, env=os.environ | ONE_THREAD, capture_output=True, text=True, check=False)
        if done.returncode:
            return read_summary(folder) | {"status": done.stderr.strip() or f"exit code {done.returncode}"}
    return read_summary(folder)


def read_summary(folder: Path) -> dict[str, Any]:
    """Summary of a run; empty where it has none yet."""
    file = folder / "summary.json"
    found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    return found


def warnings(summary: dict[str, Any]) -> list[str]:
    """Texts of all that a run warned of at its end; none of one that came to no end."""
    return warnings_of(summary) if "energy" in summary else []


def line(name: str, summary: dict[str, Any]) -> str:
    """How a scene ended, its cost, the shares of the energy at hand, and its warnings."""
    energy = summary.get("energy", {})
    shown = [key for key in ("largest_creation", "largest_loss", "summed_creation", "summed_loss") if key in energy]
    shares = ", ".join(f"{key.replace('_', ' ')} {100.0 * energy[key]:.2g} %" for key in shown)
    cost = f"{summary.get('steps', 0)} steps, {summary.get('cpu_time', 0.0):.0f} s of CPU time"
    return f"{name}: {summary.get('status')}; {cost}; {shares}; {' '.join(warnings(summary)) or 'no warning'}"


def main() -> int:
    """0 where all scenes came to their ends without a warning."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--scenes", type=Path, nargs="+", default=sorted((ROOT / "scenes").glob("*.toml")))
    parser.add_argument("--processes", type=int, default=2)
    given = parser.parse_args()
    faultless = True
    with ThreadPoolExecutor(given.processes) as pool:
        runs = {scene: pool.submit(run, scene, given.out / scene.stem) for scene in given.scenes}
        for scene, found in runs.items():
            summary = found.result()
            faultless &= summary.get("status") == "complete" and not warnings(summary)
            print(line(scene.stem, summary), flush=True)
    return int(not faultless)


if __name__ == "__main__":
    sys.exit(main())
