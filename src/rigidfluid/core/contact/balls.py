"""What laws of curved surfaces ask of contacts: that the radii are known."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import Contacts
from rigidfluid.errors import SceneError


def require_balls(contacts: Contacts, law: str) -> None:
    """Refuse surfaces whose radius is not known.

    Parameters
    ----------
    contacts : Contacts
        The m contacts.
    law : str
        Name of the law that needs the radii.

    Raises
    ------
    SceneError
        At the first contact of a surface that is neither round nor flat.
    """
    unknown = np.isnan(contacts.radius_a) | np.isnan(contacts.radius_b)
    if not np.any(unknown):
        return
    first = int(np.argmax(unknown))
    raise SceneError(
        "contact.law",
        f'"{law}" with surfaces {contacts.body_a[first]} and {contacts.body_b[first]}, not both round',
        f"balls, and flat or round walls, because the {law} law needs balls",
        "Use a law of the gap alone for these shapes.",
    )
