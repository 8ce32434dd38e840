"""Pieces of a domain's boundary that are opposite to each other."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model.domain import Domain

_APART = 1e-12
"""Opposite surfaces have the same corners but for this, over the size of the domain."""


def is_opposite(domain: Domain, piece: Piece, other: Piece) -> bool:
    """Tell whether two pieces are flat, face each other, and are equal but for a displacement across them."""
    one, two = piece.shape.plane, other.shape.plane
    if one is None or two is None or not np.allclose(one.unit_normal, -two.unit_normal, rtol=0, atol=_APART):
        return False
    way = float((two.point - one.point) @ one.unit_normal) * one.unit_normal
    apart = [np.abs(b - a - way) for a, b in zip(one.bounds, two.bounds, strict=True)]
    return bool(np.all(np.nan_to_num(apart, nan=np.inf) <= _APART * np.max(domain.size)))
