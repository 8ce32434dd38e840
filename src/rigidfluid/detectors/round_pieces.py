"""Round pieces of a domain's boundary without ends that a body could meet."""

from __future__ import annotations

from math import pi

from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.wall import is_round, radius_of

_ROUNDING = 1e-6
"""Relative error of a surface's area."""


def is_whole(piece: Piece) -> bool:
    """Tell whether a piece is a round bump, or the whole of a round hollow."""
    if not is_round(piece.shape):
        return False
    radius, dimension = radius_of(piece.shape), len(piece.shape.bounds[0])
    whole = 2.0 * pi * abs(radius) if dimension == 2 else 4.0 * pi * radius**2
    return radius > 0 or piece.area > (1.0 - _ROUNDING) * whole
