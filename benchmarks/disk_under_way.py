"""The falling disk under way, on meshes from 3,000 to 600,000 unknowns: what the benchmarks of a step measure."""

from __future__ import annotations

import tomllib
from pathlib import Path

import rigidfluid
from rigidfluid.core.run.simulation import Simulation

SCENE = Path(__file__).parents[1] / "scenes" / "falling_disk.toml"
# Thousands of unknowns: (size, size_body, growth) of the mesh.
MESHES = {
    3: (0.30, 0.0250, 0.350),
    15: (0.12, 0.0100, 0.150),
    45: (0.07, 0.0060, 0.093),
    150: (0.038, 0.0033, 0.0513),
    600: (0.019, 0.00165, 0.0257),
}
OUTPUT_EVERY = 20  # steps: at an output a backend says what it remembers, or forgets it
WARM_UP = 6  # steps: the first ones start the time scheme and compile


def falling(thousands: int, backend: str = "scikit-fem") -> Simulation:
    """The falling disk at about that many thousand unknowns, under way."""
    data = tomllib.loads(SCENE.read_text(encoding="utf-8"))
    size, size_body, growth = MESHES[thousands]
    data["fluid"]["backend"] = backend
    data["mesh"].update(size=size, size_body=size_body, growth=growth)
    data["time"]["step"] = 0.1 * size_body
    data["output"]["every"] = 10.0
    run = Simulation(rigidfluid.scene_from_dict(data), None, False)
    for _ in range(WARM_UP):
        run.step()
    return run
