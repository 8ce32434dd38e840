"""A function by cubics between nodes, from its values and slopes there."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray


class PiecewiseCubic:
    """Cubic between each two of the increasing ``nodes`` (n,), with these ``values`` and ``slopes`` (n,) there.

    Each cubic has four ``terms`` (n-1, 4) in the distance from ``starts`` (n-1,); they meet at ``inner`` (n-2,). The
    `CubicHermiteSpline` of SciPy is the same, but takes a tenth of a second to load.
    """

    def __init__(self, nodes: FloatArray, values: FloatArray, slopes: FloatArray) -> None:
        width, rise = np.diff(nodes), np.diff(values) / np.diff(nodes)
        bend = (3.0 * rise - 2.0 * slopes[:-1] - slopes[1:]) / width
        twist = (slopes[:-1] + slopes[1:] - 2.0 * rise) / width**2
        self.starts, self.inner = nodes[:-1], nodes[1:-1]
        self.terms = np.column_stack([values[:-1], slopes[:-1], bend, twist])

    def __call__(self, places: FloatArray) -> FloatArray:
        """Values at ``places`` (m,), beyond the ends those of the last cubics."""
        cubic = self.inner.searchsorted(places, side="right")
        beyond = places - self.starts[cubic]
        value, slope, bend, twist = self.terms[cubic].T
        return np.asarray(value + beyond * (slope + beyond * (bend + beyond * twist)))
