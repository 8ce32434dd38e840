"""Velocity Verlet substeps of free balls between flat walls, in one compiled loop over substeps."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.contact.pairs.cell_list import near_each_ball
from rigidfluid.core.mechanics.free_rotation import turn_ball


@njit(cache=True, nogil=True, error_model="numpy")
def advance_balls(formula, law, balls, radius, around, load, impulse, span):
    """Advance balls in place by equal substeps until a span is over, and with them the contacts' load and impulse.

    ``balls`` are the arrays of `FreeBalls`, ``around`` those of a `PairList`, the reach for which others are made
    [length] and the planes (w, 2, d); ``load`` and ``impulse`` force (n, d) and torque (n, k), and the loss to dampers
    [energy/time], ``law`` the parameters of the compiled ``formula`` and the range, ``span`` a `Span`. Returned are the
    number of substeps, the time left of the step and of the span, the energy dissipated, the loss at the end, the least
    gap, the ball that has it, whether pairs were listed anew, and the latest list.
    """
    position, orientation, velocity, momentum, mass, inertia, weight = balls
    start, second, before, list_reach, wide, planes = around
    force, torque, loss = load
    pushed, turned = impulse
    left, planned, substep, most, rounding, stops = span
    parameters, law_range = law
    elapsed, since, dissipated, least, nearest, steps = 0.0, np.zeros(len(position)), 0.0, np.inf, 0, 0
    body, gap = np.empty((len(second), 2), np.int64), np.empty(len(second))
    normal, damped = np.empty((len(second), position.shape[1])), np.empty((len(second), position.shape[1]))
    touching, anew = 0, False
    while left > 0.0 and planned > 0.0 and steps < most:
        part = min(substep, left)
        half = 0.5 * part
        kick_balls(velocity, mass, force, weight, pushed, half)
        twist_balls(orientation, momentum, inertia, torque, turned, half, elapsed, since)
        square = drift_balls(position, velocity, part, before)
        elapsed += part
        if not square < (0.5 * max(list_reach - law_range, 0.0)) ** 2:
            start, second = near_each_ball(position, radius, planes, wide)
            before, list_reach, anew = position.copy(), wide, True
        clear_touched(force, torque, body, touching if steps else -1)
        if len(second) > len(body):
            body, gap = np.empty((len(second), 2), np.int64), np.empty(len(second))
            normal, damped = np.empty((len(second), position.shape[1])), np.empty((len(second), position.shape[1]))
        touching, least, nearest = find_touching(position, radius, start, second, planes, law_range, body, gap)
        write_normals(position, planes, body[:touching], normal)
        loss_before, loss = loss, 0.0
        pairs = body[:touching], gap, normal
        dampers = _push(formula, parameters, balls, radius, *pairs, damped, force, torque)
        kick_balls(velocity, mass, force, weight, pushed, half)
        twist_balls(orientation, momentum, inertia, torque, turned, half, elapsed, since)
        if dampers:
            loss = _loss(balls, radius, *pairs, damped)
        dissipated += half * (loss_before + loss)
        steps += 1
        planned -= part
        left = left - part if left - part > rounding else 0.0
        if not least > 0.0 or (stops and touching == 0):
            break
    for i in range(len(position)):
        turn_ball(orientation, momentum, i, (elapsed - since[i]) * inertia[i])
    return steps, left, planned, dissipated, loss, least, nearest, anew, (start, second, before, list_reach)


@njit(cache=True, nogil=True, error_model="numpy")
def kick_balls(velocity, mass, force, weight, pushed, time):
    """Add to velocities, and to the impulse of contacts, what forces give in a time."""
    for i in range(len(velocity)):
        share = time / mass[i]
        for k in range(velocity.shape[1]):
            velocity[i, k] += share * (force[i, k] + weight[i, k])
            pushed[i, k] += time * force[i, k]


@njit(cache=True, nogil=True, error_model="numpy")
def twist_balls(orientation, momentum, inertia, torque, turned, time, elapsed, since):
    """Add to angular momenta what torques give in a time; before one acts, its ball turns as far as it is behind."""
    for i in range(len(momentum)):
        turns = False
        for k in range(momentum.shape[1]):
            turns = turns or torque[i, k] != 0.0
        if turns:
            turn_ball(orientation, momentum, i, (elapsed - since[i]) * inertia[i])
            since[i] = elapsed
            for k in range(momentum.shape[1]):
                momentum[i, k] += time * torque[i, k]
                turned[i, k] += time * torque[i, k]


@njit(cache=True, nogil=True, error_model="numpy")
def drift_balls(position, velocity, time, before):
    """Move all for a time; return the square of the longest way of any since it was at ``before``."""
    farthest = 0.0
    for i in range(len(position)):
        square = 0.0
        for k in range(position.shape[1]):
            position[i, k] += time * velocity[i, k]
            square += (position[i, k] - before[i, k]) ** 2
        farthest = max(farthest, square)
    return farthest


@njit(cache=True, nogil=True)
def clear_touched(force, torque, body, touching):
    """Set to zero the rows of balls that touch, or all if it is not known which do."""
    if touching < 0:
        force[:] = 0.0
        torque[:] = 0.0
    for i in range(touching):
        for side in range(2):
            if body[i, side] < len(force):
                force[body[i, side]] = 0.0
                torque[body[i, side]] = 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def find_touching(position, radius, start, second, planes, reach, body, gap):
    """Write the pairs in reach and their gaps; return their number, the least gap, and the ball that has it."""
    # Distances are written out: functions shared with `detectors.sphere_contacts` made a substep 3 times slower.
    count, dimension = position.shape
    found, least, nearest = 0, np.inf, 0
    for a in range(count):
        for pair in range(start[a], start[a + 1]):
            b = second[pair]
            if b < count:
                x, y, z = position[a, 0] - position[b, 0], position[a, 1] - position[b, 1], 0.0
                if dimension == 3:
                    z = position[a, 2] - position[b, 2]
                square = x * x + y * y + z * z
                # a root for those alone that may be near
                if square > 1.001 * (radius[a] + radius[b] + reach) ** 2:
                    continue
                free = np.sqrt(square) - radius[a] - radius[b]
            else:
                free = -radius[a]
                for k in range(dimension):
                    free += (position[a, k] - planes[b - count, 0, k]) * planes[b - count, 1, k]
            if free <= reach:
                body[found, 0], body[found, 1], gap[found] = a, b, free
                found += 1
                if free < least:
                    least, nearest = free, a
    return found, least, nearest


@njit(cache=True, nogil=True, error_model="numpy")
def write_normals(position, planes, body, normal):
    """Write the normal of each pair of different centres, from b to a."""
    for i in range(len(body)):
        a, b = body[i]
        if b >= len(position):
            normal[i] = planes[b - len(position), 1]
            continue
        square = 0.0
        for k in range(position.shape[1]):
            square += (position[a, k] - position[b, k]) ** 2
        for k in range(position.shape[1]):
            normal[i, k] = (position[a, k] - position[b, k]) / np.sqrt(square)


@njit(cache=True, nogil=True, error_model="numpy")
def _push(formula, parameters, balls, radius, body, gap, normal, damped, force, torque):
    """Add each contact's force and moments, write the damping in it, and return how many have any."""
    _, _, velocity, momentum, mass, inertia, _ = balls
    count, dimension = velocity.shape
    along, dampers = np.zeros(3), 0
    for i in range(len(body)):
        a, b = body[i]
        opening = relative_velocity(along, normal, i, a, b, gap, radius, inertia, velocity, momentum)
        sliding = 0.0
        for k in range(dimension):
            along[k] -= opening * normal[i, k]
            sliding += along[k] ** 2
        radius_b, inverse = (radius[b], 1.0 / mass[a] + 1.0 / mass[b]) if b < count else (np.inf, 1.0 / mass[a])
        _, push, damping, drag = formula(
            parameters, gap[i], radius[a], radius_b, 1.0 / inverse, opening, np.sqrt(sliding)
        )
        dampers += damping != 0.0 or drag != 0.0
        for k in range(dimension):
            damped[i, k] = damping * normal[i, k] - drag * along[k]
            whole = push * normal[i, k] + damped[i, k]
            force[a, k] += whole
            if b < count:
                force[b, k] -= whole
        if drag != 0.0:
            for k in range(torque.shape[1]):
                first, last = ((k + 1) % 3, (k + 2) % 3) if dimension == 3 else (0, 1)
                moment = drag * (normal[i, first] * along[last] - normal[i, last] * along[first])
                torque[a, k] += (radius[a] + 0.5 * gap[i]) * moment
                if b < count:
                    torque[b, k] += (radius[b] + 0.5 * gap[i]) * moment
    return dampers


