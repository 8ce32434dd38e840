"""One substep of 10,000 dry spheres in a box, beside LAMMPS' on one thread, in one run.

The spheres move at random from a lattice and collide by the law `centre` (LAMMPS: `pair_style table`, `fix wall/table`)
or `spring-dashpot` (LAMMPS: `pair_style granular`). Both take the same velocity Verlet steps; nothing is written. They
take turns, and each figure is the smallest of several timings, which a busy machine disturbs least.

    pip install ./plugins/rigidfluid-lammps
    python benchmarks/dry_spheres.py [--side 22] [--steps 200] [--repeats 3] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import rigidfluid
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.run.simulation import Simulation
from rigidfluid_lammps.kinds import kinds
from rigidfluid_lammps.library import lammps_session
from rigidfluid_lammps.theirs import build

RADIUS, SPACING, RANGE, STEP = 0.4, 1.0, 0.05, 1e-3
LAWS: dict[str, dict[str, Any]] = {
    "centre": {"law": "centre", "range": RANGE, "epsilon": 1e-6},
    "spring-dashpot": {"law": "spring-dashpot", "range": RANGE, "stiffness": 1e4, "restitution": 0.9},
}


def scene(law: str, side: int, steps: int) -> rigidfluid.Scene:
    """side³ spheres with random velocities; one step of the run is that many substeps."""
    random = np.random.default_rng(4)
    places = (np.stack(np.meshgrid(*[np.arange(side)] * 3), axis=-1).reshape(-1, 3) + 0.5) * SPACING
    velocities = random.normal(size=places.shape)
    bodies = [
        {"type": "sphere", "radius": RADIUS, "density": 1.0, "position": place, "velocity": velocity}
        for place, velocity in zip(places.tolist(), velocities.tolist(), strict=True)
    ]
    block = steps * STEP
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "dry_spheres", "dimension": 3},
            "fluid": {"backend": "dry"},
            "domain": {"lower": [0.0] * 3, "upper": [side * SPACING] * 3},
            "body": bodies,
            "contact": {**LAWS[law], "substeps": steps},
            "time": {"end": 100 * block, "step": block},
            "output": {"every": 100 * block},
        }
    )


def measure(law: str, side: int, steps: int, repeats: int) -> dict[str, Any]:
    """Milliseconds per substep of both; the run warms up for as many steps as are then timed."""
    run = Simulation(scene(law, side, steps), None, False)
    run.step()
    ours, theirs = [], []
    with TemporaryDirectory() as folder, lammps_session() as engine:
        build(engine, run.system, kinds(run.system), Path(folder))
        engine.command(f"timestep {STEP}")
        engine.command(f"run {steps} post no")
        for _ in range(repeats):
            start = time.perf_counter()
            scheme_of(run.system).follow(run.state, run.time, run.clock.size(0), None)
            middle = time.perf_counter()
            engine.command(f"run {steps} post no")
            ours.append(1e3 * (middle - start) / steps)
            theirs.append(1e3 * (time.perf_counter() - middle) / steps)
            run.step()
    touching = int(np.sum(run.state.contacts.gap <= RANGE))
    return {
        "law": law,
        "spheres": side**3,
        "contacts": touching,
        "ours_ms": min(ours),
        "lammps_ms": min(theirs),
        "ratio": min(ours) / min(theirs),
    }


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=22)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    rows = [measure(law, arguments.side, arguments.steps, arguments.repeats) for law in LAWS]
    for row in rows:
        print(
            "  ".join(
                f"{key} {value:.3g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()
            )
        )
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
