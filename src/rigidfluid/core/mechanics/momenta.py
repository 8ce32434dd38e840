"""Momenta of many bodies, changed in place by a compiled loop."""

from __future__ import annotations

from numba import njit


@njit(cache=True)
def add_kick(velocity, momentum, force, torque, weight, mass, free, time):  # type: ignore[no-untyped-def]
    """Add a kick to momenta in place, as fresh arrays of many bodies would cost more than the sums."""
    for body in range(len(velocity)):
        if free[body]:
            share = time / mass[body]
            for k in range(velocity.shape[1]):
                velocity[body, k] += share * (force[body, k] + weight[body, k])
            for k in range(momentum.shape[1]):
                momentum[body, k] += time * torque[body, k]
