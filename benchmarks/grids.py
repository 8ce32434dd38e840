"""Balls in a box of side 1, so many of them near each other and near the walls as in the paper's Tables 2 and 3.

The paper gives the counts, not the places. In 2D the counts of n × n disks, 2n(n - 5), are those of a grid with n - 5
narrow gaps in each row and column. In 3D the 70 pairs of 125 balls are those of rows with three narrow gaps, two in the
last layer.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.types import Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.domains.box import Box, BoxOptions

RANGE = 0.03
"""Range of the contact force [length]."""

NEAR = 0.2 * RANGE
"""Width of a narrow gap, and of those to the walls [length]."""

FILLED = {2: 0.6, 3: 0.6}
"""Part of a row that the balls fill."""


def balls_in_a_box(dimension: int, count: int) -> tuple[list[Sphere], Pose, Box, tuple[Wall, ...]]:
    """Build a grid of ``count`` (a square, or a cube) balls, their pose, the unit box and its walls."""
    side = round(count ** (1 / dimension))
    radius = FILLED[dimension] / (2 * max(side, 4))
    centres = np.array([[0.5] * (dimension - 1) + [radius + NEAR]]) if side == 1 else _grid(dimension, side, radius)
    upright = np.eye(1, 1 if dimension == 2 else 4) * (dimension == 3)
    balls = [Sphere(SphereOptions(radius=radius), dimension)] * count
    box = Box(BoxOptions(lower=(0.0,) * dimension, upper=(1.0,) * dimension), dimension)
    return balls, Pose(centres, np.tile(upright, (count, 1))), box, surfaces_of(box, count)


def _grid(dimension: int, side: int, radius: float) -> FloatArray:
    if dimension == 2:
        row = _row(side, radius, narrow=max(side - 5, 0))
        return np.array([[x, y] for y in row for x in row])
    wide = _row(side, radius, narrow=0)
    rows = [_row(side, radius, narrow=0 if side < 5 else 3 - (layer == side - 1)) for layer in range(side)]
    return np.array([[x, y, z] for z, row in zip(wide, rows, strict=True) for y in wide for x in row])


def _row(side: int, radius: float, narrow: int) -> FloatArray:
    """Centres along a row from wall to wall, the narrow gaps first."""
    wide = (1.0 - 2 * NEAR - 2 * radius * side - NEAR * narrow) / (side - 1 - narrow)
    gaps = np.array([NEAR] * narrow + [wide] * (side - 1 - narrow))
    return NEAR + radius + np.append(0.0, np.cumsum(gaps + 2 * radius))
