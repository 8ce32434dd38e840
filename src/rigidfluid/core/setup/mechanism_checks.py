"""Refuses mechanisms whose components or placements cannot be."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.interfaces import Mechanism
from rigidfluid.errors import PluginError

_ROUNDING = 1e-9


def refuse_invalid(mechanism: Mechanism, at: str) -> None:
    """Raise PluginError for what is an error of the mechanism's author; ``at`` is its place in the scene."""
    _refuse_components(mechanism, at)
    _refuse_placement(mechanism, at)


def _refuse_components(mechanism: Mechanism, at: str) -> None:
    """Names and densities that cannot be are an error of the mechanism's author."""
    names = [component.name for component in mechanism.components]
    densities = [component.density for component in mechanism.components]
    if not names or len(set(names)) < len(names):
        raise _plugin_error(at, f"components named {names}", "components, each with a name of its own")
    if not all(0.0 < density < np.inf for density in densities):
        raise _plugin_error(at, f"components of densities {densities}", "numbers above 0")


def _refuse_placement(mechanism: Mechanism, at: str) -> None:
    """Raise PluginError for a placement of a wrong shape, and for a rate of components that are not driven."""
    count, d = len(mechanism.components), mechanism.dimension
    k, q = (1, 1) if d == 2 else (3, 4)
    pose, rate = mechanism.placement(0.0), mechanism.rate(0.0)
    for name, values, width in (
        ("placement(0).position", pose.position, d),
        ("placement(0).orientation", pose.orientation, q),
        ("rate(0).velocity", rate.velocity, d),
        ("rate(0).angular_velocity", rate.angular_velocity, k),
    ):
        if np.shape(values) != (count, width) or not np.isfinite(values).all():
            allowed = f"finite numbers of shape {(count, width)}, a row for each component"
            raise _plugin_error(at, f"{name} of shape {np.shape(values)}", allowed)
    if d == 3 and np.abs(np.linalg.norm(pose.orientation, axis=1) - 1.0).max() > _ROUNDING:
        raise _plugin_error(at, f"quaternions {pose.orientation.tolist()}", "quaternions of length 1")
    if not mechanism.driven and (rate.velocity.any() or rate.angular_velocity.any()):
        raise _plugin_error(at, "a rate of what is not driven", "`driven = True` together with `rate`")


def _plugin_error(at: str, found: str, allowed: str) -> PluginError:
    return PluginError(at, found, allowed, "Mend the mechanism; MechanismContract in rigidfluid.testing shows more.")
