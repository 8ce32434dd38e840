"""The unit in which meshers and Open CASCADE are given lengths: they have tolerances of their own, such as 1e-7."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

LONGEST = 8.0
"""Longest side of what they are given; from 4 to 16 Netgen makes the same meshes in the plane."""

FINENESS = 2.0**36
"""Steps in a unit to which lengths are rounded: what differs by the rounding of another system of units is the same."""


def mesher_unit(size: FloatArray) -> float:
    """The length that is 1 for meshers, from the sides (d,) of the box around what they mesh [length]."""
    return float(np.max(size)) / LONGEST


def in_unit(lengths: FloatArray | float, unit: float) -> FloatArray:
    """Lengths or coordinates over a ``unit``, rounded, of the same shape [1]."""
    return np.asarray(np.round(np.asarray(lengths) / unit * FINENESS) / FINENESS)


def significant(values: FloatArray) -> FloatArray:
    """Positive values rounded to 24 binary digits."""
    fraction, exponent = np.frexp(values)
    return np.asarray(np.ldexp(np.round(fraction * 2.0**24), exponent - 24))


def in_space(vector: FloatArray) -> list[float]:
    """Three components: those of ``vector``, then zeros."""
    return [*map(float, vector), *[0.0] * (3 - len(vector))]
