"""Quantities of keys, in so many dimensions."""

from __future__ import annotations

import re


def described_quantity(description: str) -> str:
    """Quantity at the end of a key's description, "length" of "Radius of the ball [length]"; empty without one."""
    found = re.search(r"\[([^\]]+)\]$", description)
    return found[1] if found else ""


def plain_quantity(quantity: str, dimension: int) -> str:
    """A quantity without powers of the dimension d: "mass/area" for "mass/length^d" in 2D."""
    volume, surface, rest = {2: ("area", "length", ""), 3: ("area·length", "area", "/length")}[dimension]
    plain = quantity.replace("time²", "time·time").replace("length^(d-1)", surface)
    return plain.replace("·length^(2-d)", rest).replace("length^d", volume).replace("volume", volume)
