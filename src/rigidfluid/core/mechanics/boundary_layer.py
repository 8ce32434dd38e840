"""Thickness of the boundary layers on bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.shapes import equal_volume_radius, shape_key
from rigidfluid.core.model.body import Body

CELLS_WANTED = 2.0
"""Cells across a layer with which forces and torques change by about a tenth at a new mesh."""


Viscosity = Callable[[FloatArray], FloatArray]
"""A fluid's viscosity over its density, (n,) of shear rates (n,) [length²/time]."""


def boundary_layers(bodies: Sequence[Body], speeds: FloatArray, kinematic_viscosity: Viscosity) -> FloatArray:
    """Thickness d/√Re of the layers on bodies (n,), d the diameter of the ball of equal volume, Re = d v/ν with ν at
    the shear rate v/d, infinite for a body at rest [length]."""
    shapes = {shape_key(body): body for body in bodies}
    known = {key: 2.0 * equal_volume_radius(body) for key, body in shapes.items()}
    diameter = np.array([known[shape_key(body)] for body in bodies])
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(kinematic_viscosity(speeds / diameter) * diameter / speeds))
