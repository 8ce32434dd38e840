"""Numbers that tell images of one body from each other."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.model.types import Contacts


def image_codes(contacts: Contacts, lattice: Lattice) -> tuple[IntArray, int]:
    """A number (m,) for each contact's image, different for any two images of a body that are less than eight cells
    apart, and the number of such numbers."""
    codes, count = np.zeros(len(contacts), dtype=np.int64), 1
    if contacts.shift is None:
        return codes, count
    for along in np.rint(lattice.components(contacts.shift)).astype(np.int64).T:
        codes, count = 8 * codes + along % 8, 8 * count
    return codes, count
