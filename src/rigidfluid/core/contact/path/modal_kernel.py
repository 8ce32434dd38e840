"""Velocity Verlet substeps of balls that a reduced model moves, between flat walls, in one compiled loop."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.contact.pairs.cell_list import near_each_ball
from rigidfluid.core.contact.path.ball_kernel import clear_touched, drift_balls, find_touching, write_normals
from rigidfluid.core.mechanics.free_rotation import turn_ball


@njit(cache=True, nogil=True, error_model="numpy")
def advance_modal_balls(formula, law, balls, modes, radius, around, force, pushed, span):
    """Advance balls in place by equal substeps until a span, or all but the last part of it, is over, and with them the
    contacts' ``force`` and impulse ``pushed`` (n, d).

    ``balls`` and ``modes`` are the arrays of `ModalBalls` and of `Modes`; the others are those of `advance_balls`, and
    so is what is returned: the number of substeps, the time left of the step and of the span, the least gap, the ball
    that has it, whether pairs were listed anew, and the latest list.
    """
    position, orientation, velocity, spin, _, _, _ = balls
    start, second, before, list_reach, wide, planes = around
    left, planned, substep, most, rounding, stops = span
    parameters, law_range = law
    half, least, nearest, steps, touching, anew = 0.5 * substep, np.inf, 0, 0, 0, False
    torque, body, gap = np.zeros_like(spin), np.empty((len(second), 2), np.int64), np.empty(len(second))
    normal = np.empty((len(second), position.shape[1]))
    while left > 0.0 and planned > 0.0 and steps < most and not left < substep:
        _kick(balls, modes, force, pushed, half)
        square = drift_balls(position, velocity, substep, before)
        _sum_friction(modes, substep)
        for i in range(len(spin)):
            turn_ball(orientation, spin, i, substep)
        if not square < (0.5 * max(list_reach - law_range, 0.0)) ** 2:
            start, second = near_each_ball(position, radius, planes, wide)
            before, list_reach, anew = position.copy(), wide, True
        clear_touched(force, torque, body, touching if steps else -1)
        if len(second) > len(body):
            body, gap = np.empty((len(second), 2), np.int64), np.empty(len(second))
            normal = np.empty((len(second), position.shape[1]))
        touching, least, nearest = find_touching(position, radius, start, second, planes, law_range, body, gap)
        write_normals(position, planes, body[:touching], normal)
        _push(formula, parameters, radius, body[:touching], gap, normal, force)
        _kick(balls, modes, force, pushed, half)
        steps += 1
        planned -= substep
        left = left - substep if left - substep > rounding else 0.0
        if not least > 0.0 or (stops and touching == 0):
            break
    return steps, left, planned, least, nearest, anew, (start, second, before, list_reach)


@njit(cache=True, nogil=True, error_model="numpy")
def _kick(balls, modes, force, pushed, time):
    """Add to velocities, and to the impulse of contacts, what forces give in a time; those of the model follow its
    modes."""
    _, _, velocity, spin, rate, turning, inverse = balls
    body, axis, shape, start, modal, load, growth, share, gained, growing, sums, _ = modes
    for i in range(len(velocity)):
        for k in range(velocity.shape[1]):
            change = rate[i, k]
            for m in range(velocity.shape[1]):
                change += inverse[i, k, m] * force[i, m]
            velocity[i, k] += time * change
            pushed[i, k] += time * force[i, k]
        for k in range(spin.shape[1]):
            spin[i, k] += time * turning[i, k]
    for j in range(len(modal)):
        push = load[j] + sums[0] * growth[j]
        for m in range(len(body)):
            push += shape[m, j] * force[body[m], axis[m]]
        modal[j] = share[j] * modal[j] + gained[j] * push + growing[j] * growth[j]
    sums[0] += time
    for m in range(len(body)):
        now = start[m]
        for j in range(len(modal)):
            now += shape[m, j] * modal[j]
        velocity[body[m], axis[m]] = now


@njit(cache=True, nogil=True, error_model="numpy")
def _sum_friction(modes, time):
    """Add a drift with the present modal velocities for a time to the integrals of their friction."""
    modal, sums, integrals = modes[4], modes[10], modes[11]
    for j in range(len(modal)):
        integrals[0, j] += time * modal[j]
        integrals[1, j] += (sums[1] + 0.5 * time) * time * modal[j]
        integrals[2, j] += time * modal[j] ** 2
    sums[1] += time


@njit(cache=True, nogil=True, error_model="numpy")
def _push(formula, parameters, radius, body, gap, normal, force):
    """Add each contact's force, which depends on gaps alone."""
    count, dimension = force.shape
    for i in range(len(body)):
        a, b = body[i]
        radius_b = radius[b] if b < count else np.inf
        _, push, _, _ = formula(parameters, gap[i], radius[a], radius_b, 1.0, 0.0, 0.0)
        for k in range(dimension):
            force[a, k] += push * normal[i, k]
            if b < count:
                force[b, k] -= push * normal[i, k]
