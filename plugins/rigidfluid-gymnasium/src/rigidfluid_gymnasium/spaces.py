"""Spaces of actions and observations."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import numpy as np
from gymnasium.spaces import Box

from rigidfluid.api import ArgumentError, FloatArray
from rigidfluid_gymnasium.actions import Action
from rigidfluid_gymnasium.observations import Observation


class ActionSpace:
    """Space of several ``actions`` in so many dimensions: a ``box`` from -1 to 1, an entry for each component that is
    not constant. Raises ArgumentError where bounds are none."""

    def __init__(self, actions: Sequence[Action], dimension: int) -> None:
        limits = [action.limits(dimension) for action in actions]
        self._cuts = _cuts([low for low, _ in limits])
        self._low, self._high = (np.concatenate(each) for each in zip(*limits, strict=True))
        self._free = self._low < self._high
        self.lengths = [len(low) for low, _ in limits]
        count = int(self._free.sum())
        if count == 0:
            remedy = "Move 'low' and 'high' apart."
            raise ArgumentError("Task.actions", "constant values alone", "one that is free", remedy)
        self.box = Box(-1.0, 1.0, (count,), np.float64)

    def values(self, action: FloatArray) -> Sequence[FloatArray]:
        """Values (m,) for each of the actions; raises ArgumentError where the ``action`` is not in the space."""
        given, count = np.asarray(action, dtype=np.float64), int(self._free.sum())
        if given.shape != (count,) or not np.all(np.abs(given) <= 1.0):
            remedy = "Clip it, as by gymnasium.wrappers.ClipAction."
            raise ArgumentError("action", given.tolist(), f"{count} numbers from -1 to 1", remedy)
        share = np.zeros(len(self._free))
        share[self._free] = 0.5 * (1.0 + given)
        return np.split(self._low + share * (self._high - self._low), self._cuts)


class ObservationSpace:
    """Space of several ``observations`` in so many dimensions: a ``box`` of their bounds. Raises ArgumentError where
    bounds are none, or the same."""

    def __init__(self, observations: Sequence[Observation], dimension: int) -> None:
        self._observations = observations
        limits = [one.limits(dimension) for one in observations]
        for one, (low, high) in zip(observations, limits, strict=True):
            if np.any(low == high):
                raise ArgumentError(
                    one.label, f"'low' and 'high' at {low[low == high][0]:g}", "two bounds", "Part them."
                )
        self._cuts = _cuts([low for low, _ in limits])
        low, high = (np.concatenate(each) for each in zip(*limits, strict=True))
        self.box = Box(low, high, dtype=np.float64)

    def clipped(self, values: Sequence[FloatArray]) -> tuple[FloatArray, list[str]]:
        """Values as one array within the bounds, and the names of observations that were beyond them."""
        whole = np.concatenate(values)
        inside = np.clip(whole, self.box.low, self.box.high)
        beyond = np.split(inside != whole, self._cuts)
        return inside, [one.label for one, where in zip(self._observations, beyond, strict=True) if where.any()]


def _cuts(parts: Sequence[FloatArray]) -> list[int]:
    """Indices at which an array of these ``parts`` is cut."""
    return list(accumulate(len(part) for part in parts[:-1]))
