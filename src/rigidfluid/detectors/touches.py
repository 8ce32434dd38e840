"""Places at which pairs of surfaces are near each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray


class Touches(NamedTuple):
    """Places of some pairs a, b: the row ``pair`` (m,) of each, ``point_a``, ``point_b``, ``normal`` (m, d) from b to
    a, ``gap`` (m,), and the ``sign`` (m,) with which they count."""

    pair: IntArray
    point_a: FloatArray
    point_b: FloatArray
    normal: FloatArray
    gap: FloatArray
    sign: FloatArray

    def select(self, chosen: BoolArray | IntArray) -> Touches:
        """Places that are ``chosen``, by truth values (m,) or by rows."""
        vectors = self.point_a[chosen], self.point_b[chosen], self.normal[chosen]
        return Touches(self.pair[chosen], *vectors, self.gap[chosen], self.sign[chosen])

    def turned(self, turned: BoolArray) -> Touches:
        """The same places, a and b exchanged in those that are ``turned`` (m,)."""
        swap = turned[:, None]
        point_a, point_b = np.where(swap, self.point_b, self.point_a), np.where(swap, self.point_a, self.point_b)
        return Touches(self.pair, point_a, point_b, np.where(swap, -self.normal, self.normal), self.gap, self.sign)


def all_touches(parts: Sequence[Touches], dimension: int) -> Touches:
    """Places of all parts, one after the other."""
    vectors = np.empty((0, dimension))
    none = Touches(np.empty(0, dtype=np.int64), vectors, vectors, vectors, np.empty(0), np.empty(0))
    return Touches(*(np.concatenate(each) for each in zip(none, *parts, strict=True)))
