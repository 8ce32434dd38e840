"""Means of correlated values, with their standard errors by blocks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

FEWEST = 8
"""Fewest blocks that give an error."""


class Mean(NamedTuple):
    """A mean over time and its standard error, not a number with fewer than eight states."""

    value: FloatArray
    error: FloatArray

    def to_list(self) -> list[object]:
        """Value and error, None for what is unknown."""
        return [known(self.value), known(self.error)]


def mean(values: FloatArray) -> Mean:
    """Mean of ``values`` (s, …) over the first axis, and its greatest standard error over blocks of 1, 2, 4, … states.

    Blocks longer than the correlation are independent, and the error no longer grows with their length.

    Notes
    -----
    Flyvbjerg & Petersen, J. Chem. Phys. 91 (1989) 461, doi:10.1063/1.457480.
    """
    values = np.asarray(values, dtype=float)
    error, blocks = np.full(values.shape[1:], np.nan), values
    while len(blocks) >= FEWEST:
        error = np.fmax(error, blocks.std(axis=0, ddof=1) / np.sqrt(len(blocks)))
        even = len(blocks) // 2 * 2
        blocks = 0.5 * (blocks[0:even:2] + blocks[1:even:2])
    return Mean(values.mean(axis=0), error)


def known(values: FloatArray) -> object:
    """Numbers as lists, None for those that are none."""
    told = np.asarray(values, dtype=object)
    told[~np.isfinite(values)] = None
    return told.tolist()
