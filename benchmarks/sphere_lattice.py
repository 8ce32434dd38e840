"""Scene of dry spheres in a box, which move at random from a lattice and collide."""

from __future__ import annotations

from typing import Any

import numpy as np

import rigidfluid

RADIUS, SPACING, RANGE, STEP = 0.4, 1.0, 0.05, 1e-3
LAWS: dict[str, dict[str, Any]] = {
    "centre": {"law": "centre", "range": RANGE, "epsilon": 1e-6},
    "spring-dashpot": {"law": "spring-dashpot", "range": RANGE, "stiffness": 1e4, "restitution": 0.9},
}


def dry_spheres(law: str, side: int, steps: int) -> rigidfluid.Scene:
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
