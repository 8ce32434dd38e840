"""Scenes of swarms in a box of side 1 without a fluid."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid import Scene, scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Pose
from rigidfluid.core.nested.placing import initial_pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.detectors.brute_force import BruteForceDetector

Table = dict[str, Any]
DISK, BALL = {"type": "sphere", "radius": 0.05}, {"type": "sphere", "radius": 0.08}
ELLIPSE = {"type": "ellipsoid", "semi_axes": [0.08, 0.04]}
ELLIPSOID = {"type": "ellipsoid", "semi_axes": [0.12, 0.08, 0.06]}
SQUARE = {"type": "polygon", "points": [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]}


def swarm_tables(dimension: int, *shapes: Table, seed: int = 0, tables: Table | None = None, **swarm: Any) -> Table:
    """Tables of a scene with one swarm of ``shapes``; ``tables`` take the place of others."""
    return {
        "scene": {"name": "swarm", "dimension": dimension, "seed": seed},
        "fluid": {"backend": "dry"},
        "domain": {"lower": [0.0] * dimension, "upper": [1.0] * dimension},
        "swarm": [{"name": "grain", "density": 2.0, "shape": list(shapes), **swarm}],
        "time": {"end": 1.0, "step": 0.01},
        "output": {"every": 1.0},
        **(tables or {}),
    }


def seeded(dimension: int, *shapes: Table, **swarm: Any) -> Scene:
    """The scene of `swarm_tables`."""
    return scene_from_dict(swarm_tables(dimension, *shapes, **swarm))


def start(scene: Scene) -> Pose:
    """Pose of all bodies."""
    return initial_pose(scene.body, scene.dimension)


def radii(scene: Scene) -> FloatArray:
    """Radii of all bodies, which are balls [length]."""
    return np.array([body.options["radius"] for body in scene.body])


def least_gap_of_balls(scene: Scene) -> float:
    """Smallest gap of balls to each other and to a box of side 1, by the formula [length]."""
    position, size = start(scene).position, radii(scene)
    apart = np.linalg.norm(position[:, None] - position, axis=2) - size - size[:, None]
    np.fill_diagonal(apart, np.inf)
    at_walls = np.minimum(position, 1.0 - position).min(axis=1) - size
    return float(min(apart.min(), at_walls.min()))


def least_gap(scene: Scene, reach: float) -> float:
    """Smallest gap of any bodies by the naive detector, the ``reach`` if all are larger [length]."""
    model = model_of(scene)
    walls = surfaces_of(model.domain, len(model.shapes))
    detector = BruteForceDetector(BruteForceDetector.Options(), model.shapes, walls)
    return float(np.min(detector.detect(start(scene), None, reach).gap, initial=reach))
