"""The cheapest detector that is exact for the shapes of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from rigidfluid.core.contact.path.detection import detection_by
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.errors import PluginError
from rigidfluid.registry import DETECTOR, Registry


def choose_detector(
    bodies: Sequence[Body], pieces: Sequence[Piece], mesh: bool, registry: Registry
) -> tuple[type[Detector], str]:
    """Cheapest installed detector that is exact for ``bodies`` between ``pieces``, and why it is chosen, in words.

    Without ``mesh`` none that needs one is asked, and none is chosen that fails when it is. The built-in `brute_force`
    takes all shapes.
    """
    reasons = {}
    for part in registry.installed(DETECTOR):
        with suppress(PluginError):  # it stops those who name it
            if (mesh or not detection_by(part).on_mesh) and (reason := part.exact_for(bodies, pieces)):
                reasons[part] = reason
    cheapest = min(reasons, key=lambda part: part.cost)
    return cheapest, f"chosen as {reasons[cheapest]}"


def exact_detector(bodies: Sequence[Body], pieces: Sequence[Piece], registry: Registry) -> type[Detector]:
    """Cheapest detector that is exact for these bodies between these pieces and needs no mesh."""
    return choose_detector(bodies, pieces, False, registry)[0]
