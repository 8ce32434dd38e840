"""Steps of a scene of many bodies, with the CPU time and the memory of each."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from rigidfluid import Scene
from rigidfluid.api import Simulation

MEBIBYTE = 2.0**20
MESHES = ("mesh", "move mesh", "transfer")


def measured(scene: Scene) -> dict[str, Any]:
    """The run as a row."""
    began = time.process_time()
    run = Simulation(scene)
    made, memory, seconds = time.process_time() - began, [_resident()], []
    while not run.ended:
        began = time.process_time()
        run.step()
        seconds.append(time.process_time() - began)
        memory.append(_resident())
    ledger, steps = run.state.ledger, run.history.steps
    return {
        "bodies": len(scene.body),
        "time": run.time,
        "unknowns": [int(steps["unknowns"][1]), int(steps["unknowns"].max())],
        "remeshes": run.counts.remeshes,
        "failed": run.counts.failed_remeshes,
        "rejected": run.counts.rejected,
        "start": made,
        "seconds": seconds,
        "memory": memory,
        "stages": run.watch.seconds,
        "residual": ledger.residual / ledger.put_in,
        "gap": float(run.history.bodies["gap"].min()) / scene.body[0].radius,
    }


def _resident() -> float:
    """Memory of this process, as Linux tells it [MiB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MEBIBYTE


def figures(row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Rows of a table: bodies, unknowns, steps, meshes, seconds, memory, and what is left of the energy."""
    seconds, memory, stages = row["seconds"], row["memory"], row["stages"]
    total = sum(stages.values())
    half = len(memory) // 2
    yield "bodies", f"{row['bodies']}"
    yield "unknowns at the start, at most", "{:,}, {:,}".format(*row["unknowns"])
    yield "steps, rejected", f"{len(seconds)}, {row['rejected']}"
    yield "new meshes, failed", f"{row['remeshes']}, {row['failed']}"
    yield "smallest gap over the radius", f"{row['gap']:.3f}"
    yield "CPU time of the start", f"{row['start']:.0f} s"
    yield "of the first step", f"{seconds[0]:.2f} s"
    yield "of a later step, mean", f"{sum(seconds[1:]) / len(seconds[1:]):.2f} s"
    yield "of a later step, greatest", f"{max(seconds[1:]):.2f} s"
    yield "stages: meshes", f"{sum(stages.get(stage, 0.0) for stage in MESHES) / total:.0%}"
    yield "stages: fluid and bodies", f"{stages.get('advance', 0.0) / total:.0%}"
    yield "stages: responses of bodies in contact", f"{stages.get('response', 0.0) / total:.0%}"
    yield "memory, most in the first half of the steps", f"{max(memory[: half + 1]):.0f} MiB"
    yield "memory, most in the second half", f"{max(memory[half:]):.0f} MiB"
    yield "residual over the energy put in", f"{row['residual']:+.1e}"


def figure(row: dict[str, Any]) -> Figure:
    """CPU time and memory over the steps."""
    found = Figure(figsize=(8.0, 3.4), dpi=100, layout="constrained")
    left, right = found.subplots(1, 2)
    left.plot(range(1, len(row["seconds"]) + 1), row["seconds"], ".-")
    right.plot(row["memory"])
    left.set(xlabel="step", ylabel="CPU time of a step [s]", ylim=(0.0, None))
    right.set(xlabel="step", ylabel="memory [MiB]", ylim=(0.0, None))
    return found
