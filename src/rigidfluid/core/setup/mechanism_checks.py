"""Refuses mechanisms whose components share a name."""

from __future__ import annotations

from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.errors import PluginError


def refuse_invalid(mechanism: Mechanism, at: str) -> None:
    """Raise PluginError for what is an error of the mechanism's author; ``at`` is its place in the scene."""
    names = [component.name for component in mechanism.components]
    if len(set(names)) < len(names):
        remedy = "Mend the mechanism; MechanismContract in rigidfluid.testing shows more."
        raise PluginError(at, f"components named {names}", "components, each with a name of its own", remedy)
    mechanism.placement(0.0), mechanism.rate(0.0)  # refuse themselves what cannot be
