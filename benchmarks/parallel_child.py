"""One arrangement of `parallel.py` on the ranks that share this process' run.

python benchmarks/parallel_child.py DIMENSION BODIES COARSENESS FILE
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

from collisions import count_contacts
from grids import RANGE, balls_in_a_box
from mesh_sizes import mesh_sizes

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.model.contacts import select
from rigidfluid.core.run.process import Launch, one_openblas_thread
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene

STEPS = 10
"""Number of steps, the same as in the paper."""

_COLLISION = ("contact", "detect")
"""Stopwatch stages of the collision algorithm: contact path with forces and wrenches; detection."""


def scene(dimension: int, bodies: int, coarseness: float, backend: str = "dolfinx") -> Scene:
    """Balls at rest in a box of fluid at rest, without gravity, and contact forces that hardly move them."""
    balls, pose, *_ = balls_in_a_box(dimension, bodies)
    sizes = mesh_sizes(dimension, bodies, coarseness)
    ball = {"type": "sphere", "radius": balls[0].radius, "density": 1.0}
    return scene_from_dict(
        {
            "scene": {"name": "balls", "dimension": dimension},
            "fluid": {"backend": backend, "density": 1.0, "viscosity": 0.01},
            "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
            "body": [ball | {"position": centre.tolist()} for centre in pose.position],
            "contact": {"detector": "narrow_band", "threads": 1, "law": "centre", "epsilon": 1.0, "range": RANGE},
            "mesh": {"size": sizes.size, "size_body": sizes.size_body, "refinements": sizes.refinements},
            "time": {"step": 1e-3, "end": 1.0},
            "output": {"every": 1.0},
        }
    )


def measured(dimension: int, bodies: int, coarseness: float) -> dict[str, Any]:
    """Sizes, contacts, and the mean seconds a step of ten; the first of them factorises, none compiles."""
    with one_openblas_thread():
        run = Simulation(scene(dimension, bodies, coarseness), None, False, Launch.read().size)
        run.step()
        run.system.backend.forget()
        before, start = dict(run.watch.seconds), time.perf_counter()
        for _ in range(STEPS):
            run.step()
        seconds = time.perf_counter() - start
    mesh = run.state.mesh
    assert mesh is not None
    collision = sum(run.watch.seconds[stage] - before[stage] for stage in _COLLISION)
    ranks = mesh.ranks
    seen = run.state.contacts
    pairs, at_wall = count_contacts(select(seen, seen.gap <= RANGE), bodies)
    return {
        "mesh_nodes": len(mesh.points) if mesh.part is None else int(mesh.part.counts[0]),
        "unknowns": run.system.backend.unknowns(mesh, run.system.motions.prescribed),
        "body_body": pairs,
        "body_wall": at_wall,
        "seconds_collision": float(ranks.sum(collision)) / ranks.size / STEPS,
        "seconds_step": float(ranks.sum(seconds)) / ranks.size / STEPS,
    }


def main() -> None:
    """Measure, and let the first rank write."""
    dimension, bodies, coarseness, file = sys.argv[1:]
    found = measured(int(dimension), int(bodies), float(coarseness))
    if Launch.read().rank == 0:
        Path(file).write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
