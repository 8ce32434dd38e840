"""A plate with round edges, and a hub that flaps one or two of them."""

from __future__ import annotations

from rigidfluid.api import Body, Mechanism, hookimpl
from rigidfluid_flapping.mechanism import FlappingPlate
from rigidfluid_flapping.plate import Plate


@hookimpl
def rigidfluid_bodies() -> list[type[Body]]:
    """The body type "plate"."""
    return [Plate]


@hookimpl
def rigidfluid_mechanisms() -> list[type[Mechanism]]:
    """The mechanism "flapping_plate"."""
    return [FlappingPlate]
