"""The mechanisms that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.hookspecs import hookimpl
from rigidfluid.mechanisms.articulated import Articulated
from rigidfluid.mechanisms.three_sphere_swimmer import ThreeSphereSwimmer


@hookimpl
def rigidfluid_mechanisms() -> list[type[Mechanism]]:
    """The built-in mechanisms."""
    return [Articulated, ThreeSphereSwimmer]