@njit(cache=True, nogil=True, error_model="numpy")
def _loss(balls, radius, body, gap, normal, damped):
    """Power that the dampers take with the present velocities."""
    _, _, velocity, momentum, _, inertia, _ = balls
    taken, relative = 0.0, np.zeros(3)
    for i in range(len(body)):
        a, b = body[i]
        relative_velocity(relative, normal, i, a, b, gap, radius, inertia, velocity, momentum)
        for k in range(velocity.shape[1]):
            taken -= damped[i, k] * relative[k]
    return taken


@njit(cache=True, nogil=True, error_model="numpy")
def relative_velocity(relative, normal, i, a, b, gap, radius, inertia, velocity, momentum):
    """Velocity of a relative to b in the middle of their gap, into ``relative``; its part along the normal is
    returned."""
    count, dimension = velocity.shape
    opening = 0.0
    for k in range(dimension):
        relative[k] = velocity[a, k] - (velocity[b, k] if b < count else 0.0)
        opening += relative[k] * normal[i, k]
    for k in range(momentum.shape[1]):
        spin = (radius[a] + 0.5 * gap[i]) * inertia[a] * momentum[a, k]
        if b < count:
            spin += (radius[b] + 0.5 * gap[i]) * inertia[b] * momentum[b, k]
        # minus the cross product of the spin with the normal
        first, last = ((k + 1) % 3, (k + 2) % 3) if dimension == 3 else (0, 1)
        relative[first] += spin * normal[i, last]
        relative[last] -= spin * normal[i, first]
    return opening
