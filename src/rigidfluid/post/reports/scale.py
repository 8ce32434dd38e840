"""Colours of a quantity of the fluid: the same for the same value in all pictures that stand together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray

COLOURMAP, SIGNED_COLOURMAP = "viridis", "RdBu_r"
Quantity = Literal["speed", "vorticity", "pressure"]


@dataclass(frozen=True)
class Scale:
    """Range of colours of a ``quantity``, from ``lowest`` to ``highest``."""

    quantity: Quantity
    lowest: float
    highest: float

    @classmethod
    def fit(cls, quantity: Quantity, values: Sequence[FloatArray], percent: float) -> Scale:
        """Fit the range to so many per cent of the finite values; from zero for the speed, else symmetric about it."""
        known = np.concatenate([one[np.isfinite(one)] for one in values] or [np.zeros(0)])
        highest = float(np.percentile(np.abs(known), percent)) if known.size else 0.0
        return cls(quantity, 0.0 if quantity == "speed" else -highest, highest)

    @property
    def map(self) -> Colormap:
        """Matplotlib's colours."""
        return colormaps[COLOURMAP if self.quantity == "speed" else SIGNED_COLOURMAP]

    @property
    def norm(self) -> Normalize:
        """Share of the range that a value is at."""
        return Normalize(self.lowest, self.highest or 1.0)

    def colours(self, values: FloatArray) -> FloatArray:
        """RGB (…, 3) of values (…)."""
        return np.asarray(self.map(self.norm(values)))[..., :3]

    def draw_bar(self, figure: Figure, panels: Sequence[Axes], dimension: int, *, exceeded: bool = False) -> None:
        """Draw the colour bar next to the panels; whether the highest are ``exceeded`` is said for speeds alone."""
        extend = "both" if self.lowest < 0.0 else "max" if exceeded else "neither"
        area = "force/area" if dimension == 3 else "force/length"
        unit = {"speed": "length/time", "vorticity": "1/time", "pressure": area}[self.quantity]
        label = f"{self.quantity} [{unit}]"
        figure.colorbar(ScalarMappable(self.norm, self.map), ax=list(panels), label=label, shrink=0.8, extend=extend)
