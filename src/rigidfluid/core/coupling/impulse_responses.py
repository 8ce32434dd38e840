"""Update the reduced impulse–response model; re-evaluate only bodies whose gap or motion changed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.motions import reaches, twist_arms
from rigidfluid.core.model.reduced_model import Evaluation, ReducedModel, reduced_model
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Step

CHANGED, CHANGED_SHARED = 0.01, 0.05
"""Relative change of the film resistance of a body, or of its way in a step over its radius, above which its response
is re-evaluated; the second one where many bodies share right sides."""

_FILM = 0.1
"""Thickness of a film, over the radius, below which its resistance outweighs the body's own."""

ALONE = 12
"""Largest number of bodies in a model whose responses are evaluated one by one; of more, those far apart share right
sides."""

FAR = 3.0
"""Distance of two bodies, over the sum of their radii, beyond which they hardly respond to each other's impulses: the
response falls as r⁻², in 3D as r⁻³."""


def updated_model(
    system: System,
    state: State,
    step: Step,
    contacts: Contacts,
    twist: FloatArray,
    velocities: IntArray,
    known: ReducedModel | None,
) -> ReducedModel:
    """Reduced model of ``velocities`` (c,), numbers among the components (N, d+k) of all motions' twists; the responses
    are evaluated for bodies alone whose contacts or motion have changed.

    ``step`` has the matrix and mesh of the response, ``contacts`` and ``twist`` (N, d+k) are those of the bodies in it,
    as friction depends on the flow; ``known`` is an earlier model, of these velocities or others, or None.
    """
    if len(velocities) == 0:
        return ReducedModel(velocities, np.zeros((0, 0)), np.zeros(0), Evaluation(np.zeros(0), np.zeros(0)), False)
    bodies, d0 = velocities // step.load.shape[1], float(step.derivative[0])
    now = Evaluation(_film_resistance(system, contacts)[bodies], twist.ravel()[velocities])
    shared = share_sides(velocities, step.load.shape[1])
    if known is not None and known.shared and not shared:
        known = None  # responses of few bodies have all digits
    inviscid, viscous, before = _remembered(known, velocities, d0)
    arm = twist_arms(system)[bodies, velocities % step.load.shape[1]] / reaches(system)[0][bodies]
    changed = _changes(now, before, bodies, arm / d0)
    fresh = ~(changed <= (CHANGED_SHARED if shared else CHANGED))
    if known is not None and not fresh.any() and np.array_equal(known.velocities, velocities):
        return known
    if fresh.any():
        evaluated = _evaluated(system, state, replace(step, shared=shared), velocities, fresh)
        for matrix, found in zip((inviscid, viscous), evaluated, strict=True):
            _take_over(matrix, found, fresh)
    evaluation = Evaluation(*(np.where(fresh, new, old) for new, old in zip(now.arrays, before.arrays, strict=True)))
    return reduced_model(velocities, inviscid, viscous, d0, evaluation, shared)


