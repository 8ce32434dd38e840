"""Changes of gaps in a step of a fluid: its mesh follows them so far."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps, least_gaps, travel
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.errors import StepRejected

CLOSEST_APPROACH = 0.7
"""A step may close a gap to this fraction of it, no further: the mesh follows, and the film's resistance grows."""

WIDEST_OPENING = 1.5
"""A step may open a gap within the range of the law to so many times it: a film of fluid is as heavy as it is thin."""


def change_too_fast(system: System, state: State, pose: Pose, mesh_at: Callable[[Pose], Mesh]) -> bool:
    """Tell whether the mesh in a gap would be squeezed, or a film opened, by more than a step to ``pose`` can follow.

    ``mesh_at(pose)`` is the mesh there; gaps change too fast where it raises StepRejected.
    """
    moved = travel(system, state.pose, pose)
    before = least_gaps(system, state.pose, state.gaps)
    if np.all(moved + moved.max(initial=0.0) <= (1.0 - CLOSEST_APPROACH) * before):
        return False  # too far away for that: no need to measure
    try:
        mesh = system.detection.mesh_at(pose, mesh_at)
    except StepRejected:
        return True
    _, gaps = detect_contacts_and_gaps(system, pose, mesh)
    opens = (state.gaps < system.law_range) & (gaps > WIDEST_OPENING * state.gaps)
    return bool((gaps < CLOSEST_APPROACH * before).any() or opens.any())
