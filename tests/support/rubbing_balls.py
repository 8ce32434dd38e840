"""Two balls that hit each other off centre, with springs along their surfaces, and balls that friction hardly turns."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

from dry_scenes import ball, dry_scene

from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.scene.scene import Scene

RANGE = 0.02
SPRING = {"law": "spring-dashpot", "range": RANGE, "stiffness": 1e5}
TANGENTIAL_STIFFNESS = 2.86e4
STICKS_AND_SLIPS = {"stick": 10.0, "both": 0.3, "slip": 0.05}
"""Coefficients of friction at which surfaces stick, stick and slip, or slip all the time."""


def oblique_hit(dimension: int, **keys: float) -> Scene:
    """Two balls of unequal weight, whose law `spring-dashpot` has further ``keys``."""
    still = [0.0] * (dimension - 2)
    left = ball([0.35, 0.5, *(0.5 + part for part in still)], [10.0, 0.0, *still])
    right = ball([0.65, 0.58, *(0.5 + part for part in still)], [-10.0, 0.0, *still], density=2.0)
    return dry_scene(SPRING | keys, left, right, end=0.012, step=1e-5)


@contextmanager
def hard_to_turn() -> Iterator[None]:
    """Give all balls a billion times their inertia, so that the arm at which friction acts is of no account."""
    usual = Sphere.unit_inertia
    with patch.object(Sphere, "unit_inertia", property(lambda sphere: 1e9 * usual.__get__(sphere))):
        yield