def share_sides(velocities: IntArray, width: int) -> bool:
    """Tell whether so many motions, of ``width`` components each, have these ``velocities`` (c,) that those far apart
    share right sides."""
    return len(np.unique(velocities // width)) > ALONE


def _changes(now: Evaluation, before: Evaluation, bodies: IntArray, reduced_time: FloatArray) -> FloatArray:
    """Relative change of the film resistance of each velocity's body, or of the body's way in a step over its radius,
    whichever is more, (c,) [1]; a velocity times its ``reduced_time`` (c,) is that way."""
    way = np.zeros(bodies.max() + 1)
    turned = np.abs(now.velocity - before.velocity) * reduced_time
    np.maximum.at(way, bodies, np.where(np.isnan(turned), np.inf, turned))
    return np.maximum(np.abs(now.film_resistance - before.film_resistance) / before.film_resistance, way[bodies])


def _film_resistance(system: System, contacts: Contacts) -> FloatArray:
    """Film resistance 1 + Σ R/(10 gap) over the contacts of each motion with bodies of radius R, relative to that of
    the body alone, (N,) [1].

    The resistance of a film is in inverse proportion to its thickness; films thicker than a tenth of the radius matter
    little compared with the body's own.
    """
    reach, carrier = reaches(system)[0], system.motions.carrier
    total = np.ones(len(reach))
    for body in (contacts.body_a, contacts.body_b):
        on_body = body < len(carrier)
        motion = carrier[body[on_body]]
        np.add.at(total, motion, _FILM * reach[motion] / contacts.gap[on_body])
    return total


def _remembered(
    known: ReducedModel | None, velocities: IntArray, d0: float
) -> tuple[FloatArray, FloatArray, Evaluation]:
    """Known responses W_i and W_s (c, c), zero where unknown, and the conditions of their evaluation, NaN where
    unknown."""
    inviscid, viscous = np.zeros((2, len(velocities), len(velocities)))
    before = Evaluation(*np.full((2, len(velocities)), np.nan))
    if known is not None:
        _, here, there = np.intersect1d(velocities, known.velocities, return_indices=True)
        inviscid[np.ix_(here, here)] = known.inverse_mass[np.ix_(there, there)]
        viscous[np.ix_(here, here)] = known.response(d0, np.eye(len(known.velocities)))[np.ix_(there, there)]
        for old, then in zip(before.arrays, known.evaluation.arrays, strict=True):
            old[here] = then[there]
    return inviscid, viscous, before


def _take_over(matrix: FloatArray, responses: FloatArray, fresh: BoolArray) -> None:
    """Replace the columns and rows ``fresh`` of ``matrix`` by the mean of ``responses`` (c, f) and their transpose;
    NaN entries do not count."""
    of_rows = np.full_like(matrix, np.nan)
    of_rows[:, fresh] = responses
    both = np.stack([of_rows, of_rows.T])
    finite = np.isfinite(both)
    times = finite.sum(axis=0)
    mean = np.where(finite, both, 0.0).sum(axis=0) / np.maximum(times, 1)
    replaced = fresh[:, None] | fresh[None, :]
    matrix[replaced] = mean[replaced]


def _evaluated(
    system: System, state: State, step: Step, velocities: IntArray, fresh: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Responses W_i and W_s (c, f) to the ``fresh`` velocities; NaN where another body of a right side is nearer."""
    width = step.load.shape[1]
    bodies, turn = np.divmod(velocities[fresh], width)
    position = step.kinematics.centres(step.pose)
    group = _groups_apart(system, position, bodies) if step.shared else np.unique(bodies, return_inverse=True)[1]
    components = np.unique(turn)
    side = group * len(components) + np.searchsorted(components, turn)
    numbers, side = np.unique(side, return_inverse=True)
    impulses = np.zeros((len(numbers), *step.load.shape))
    impulses[side, bodies, turn] = 1.0
    response = system.backend.response(state.fluid, state.mesh, step, impulses)
    mine = _is_nearest(_distances(system, position[velocities // width], position[bodies]), side)
    inviscid, viscous = (
        np.where(mine, twists.reshape(len(numbers), -1)[side][:, velocities].T, np.nan)
        for twists in (response.inviscid, response.viscous)
    )
    return inviscid, viscous


def _groups_apart(system: System, position: FloatArray, bodies: IntArray) -> IntArray:
    """Group of each of ``bodies`` (f,), whose members are far apart."""
    each, place = np.unique(bodies, return_inverse=True)
    reach = reaches(system)[1][each]
    apart = _distances(system, position[each], position[each])
    near = apart < FAR * (reach[:, None] + reach[None, :])
    group = np.full(len(each), -1)
    for body in range(len(each)):
        taken = set(group[near[body]].tolist())
        group[body] = next(number for number in range(len(each)) if number not in taken)
    return np.asarray(group[place])


def _distances(system: System, responding: FloatArray, pushed: FloatArray) -> FloatArray:
    """Distance of each place ``pushed`` (f, d), or of its nearest image, from each ``responding`` one (c, d), (c, f)
    [length]: a fluid between periodic surfaces responds across them too."""
    apart = system.domain.cells.shortened(responding[:, None] - pushed[None, :])
    return np.asarray(np.linalg.norm(apart, axis=2))


def _is_nearest(apart: FloatArray, side: IntArray) -> BoolArray:
    """Tell whether each pushed body is the nearest one of its right ``side`` (f,) to each responding one, (c, f);
    they are so far ``apart`` (c, f)."""
    nearest = np.full((len(apart), int(side.max()) + 1), np.inf)
    for column, number in enumerate(side):
        nearest[:, number] = np.minimum(nearest[:, number], apart[:, column])
    return np.asarray(apart <= nearest[:, side])
