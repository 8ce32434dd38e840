"""Gaps at which bodies turn, by a compiled loop over the contacts."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def deepest_gaps(formula, parameters, start, radius_a, radius_b, energy, force, halvings):
    """Gaps (m,) where the energy of a formula is that given and the work of a force from ``start`` on, by halving, with
    the ``parameters`` of each contact (m, p) or of all (1, p)."""
    deepest = np.empty(len(start))
    for i in range(len(start)):
        low, high, own = 0.0, start[i], parameters[min(i, len(parameters) - 1)]
        for _ in range(halvings):
            middle = 0.5 * (low + high)
            stored = formula(own, middle, radius_a[i], radius_b[i], 1.0, 0.0, 0.0)[0]
            if stored >= energy[i] + force[i] * (start[i] - middle):
                low = middle
            else:
                high = middle
        deepest[i] = high
    return deepest
