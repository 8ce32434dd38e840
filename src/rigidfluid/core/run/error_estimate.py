"""The local error of a step, from three velocities; what the impulses of contacts explain is left out."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from rigidfluid.core.mechanics.time_scheme import extrapolation_weights, path_error_weight
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.state import ErrorEstimate, State
from rigidfluid.core.model.system import System
from rigidfluid.core.run.masses import Masses

UNSEEN = 3
"""Nothing is known of so many steps after a start. Before the last of them there are no three velocities of one smooth
motion, as the first step may be a jump. To that the pressure answers twice, with opposite signs, and in the balance of
energy these cancel each other if all of the steps are equal."""


def estimate_error(system: System, time: float, state: State, candidate: State) -> ErrorEstimate:
    """Estimate the error of the step from ``state``, on the mesh that it was taken on, to the ``candidate`` at
    ``time``.

    Local error of the paths of bodies and fluid particles per unit time, c (uⁿ⁺¹ - u*) with u* extrapolated and c by
    `path_error_weight`, relative: of each free motion over the greatest speed, of the fluid in the norm of kinetic
    energy over the greatest energy. The larger one counts. An angular velocity counts by its energy, as √(ω·Iω/m). It
    is unknown in the first steps.

    An impact changes velocities at once, whatever the step. So what the change of the contacts' force could do to the
    bodies' own masses is subtracted. It is an upper bound, since the fluid adds to the masses.

    On a new mesh velocities also differ by what the transfer has changed, which no shorter step makes smaller: the
    estimate of the step before stands.
    """
    before, masses = state.estimate or _expected(system), Masses(system, time, candidate)
    speed = max(before.speed, masses.fastest(masses.energies(flat(candidate.motions.twist))))
    after = replace(
        before,
        steps=before.steps + 1,
        level=before.level if candidate.level is None or candidate.impact == candidate.tick else candidate.level,
        speed=speed,
        energy=max(before.energy, candidate.ledger.kinetic),
    )
    if after.steps <= UNSEEN or state.is_on_new_mesh or state.past is None or candidate.past is None:
        return after
    size, previous = candidate.past.step, state.past.step
    weight, (e0, e1) = path_error_weight(size, previous), extrapolation_weights(size, previous)
    otherwise = flat(candidate.motions.twist) - e0 * flat(state.motions.twist) - e1 * flat(state.past.twist)
    impulse = size * (flat(candidate.motions.contact) - flat(state.motions.contact))
    bodies, contacts = masses.energies(otherwise), masses.energies_by(impulse)
    fluid = system.backend.prediction_error(state.fluid, candidate.fluid, candidate.mesh, np.array([e0, e1]))
    whole = max(_ratio(masses.fastest(bodies), speed), _ratio(fluid**0.5, after.energy**0.5))
    smooth_fluid = max(fluid**0.5 - contacts.sum() ** 0.5, 0.0)
    smooth_bodies = np.maximum(np.sqrt(bodies) - np.sqrt(contacts), 0.0) ** 2
    smooth = max(_ratio(masses.fastest(smooth_bodies), speed), _ratio(smooth_fluid, after.energy**0.5))
    return replace(after, error=weight * smooth, with_contacts=weight * whole)


def _expected(system: System) -> ErrorEstimate:
    """Estimate before the first step: the speeds of impact that the scene leads to expect, and the bodies' energy with
    them."""
    free = ~system.prescribed
    speed, added = system.loads.speed[free], np.trace(system.added_mass[free], axis1=1, axis2=2) / system.dimension
    energy = 0.5 * float((system.mass[free] + added) @ speed**2)
    return ErrorEstimate(0, 0, math.inf, math.inf, float(speed.max(initial=0.0)), energy)


def _ratio(value: float, scale: float) -> float:
    return value / scale if scale > 0.0 else 0.0
