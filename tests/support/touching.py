"""One contact of two surfaces, made on the spot, and what it must hold."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts, Loads

NORMAL = np.array([[0.6, 0.8]])


def contact(gap: float, radius_a: float = np.nan, radius_b: float = np.nan, dimension: int = 2) -> Contacts:
    """Body 0 on body 1, or on surface 2 where ``radius_b`` is infinite."""
    normal = np.hstack([NORMAL, np.zeros((1, dimension - 2))])
    return Contacts(
        body_a=np.array([0]),
        body_b=np.array([2 if np.isinf(radius_b) else 1]),
        point_a=gap * normal,
        point_b=np.zeros((1, dimension)),
        normal=normal,
        gap=np.array([gap]),
        radius_a=np.array([radius_a]),
        radius_b=np.array([radius_b]),
        at_wall=np.array([np.isinf(radius_b)]),
    )


def unstacked(mass: FloatArray, weight: FloatArray, speed: FloatArray, smallest_gap: float) -> Loads:
    """Of bodies that never come to lie on each other; those without finite mass have a given twist."""
    free = np.isfinite(mass)
    energy = 0.5 * np.where(free, mass, 0.0) * speed**2
    stacked_weight, stacked_energy = np.where(free, [weight, energy], np.inf)
    return Loads(mass, weight, speed, stacked_weight, stacked_energy, smallest_gap)
