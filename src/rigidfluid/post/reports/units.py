"""Names of units in labels: those that a scene gives its lengths, times and masses, and what is composed of them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

_BASE = ("mass", "length", "time")
_POWERS = {
    "mass": (1, 0, 0),
    "length": (0, 1, 0),
    "time": (0, 0, 1),
    "area": (0, 2, 0),
    "force": (1, 1, -2),
    "energy": (1, 2, -2),
}
"""Powers of mass, length and time in what labels speak of."""
_KEPT = "rad", "scalar"
"""Units that have no other names."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Units:
    """The ``names`` of the units of length, time and mass, None if the scene gives none, in so many dimensions."""

    names: Mapping[str, str] | None
    dimension: int

    @classmethod
    def told_in(cls, document: Mapping[str, Any]) -> Units:
        """Names in a scene's tables."""
        return cls(document["scene"].get("units"), document["scene"]["dimension"])

    @property
    def pressure(self) -> str:
        """Quantity of a pressure, in 2D a force over a length."""
        return "force/area" if self.dimension == 3 else "force/length"

    def put_into(self, text: str) -> str:
        """A text in which names stand for quantities in brackets: "[cm/s]" for "[length/time]"."""
        return text if self.names is None else re.sub(r"\[([\w·/]+)\]", self._named, text)

    def put_after_numbers(self, text: str) -> str:
        """A title with the units of its numbers: "time 0.04 s" for "time 0.04 [time]", or without names "time 0.04"."""
        named, unit = (self.put_into(text), r" \1") if self.names else (text, "")
        return re.sub(r"(?<=\d) \[([^\]]+)\]", unit, named)

    def put_into_labels(self, figure: Figure) -> Figure:
        """The same figure, with names in the labels of all its axes and in what stands in them."""
        for axes in figure.axes:
            for text in (axes.xaxis.label, axes.yaxis.label, *axes.texts):
                text.set_text(self.put_into(text.get_text()))
            axes.title.set_text(self.put_after_numbers(axes.title.get_text()))
        return figure

    def _named(self, found: re.Match[str]) -> str:
        """A quantity in brackets by names, or as it is where it is no product of known ones."""
        above, *below = found[1].split("/")
        factors = [(word, 1) for word in above.split("·") if word != "1"]
        factors += [(word, -1) for part in below for word in part.split("·")]
        if any(word not in {*_POWERS, *_KEPT} for word, _ in factors):
            return found[0]
        powers = dict.fromkeys((*_KEPT, *_BASE), 0)
        for word, sign in factors:
            for base, power in {word: 1}.items() if word in _KEPT else self._powers(word).items():
                powers[base] += sign * power
        return f"[{self._product(powers)}]"

    def _powers(self, word: str) -> dict[str, int]:
        """Powers of a quantity: in 2D a mass is one per depth, and so is all that has a mass in it."""
        powers = dict(zip(_BASE, _POWERS[word], strict=True))
        powers["length"] -= powers["mass"] * (3 - self.dimension)
        return powers

    def _product(self, powers: Mapping[str, int]) -> str:
        names = {word: word for word in _KEPT} | dict(self.names or {})
        above = [names[base] + _raised(power) for base, power in powers.items() if power > 0]
        below = [names[base] + _raised(-power) for base, power in powers.items() if power < 0]
        over = f"({'·'.join(below)})" if len(below) > 1 else "".join(below)
        return "·".join(above or "1") + (f"/{over}" if over else "")


def _raised(power: int) -> str:
    return "" if power == 1 else str(power).translate(_RAISED)
