"""Checks of parts, at times, for what no single answer shows."""

from __future__ import annotations

from rigidfluid.core.contact.laws.law_check import check_laws
from rigidfluid.core.contact.pairs.detector_check import check_detector
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose

_EARLY = {1, 2, 4, 8, 16, 32, 64}
_EVERY = 128
"""Numbers of steps after which parts are checked: a check takes as long as two or three dry steps of few bodies."""


def is_due(count: int) -> bool:
    """Tell whether parts are checked after so many steps, besides the start: after the same ones where a run is
    resumed."""
    return count in _EARLY or count % _EVERY == 0


def spot_check(system: System, pose: Pose, mesh: Mesh | None, count: int) -> None:
    """Raise PluginError where the laws are not what they should be, or after ``count`` steps the detector, if it has
    the ``mesh`` that it needs."""
    check_laws(system)
    if mesh is not None or not system.detection.on_mesh:
        check_detector(system, pose, mesh, count)
