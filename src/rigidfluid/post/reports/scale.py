"""Colours of a quantity of the fluid: the same for the same value in all pictures that stand together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import AsinhNorm, Colormap, LogNorm, Normalize
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray

COLOURMAP, SIGNED_COLOURMAP, HOT_COLOURMAP = "viridis", "RdBu_r", "inferno"
Quantity = Literal["speed", "vorticity", "pressure", "scalar", "viscosity"]
QUANTITIES: tuple[Quantity, ...] = ("speed", "vorticity", "pressure")
"""Quantities that every fluid has."""


_MOST, _USUAL = 99.9, 80.0
"""Per cent of the area whose values have colours of their own, and whose values are not squeezed."""
_WEAKEST = 0.03
"""Least value from which on colours are squeezed, over the highest."""


@dataclass(frozen=True)
class Scale:
    """Range of colours of a ``quantity``, from ``lowest`` to ``highest``: even steps up to ``linear``, beyond that
    steps that grow with the value."""

    quantity: Quantity
    lowest: float
    highest: float
    linear: float

    @classmethod
    def fit(cls, quantity: Quantity, values: Sequence[FloatArray], areas: Sequence[FloatArray]) -> Scale:
        """Fit the range to values (K,), each on an area (K,).

        Speeds have even steps from zero to the highest, scalars from the lowest, viscosities equal ratios. Vorticity
        and pressure are symmetric about zero and strong, even without bound, in small places: almost all of the area
        has colours of its own, weak values among them.
        """
        size, weights = np.abs(np.concatenate(values)), np.concatenate(areas)
        if quantity == "speed":
            return cls(quantity, 0.0, float(size.max()), float(size.max()))
        if quantity in ("scalar", "viscosity"):
            lowest, highest = (float(end(np.concatenate(values))) for end in (np.min, np.max))
            return cls(quantity, lowest, highest, highest)
        usual, highest = np.percentile(size, (_USUAL, _MOST), weights=weights, method="inverted_cdf").tolist()
        return cls(quantity, -highest, highest, max(usual, _WEAKEST * highest))

    @property
    def map(self) -> Colormap:
        """Matplotlib's colours."""
        return colormaps[{"speed": COLOURMAP, "scalar": HOT_COLOURMAP}.get(self.quantity, SIGNED_COLOURMAP)]

    @property
    def norm(self) -> Normalize:
        """Share of the range that a value is at."""
        if self.quantity == "viscosity":
            return LogNorm(self.lowest, self.highest)
        if self.lowest == 0.0 or self.linear == self.highest:
            return Normalize(self.lowest, self.highest or 1.0)
        return AsinhNorm(self.linear, self.lowest, self.highest)

    def colours(self, values: FloatArray) -> FloatArray:
        """RGB (…, 3) of values (…)."""
        return np.asarray(self.map(self.norm(values)))[..., :3]

    def draw_bar(self, figure: Figure, panels: Sequence[Axes], dimension: int) -> None:
        """Draw the colour bar next to the panels."""
        extend = "both" if self.lowest < 0.0 else "max"
        area = "area" if dimension == 3 else "length"
        unit = {
            "speed": "length/time",
            "vorticity": "1/time",
            "pressure": f"force/{area}",
            "viscosity": f"force·time/{area}",
        }.get(self.quantity)
        label = self.quantity if unit is None else f"{self.quantity} [{unit}]"
        colours = ScalarMappable(self.norm, self.map)
        bar = figure.colorbar(colours, ax=list(panels), label=label, shrink=0.8, extend=extend)
        if isinstance(self.norm, AsinhNorm):
            ends = [_rounded(value) for value in self.norm.inverse(np.array([0.75, 0.98])).tolist()]
            ticks = [-value for value in reversed(ends)] + [0.0, *ends]
            bar.set_ticks(ticks, labels=[f"{value:g}".replace("-", "\N{MINUS SIGN}") for value in ticks], minor=False)
            bar.minorticks_off()


def _rounded(value: float) -> float:
    """A positive value cut off after one digit."""
    unit = 10.0 ** np.floor(np.log10(value))
    return float(f"{np.floor(value / unit + 1e-9) * unit:.0e}")
