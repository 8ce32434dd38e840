"""Bounds of numbers that an agent gives or sees."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, fields

import numpy as np

from rigidfluid.api import ArgumentError, FloatArray

Bound = float | Sequence[float]


@dataclass(frozen=True)
class Bounded(ABC):
    """Several numbers between ``low`` and ``high``, each a number for all of them or one for each."""

    low: Bound = field(kw_only=True)
    high: Bound = field(kw_only=True)

    @abstractmethod
    def length(self, dimension: int) -> int:
        """Count of the numbers in so many dimensions of space."""

    @property
    def label(self) -> str:
        """Name in messages: the class, and the values that are no bounds."""
        told = [str(getattr(self, one.name)) for one in fields(self) if one.name not in ("low", "high")]
        return f"{type(self).__name__}({', '.join(told)})"

    def limits(self, dimension: int) -> tuple[FloatArray, FloatArray]:
        """Least and greatest values (m,); raises ArgumentError where they are no such bounds."""
        low, high = (self._limit(key, dimension) for key in ("low", "high"))
        if np.any(low > high):
            found = f"{high.tolist()} below 'low', {low.tolist()}"
            raise ArgumentError(f"{self.label}.high", found, "at least as much as 'low'", "Exchange them.")
        return low, high

    def _limit(self, key: str, dimension: int) -> FloatArray:
        given, length = getattr(self, key), self.length(dimension)
        try:
            limit = np.broadcast_to(np.asarray(given, dtype=np.float64), (length,))
        except (TypeError, ValueError):
            limit = np.full(length, np.nan)
        if not np.isfinite(limit).all():
            allowed = f"a finite number, or {length} of them"
            raise ArgumentError(f"{self.label}.{key}", given, allowed, "Give a bound for each component.")
        return limit


def component_count(dimension: int) -> int:
    """Components d+k of a twist or a wrench."""
    return 3 if dimension == 2 else 6
