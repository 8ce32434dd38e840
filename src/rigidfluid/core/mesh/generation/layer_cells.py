"""Number of cells across the boundary layers on bodies, and the least that forces need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.boundary_layer import Viscosity, boundary_layers
from rigidfluid.core.mechanics.shapes import equal_volume_radius, shape_key
from rigidfluid.core.mesh.generation.made_size import facet_edge
from rigidfluid.core.model.body import Body

FEWEST_CELLS = 0.95
"""Fewest cells across a layer: with fewer a torque was eight times as large, or of the other sign, for some twenty
steps after each new mesh."""


class ThinnestLayer(NamedTuple):
    """The layer with the fewest ``cells`` across, that of the ``body`` of this number: its ``thickness`` [length], and
    the Reynolds number."""

    body: int
    thickness: float
    cells: float
    reynolds: float


def thinnest_layer(
    bodies: Sequence[Body], speeds: FloatArray, kinematic_viscosity: Viscosity, size_body: float
) -> ThinnestLayer | None:
    """Boundary layer with the fewest cells of the mean edge on its body; None where nothing moves.

    ``speeds`` (n,) are those between body and fluid [length/time], ``size_body`` is the longest edge on bodies
    [length].
    """
    if not np.any(speeds > 0.0):
        return None
    layers = boundary_layers(bodies, speeds, kinematic_viscosity)
    shapes = {shape_key(body): body for body in bodies}
    edges = {key: facet_edge(body, size_body) for key, body in shapes.items()}
    cells = layers / np.array([edges[shape_key(body)] for body in bodies])
    worst = int(np.argmin(cells))
    reynolds = (2.0 * equal_volume_radius(bodies[worst]) / layers[worst]) ** 2
    return ThinnestLayer(worst, float(layers[worst]), float(cells[worst]), float(reynolds))
