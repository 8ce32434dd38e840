"""Dry scenes of a few balls, made on the spot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene


def ball(position: Sequence[float], velocity: Sequence[float], **keys: Any) -> dict[str, Any]:
    """A ball of radius 0.1 and density 1, unless ``keys`` say otherwise."""
    table = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": list(position), "velocity": list(velocity)}
    return table | keys


def dry_scene(
    contact: dict[str, Any],
    *bodies: dict[str, Any],
    end: float,
    step: float,
    gravity: Sequence[float] | None = None,
    upper: Sequence[float] | None = None,
) -> Scene:
    """Bodies in a box from the origin to ``upper``, of side 1 if not given."""
    dimension = len(bodies[0]["position"])
    fluid: dict[str, Any] = {"backend": "dry"}
    if gravity is not None:
        fluid["gravity"] = list(gravity)
    return scene_from_dict(
        {
            "scene": {"name": "dry", "dimension": dimension},
            "fluid": fluid,
            "domain": {"lower": [0.0] * dimension, "upper": list(upper or [1.0] * dimension)},
            "body": list(bodies),
            "contact": contact,
            "time": {"end": end, "step": step},
            "output": {"every": end},
        }
    )


def sphere_gas(steps: int, step: float = 1e-4) -> Scene:
    """200 spheres of three radii and two densities that fly about in a box of side 1, by the law `centre`."""
    random = np.random.default_rng(3)
    places = (np.stack(np.meshgrid(*[np.arange(6)] * 3), axis=-1).reshape(-1, 3) + 0.5) / 6.0
    places = random.permutation(places)[:200] + random.uniform(-0.01, 0.01, (200, 3))
    velocities = random.normal(size=places.shape)
    spheres = [
        ball(place, velocity, radius=0.04 + 0.01 * (number % 3), density=1.0 + number % 2)
        for number, (place, velocity) in enumerate(zip(places.tolist(), velocities.tolist(), strict=True))
    ]
    return dry_scene({"law": "centre", "range": 0.01, "epsilon": 2e-6}, *spheres, end=steps * step, step=step)
