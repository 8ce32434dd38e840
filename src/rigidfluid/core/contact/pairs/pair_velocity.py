"""Relative velocities of the surfaces in many contacts, by a compiled loop."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def relative_velocities(position, velocity, spin, body_a, point_a, body_b, point_b, shift):
    """Velocity (m, d) of a relative to b half-way between the contact points [length/time]; walls are at rest.

    The image of b that is met is displaced by ``shift`` (m, d) from b, None for zero.
    """
    count, dimension = point_a.shape
    relative, arm = np.empty((count, dimension)), np.empty(dimension)
    for i in range(count):
        for side in range(2):
            body = body_a[i] if side == 0 else body_b[i]
            if body >= len(position):
                continue
            for k in range(dimension):
                arm[k] = 0.5 * (point_a[i, k] + point_b[i, k]) - position[body, k]
                if shift is not None and side == 1:
                    arm[k] -= shift[i, k]
            for k in range(dimension):
                if dimension == 2:
                    turning = -spin[body, 0] * arm[1] if k == 0 else spin[body, 0] * arm[0]
                else:
                    next_axis, last = (k + 1) % 3, (k + 2) % 3
                    turning = spin[body, next_axis] * arm[last] - spin[body, last] * arm[next_axis]
                own = velocity[body, k] + turning
                relative[i, k] = own if side == 0 else relative[i, k] - own
    return relative
