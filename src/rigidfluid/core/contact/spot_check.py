"""Checks of parts, at times, for what no single answer shows."""

from __future__ import annotations

from rigidfluid.core.contact.detector_check import check_detector
from rigidfluid.core.contact.law_check import check_laws
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose


def is_due(count: int) -> bool:
    """Whether parts are checked after so many steps: at the start, and when it is a power of two. The cost is then soon
    lost in that of the steps, and a run that is taken up again checks them after the same ones."""
    return count & (count - 1) == 0


def spot_check(system: System, pose: Pose, mesh: Mesh | None) -> None:
    """Raise PluginError where the laws or the detector, if it has the ``mesh`` that it needs, are not what they should
    be."""
    check_laws(system)
    if mesh is not None or not system.detection.on_mesh:
        check_detector(system, pose, mesh)
