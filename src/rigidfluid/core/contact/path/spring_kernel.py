"""Velocity Verlet substeps of free balls with springs along their surfaces, in one compiled loop over substeps."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.contact.path.ball_kernel import (
    clear_touched,
    drift_balls,
    find_touching,
    kick_balls,
    relative_velocity,
    twist_balls,
    write_normals,
)
from rigidfluid.core.mechanics.free_rotation import turn_ball

_OPPOSITE = 1e-12
"""Least 1 + cosine of the angle between two normals at which their common plane is known."""


@njit(cache=True, nogil=True, error_model="numpy")
def advance_sticking_balls(formula, law, balls, radius, around, load, impulse, springs, span, turned, drifted):
    """Advance balls in place by equal substeps until a span is over or the list of pairs is outdated, and with them the
    contacts' load and impulse and the springs.

    ``balls``, ``radius``, ``load``, ``impulse`` and ``span`` are those of `advance_balls`. ``law``: parameters of the
    compiled ``formula`` in each listed pair (m, p), or in all (1, p), its range, and the numbers and cubics of a
    `BallLaw`. ``around``: start and second of a `PairList`, the position at which it was made, the square of the way
    that balls may go from there, and the planes (w, 2, d). ``springs``: `Rows`, others, both with room for all pairs,
    and how many of the former there are. ``turned``: the time up to which each ball has turned, (n,), and that since
    the beginning [time]. ``drifted``: the present substep has begun with another list, and balls are at its end.

    Returned are the number of substeps, the time left of the step and of the span, the energy dissipated, the loss at
    the end, the ball that has the least gap and this, the springs and their number, the time since the beginning, and
    whether the list is outdated, in a substep that has begun.
    """
    position, orientation, velocity, momentum, mass, inertia, weight = balls
    start, second, before, spare, planes = around
    force, torque, loss = load
    pushed, twisted = impulse
    left, planned, substep, most, rounding, stops = span
    parameters, law_range, numbers, cubics = law
    since, elapsed = turned
    old, new, kept = springs
    dissipated, least, nearest, steps, touching = 0.0, np.inf, 0, 0, -1
    damped, couple = np.empty_like(old[1]), np.empty_like(old[3])
    outdated = False
    while left > 0.0 and planned > 0.0 and steps < most:
        part = min(substep, left)
        half = 0.5 * part
        if not drifted:
            kick_balls(velocity, mass, force, weight, pushed, half)
            twist_balls(orientation, momentum, inertia, torque, twisted, half, elapsed, since)
            square = drift_balls(position, velocity, part, before)
            elapsed += part
            if not square < spare:
                outdated = True
                break
        drifted = False
        clear_touched(force, torque, old[0], touching)
        body, normal, gap = new[0], new[1], new[5]
        touching, least, nearest = find_touching(position, radius, start, second, planes, law_range, body, gap)
        write_normals(position, planes, body[:touching], normal)
        _carry(old, kept, new, touching)
        stored = _energy(old, kept)
        rows = _rows(start, second, body[:touching]) if len(parameters) > 1 else np.zeros(touching, np.int64)
        pairs = body[:touching], gap, normal
        found = formula, parameters, rows, law_range, numbers, cubics
        work = _push(found, balls, radius, pairs, new, damped, couple, force, torque, part)
        kept = touching
        kick_balls(velocity, mass, force, weight, pushed, half)
        twist_balls(orientation, momentum, inertia, torque, twisted, half, elapsed, since)
        loss_before, loss = loss, _loss(balls, radius, *pairs, damped, couple)
        dissipated += half * (loss_before + loss) + work + stored - _energy(new, kept)
        old, new = new, old
        steps += 1
        planned -= part
        left = left - part if left - part > rounding else 0.0
        if not least > 0.0 or (stops and touching == 0):
            break
    if not outdated:
        for i in range(len(position)):
            turn_ball(orientation, momentum, i, (elapsed - since[i]) * inertia[i])
    return steps, left, planned, dissipated, loss, (nearest, least), (old, kept), elapsed, outdated


@njit(cache=True, nogil=True, error_model="numpy")
def _energy(springs, kept):
    """Energy k (ξ² + ζ²)/2 of the first springs."""
    _, _, displacement, turning, stiffness, _ = springs
    total = 0.0
    for i in range(kept):
        square = 0.0
        for k in range(displacement.shape[1]):
            square += displacement[i, k] ** 2
        for k in range(turning.shape[1]):
            square += turning[i, k] ** 2
        total += 0.5 * stiffness[i] * square
    return total


@njit(cache=True, nogil=True)
def _rows(start, second, body):
    """Places of some pairs, in order, in the list that has them."""
    rows, place = np.empty(len(body), np.int64), 0
    for i in range(len(body)):
        place = max(place, start[body[i, 0]])
        while second[place] != body[i, 1]:
            place += 1
        rows[i] = place
    return rows


@njit(cache=True, nogil=True, error_model="numpy")
def _carry(old, kept, new, touching):
    """Write the displacement and turning of the old springs in the contacts that touch now, turned with the normals as
    `carried_springs` does, zero where there was none."""
    pair, before, displacement, turning, _, _ = old
    body, after, carried, rolled, _, _ = new
    dimension, place, across = before.shape[1], 0, np.empty(before.shape[1])
    for i in range(touching):
        a, b = body[i]
        while place < kept and (pair[place, 0] < a or (pair[place, 0] == a and pair[place, 1] < b)):
            place += 1
        for k in range(dimension):
            carried[i, k] = 0.0
        for k in range(rolled.shape[1]):
            rolled[i, k] = 0.0
        if place == kept or pair[place, 0] != a or pair[place, 1] != b:
            continue
        _transport(displacement[place], before[place], after[i], carried[i])
        if dimension == 2:
            rolled[i, 0] = turning[place, 0]
            continue
        twisting = _dot(turning[place], before[place])
        for k in range(dimension):
            across[k] = turning[place, k] - twisting * before[place, k]
        _transport(across, before[place], after[i], rolled[i])
        for k in range(dimension):
            rolled[i, k] += twisting * after[i, k]


@njit(cache=True, nogil=True, error_model="numpy")
def _transport(vector, before, after, result):
    """Write the parallel transport of a vector across one normal to the plane across another."""
    closeness, along = 1.0 + _dot(before, after), _dot(vector, after)
    part = along / closeness if closeness > _OPPOSITE else 0.0
    for k in range(len(vector)):
        result[k] = vector[k] - part * (before[k] + after[k])
    rest = _dot(result, after)
    for k in range(len(vector)):
        result[k] -= rest * after[k]


@njit(cache=True, nogil=True, error_model="numpy")
def _push(found, balls, radius, pairs, springs, damped, couple, force, torque, time):
    """Stretch each contact's springs, hold what friction holds, add force, moments and couples, and write the dampers'
    share of these; return the work of the springs."""
    formula, parameters, rows, law_range, numbers, cubics = found
    stiffness, friction, rolling, twisting, bounded, dashpot, pressed, share = numbers
    _, _, velocity, momentum, mass, inertia, _ = balls
    body, gap, normal = pairs
    _, _, displacement, turning, stiffnesses, _ = springs
    count, dimension = velocity.shape
    width, work = momentum.shape[1], 0.0
    along, spin, part, friction_force = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    for i in range(len(body)):
        a, b = body[i]
        own = parameters[rows[i]]
        opening = relative_velocity(along, normal, i, a, b, gap, radius, inertia, velocity, momentum)
        sliding = 0.0
        for k in range(dimension):
            along[k] -= opening * normal[i, k]
            sliding += along[k] ** 2
        sliding = np.sqrt(sliding)
        inverse, radius_b, reduced = 1.0 / mass[a], np.inf, radius[a]
        if b < count:
            inverse, radius_b = inverse + 1.0 / mass[b], radius[b]
            reduced = 1.0 / (1.0 / radius[a] + 1.0 / radius[b])
        energy, push, damping, drag = formula(own, gap[i], radius[a], radius_b, 1.0 / inverse, opening, sliding)
        inside = gap[i] < law_range
        if inside and len(cubics[1]):
            damping += max(push, 0.0) * _excess(cubics, -opening, max(2.0 * energy * inverse, 0.0))
        k_t = stiffness
        if np.isnan(stiffness):
            k_t = share * max(formula(own, pressed, radius[a], radius_b, 1.0 / inverse, 0.0, 0.0)[1], 0.0)
        if not inside:
            k_t = 0.0
        stiffnesses[i] = k_t
        drag += dashpot * np.sqrt(k_t / inverse)
        size = abs(push + damping)
        held = friction * size
        slowing = min(drag, held / sliding) if bounded > 0.0 and sliding > 0.0 else drag
        way = 0.0
        for k in range(dimension):
            way += displacement[i, k] * along[k]
            displacement[i, k] += time * along[k]
            part[k] = slowing * along[k]
        _hold(displacement[i], part, k_t, held)
        for k in range(dimension):
            way += displacement[i, k] * along[k]
            damped[i, k] = damping * normal[i, k] - part[k]
            friction_force[k] = -part[k] - k_t * displacement[i, k]
            whole = push * normal[i, k] + damping * normal[i, k] + friction_force[k]
            force[a, k] += whole
            if b < count:
                force[b, k] -= whole
        work += 0.5 * k_t * time * way
        for k in range(width):
            first, last = ((k + 1) % 3, (k + 2) % 3) if dimension == 3 else (0, 1)
            moment = normal[i, last] * friction_force[first] - normal[i, first] * friction_force[last]
            torque[a, k] += (radius[a] + 0.5 * gap[i]) * moment
            if b < count:
                torque[b, k] += (radius[b] + 0.5 * gap[i]) * moment
        if rolling > 0.0 or twisting > 0.0:
            for k in range(width):
                spin[k] = inertia[a] * momentum[a, k] - (inertia[b] * momentum[b, k] if b < count else 0.0)
            bounds = rolling * size, twisting * size
            work += _roll(turning[i], couple[i], spin, normal[i], reduced, k_t, drag, bounds, time)
            for k in range(width):
                turning_couple = couple[i, k] - reduced * k_t * turning[i, k]
                torque[a, k] += turning_couple
                if b < count:
                    torque[b, k] -= turning_couple
        else:
            for k in range(width):
                turning[i, k] = couple[i, k] = 0.0
    return work


@njit(cache=True, nogil=True, error_model="numpy")
def _roll(turning, couple, spin, normal, radius, stiffness, drag, bounds, time):
    """Turn the springs of one contact on by a spin, hold what friction holds across the normal and along it, and write
    the couple of the dashpots; return the work of the springs."""
    width, way = len(turning), 0.0
    whole, resisted, damped = np.empty(width), np.empty(width), np.empty(width)
    for k in range(width):
        way += turning[k] * spin[k]
        turning[k] += time * radius * spin[k]
        whole[k], turning[k], couple[k] = turning[k], 0.0, 0.0
    about, turned = 0.0, 0.0
    if width == 3:
        for k in range(3):
            about += spin[k] * normal[k]
            turned += whole[k] * normal[k]
    for kind in range(2 if width == 3 else 1):
        speed = 0.0
        for k in range(width):
            twist, twisted = (about * normal[k], turned * normal[k]) if width == 3 else (0.0, 0.0)
            damped[k] = twist if kind else spin[k] - twist
            resisted[k] = twisted if kind else whole[k] - twisted
            speed += damped[k] ** 2
        speed = np.sqrt(speed)
        slowing = min(drag * radius, bounds[kind] / speed) if speed > 0.0 else 0.0
        for k in range(width):
            damped[k] *= slowing
            couple[k] -= radius * damped[k]
        _hold(resisted, damped, stiffness, bounds[kind])
        for k in range(width):
            turning[k] += resisted[k]
    for k in range(width):
        way += turning[k] * spin[k]
    return 0.5 * stiffness * time * radius * way


@njit(cache=True, nogil=True, error_model="numpy")
def _hold(displacement, damped, stiffness, most):
    """Shorten a displacement as `held_displacement` does, until its spring and what is ``damped`` are at most as strong
    as friction."""
    square = 0.0
    for k in range(len(displacement)):
        square += (stiffness * displacement[k] + damped[k]) ** 2
    size = np.sqrt(square)
    if size <= most and stiffness > 0.0:
        return
    part = most / size if size > most else 1.0
    for k in range(len(displacement)):
        held = part * (stiffness * displacement[k] + damped[k])
        displacement[k] = (held - damped[k]) / stiffness if stiffness > 0.0 else 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def _excess(cubics, closing, stored):
    """Excess of the force of a restitution over that of its law, as by `excess`."""
    inner, starts, terms = cubics
    whole = np.sqrt(closing**2 + stored)
    share = closing / whole if whole > 0.0 else 0.0
    cubic = np.searchsorted(inner, share, side="right")
    beyond = share - starts[cubic]
    value, slope, bend, twist = terms[cubic, 0], terms[cubic, 1], terms[cubic, 2], terms[cubic, 3]
    return share * (value + beyond * (slope + beyond * (bend + beyond * twist)))


@njit(cache=True, nogil=True, error_model="numpy")
def _loss(balls, radius, body, gap, normal, damped, couple):
    """Power that the dampers take with the present velocities, by forces and couples."""
    _, _, velocity, momentum, _, inertia, _ = balls
    taken, relative, count = 0.0, np.zeros(3), len(velocity)
    for i in range(len(body)):
        a, b = body[i]
        relative_velocity(relative, normal, i, a, b, gap, radius, inertia, velocity, momentum)
        for k in range(velocity.shape[1]):
            taken -= damped[i, k] * relative[k]
        for k in range(momentum.shape[1]):
            spin = inertia[a] * momentum[a, k] - (inertia[b] * momentum[b, k] if b < count else 0.0)
            taken -= couple[i, k] * spin
    return taken


@njit(cache=True, nogil=True, error_model="numpy")
def _dot(one, other):
    total = 0.0
    for k in range(len(one)):
        total += one[k] * other[k]
    return total
