"""Sums of contact forces, and of their moments, over the bodies."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from numba import njit


@njit(cache=True)
def accumulate(force, torque, position, body_a, point_a, body_b, point_b, shift, force_on_a):
    """Add +F at a, then -F at b, in the order of the contacts, so that a sum does not depend on how it is made.

    The image of b that is met is displaced by ``shift`` (m, d) from b, None for zero.
    """
    for side in range(2):
        sign = 1.0 if side == 0 else -1.0
        for i in range(len(body_a)):
            body = body_a[i] if side == 0 else body_b[i]
            if body >= len(position):
                continue
            x = 0.5 * (point_a[i, 0] + point_b[i, 0]) - position[body, 0]
            y = 0.5 * (point_a[i, 1] + point_b[i, 1]) - position[body, 1]
            if shift is not None and side == 1:
                x -= shift[i, 0]
                y -= shift[i, 1]
            u, v = sign * force_on_a[i, 0], sign * force_on_a[i, 1]
            force[body, 0] += u
            force[body, 1] += v
            turning = x * v - y * u
            if position.shape[1] == 2:
                torque[body, 0] += turning
            else:
                z, w = 0.5 * (point_a[i, 2] + point_b[i, 2]) - position[body, 2], sign * force_on_a[i, 2]
                if shift is not None and side == 1:
                    z -= shift[i, 2]
                force[body, 2] += w
                torque[body, 0] += y * w - z * v
                torque[body, 1] += z * u - x * w
                torque[body, 2] += turning


@njit(cache=True)
def accumulate_couples(torque, body_a, body_b, couple_on_a):
    """Add +C at a, then -C at b, in the order of the contacts."""
    for side in range(2):
        sign = 1.0 if side == 0 else -1.0
        for i in range(len(body_a)):
            body = body_a[i] if side == 0 else body_b[i]
            if body < len(torque):
                for k in range(torque.shape[1]):
                    torque[body, k] += sign * couple_on_a[i, k]
