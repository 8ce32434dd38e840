"""Precondition of laws of curved surfaces: contacts with known radii."""

from __future__ import annotations

import math

import numpy as np

from rigidfluid.core.model.types import Contacts
from rigidfluid.errors import SceneError


def require_balls(contacts: Contacts, law: str) -> None:
    """Raise SceneError at the first contact of a surface that is neither round nor flat; ``law`` is the name of the
    law."""
    if not (math.isnan(contacts.radius_a.sum()) or math.isnan(contacts.radius_b.sum())):
        return
    unknown = np.isnan(contacts.radius_a) | np.isnan(contacts.radius_b)
    if not unknown.any():
        return
    first = int(np.argmax(unknown))
    raise SceneError(
        "contact.law",
        f'"{law}" with surfaces {contacts.body_a[first]} and {contacts.body_b[first]}, not both round',
        f"balls, and flat or round walls, because the {law} law needs balls",
        "Use a law of the gap alone for these shapes.",
    )
