"""Latest solutions for loads that come again, as first guesses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Self

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

MOST = 24
"""Greatest number of solutions that are kept: those for all velocities of twelve disks."""


class KnownAnswers:
    """Latest solution (unknowns,) for each of the loads (t,) asked for, at ``MOST`` of them, the latest first.

    Bodies answer a unit impulse in the next step as in this one, to a thousandth, as fields move with the mesh.
    """

    def __init__(self, *known: tuple[FloatArray, FloatArray]) -> None:
        self._known = known

    @classmethod
    def recalled(cls, memory: Mapping[str, FloatArray]) -> Self:
        """Go on from what `memory` gave."""
        return cls(*zip(memory["loads"], memory["answers"], strict=True))

    def memory(self) -> dict[str, FloatArray]:
        """Arrays of all loads and of all solutions, one in each row."""
        return {"loads": np.array([load for load, _ in self._known]), "answers": np.array([x for _, x in self._known])}

    def guess(self, loads: FloatArray, unknowns: int) -> FloatArray:
        """Solutions (unknowns, c) for ``loads`` (t, c), zero for those that are unknown."""
        found = np.zeros((unknowns, loads.shape[1]), order="F")
        for column, load in enumerate(loads.T):
            found[:, column] = next((answer for other, answer in self._known if np.array_equal(other, load)), 0.0)
        return found

    def with_latest(self, loads: FloatArray, found: FloatArray) -> Self:
        """These and the solutions ``found`` (unknowns, c) for ``loads`` (t, c), which take the places of others."""
        latest = [(load.copy(), answer.copy()) for load, answer in zip(loads.T, found.T, strict=True)]
        others = [each for each in self._known if not any(np.array_equal(each[0], load) for load in loads.T)]
        return type(self)(*(latest + others)[:MOST])
