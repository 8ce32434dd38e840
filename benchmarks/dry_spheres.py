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
from sphere_lattice import LAWS, RANGE, STEP, dry_spheres

from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.run.simulation import Simulation
from rigidfluid_lammps.kinds import kinds
from rigidfluid_lammps.library import lammps_session
from rigidfluid_lammps.theirs import build


def measure(law: str, side: int, steps: int, repeats: int) -> dict[str, Any]:
    """Milliseconds per substep of both; the run warms up for as many steps as are then timed."""
    run = Simulation(dry_spheres(law, side, steps), None, False)
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
