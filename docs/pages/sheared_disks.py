"""200 disks in a sheared cell that is periodic along its walls: steps, seconds and memory."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from page_tools import Page, Work, table

import rigidfluid
from rigidfluid import Scene
from rigidfluid.api import Simulation

MEBIBYTE = 2.0**20
DISK = {"type": "sphere", "radius": 0.25}
MESHES = ("mesh", "move mesh", "transfer")


def page(work: Work) -> Page:
    """What a step costs, by stages, and memory after each step."""
    (row,) = work.rows(measured)
    text = ABOUT.format(figures=table(("figure", "value"), _figures(row)))
    return Page("200 disks in a sheared cell", text, {"": _figure(row)})


def disks() -> Scene:
    """200 disks between walls that slide past each other."""
    walls = [{"on": side, "type": "wall", "velocity": [speed, 0.0]} for side, speed in (("bottom", -5), ("top", 5))]
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "sheared_disks", "dimension": 2, "seed": 1},
            "fluid": {"density": 1.0, "viscosity": 1.0, "initial": ["y - 5", "0"]},
            "domain": {"lower": [0.0, 0.0], "upper": [20.0, 10.0]},
            "boundary": [{"on": "all", "type": "periodic"}, *walls],
            "swarm": [{"name": "disk", "number": 200, "density": 1.0, "gap": 0.06, "shape": [DISK]}],
            "contact": {"law": "normal", "range": 0.05, "epsilon": "auto", "impact_speed": 0.25},
            "mesh": {"size": 0.5, "size_body": 0.16, "growth": 0.3, "cells_per_gap": 1, "refinements": 1},
            "time": {"end": 1.0, "step": 0.04},
            "output": {"every": 1.0},
        }
    )


def measured() -> Iterator[dict[str, Any]]:
    """The run as a row."""
    scene, began = disks(), time.process_time()
    run = Simulation(scene)
    made, memory, seconds = time.process_time() - began, [_resident()], []
    while not run.ended:
        began = time.process_time()
        run.step()
        seconds.append(time.process_time() - began)
        memory.append(_resident())
    ledger, steps = run.state.ledger, run.history.steps
    yield {
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
        "gap": float(run.history.bodies["gap"].min()),
    }


def _resident() -> float:
    """Memory of this process, as Linux tells it [MiB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MEBIBYTE


def _figures(row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    seconds, memory, stages = row["seconds"], row["memory"], row["stages"]
    total = sum(stages.values())
    half = len(memory) // 2
    yield "bodies", f"{row['bodies']}"
    yield "unknowns at the start, at most", "{:,}, {:,}".format(*row["unknowns"])
    yield "steps, rejected", f"{len(seconds)}, {row['rejected']}"
    yield "new meshes, failed", f"{row['remeshes']}, {row['failed']}"
    yield "smallest gap over the radius", f"{4.0 * row['gap']:.3f}"
    yield "CPU time of the start", f"{row['start']:.0f} s"
    yield "of a step, mean", f"{sum(seconds) / len(seconds):.2f} s"
    yield "of a step, greatest", f"{max(seconds):.2f} s"
    yield "stages: meshes", f"{sum(stages.get(stage, 0.0) for stage in MESHES) / total:.0%}"
    yield "stages: fluid and bodies", f"{stages.get('advance', 0.0) / total:.0%}"
    yield "stages: responses of bodies in contact", f"{stages.get('response', 0.0) / total:.0%}"
    yield "memory, most in the first half of the steps", f"{max(memory[: half + 1]):.0f} MiB"
    yield "memory, most in the second half", f"{max(memory[half:]):.0f} MiB"
    yield "residual over the energy put in", f"{row['residual']:+.1e}"


def _figure(row: dict[str, Any]) -> Figure:
    figure = Figure(figsize=(8.0, 3.4), dpi=100, layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(range(1, len(row["seconds"]) + 1), row["seconds"], ".-")
    right.plot(row["memory"])
    left.set(xlabel="step", ylabel="CPU time of a step [s]", ylim=(0.0, None))
    right.set(xlabel="step", ylabel="memory [MiB]", ylim=(0.0, None))
    return figure


ABOUT = """The scene of this page, `docs/pages/sheared_disks.py`, is for cost and memory on a coarse mesh: 200 disks of
the fluid's density, a fifth of the area, seeded by `[[swarm]]`, are sheared at a rate of 1 between walls that slide.
The cell is periodic along them.

{figures}

Seconds are CPU time of one core; the start is loading, seeding and the first mesh. Memory is that of the process after
each step; it changes with the mesh."""
