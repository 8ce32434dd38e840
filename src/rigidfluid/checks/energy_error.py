"""Error of an impact's energy by steps that do not resolve it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.checks.stepping import ACCURATE
from rigidfluid.core.contact.laws.loads import pair_values
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.run.impacts import MOST_HALVINGS, TOLERATED_FRICTION

QUESTION = "energy-error"
_ALLOWED = 0.05
"""Greatest error of an impact's energy that is allowed, over that energy [1]."""
_LAYER_FACTOR = 1.0
"""Empirical: what a falling disk was seen to lose with four steps is .7 to 1.5 times the estimate with it."""
_FRICTION = 0.1
"""Empirical: energy that friction takes on the bodies' path, by which a run halves steps, over all that an impact
loses [1]."""


class _Rates(NamedTuple):
    """The error of an impact's energy is ``layer`` √Δt + ``fall`` Δt."""

    layer: float
    fall: float

    def error(self, step: float) -> float:
        return self.layer * float(np.sqrt(step)) + self.fall * step

    def cut_step(self, step: float, bodies: int) -> float:
        """Step [time] that a run cuts the nominal ``step`` to where one of so many bodies hits."""
        for _ in range(MOST_HALVINGS):
            if _FRICTION * self.error(step) <= TOLERATED_FRICTION * bodies:
                break
            step *= 0.5
        return step

    def longest_step(self, bodies: int) -> float:
        """Longest nominal step with the allowed error, in the cut steps at the impact [time]."""
        root = 2.0 * _ALLOWED / (self.layer + np.sqrt(self.layer**2 + 4.0 * _ALLOWED * self.fall))
        halvings = MOST_HALVINGS if TOLERATED_FRICTION * bodies < _FRICTION * _ALLOWED else 0
        return float(2.0**halvings * root**2)


def energy_error_findings(design: DesignContacts, fluid: FluidProblem, step: float) -> Iterator[Finding]:
    """Estimate the share of an impact's energy that the fluid's ``step`` Δt [time] gets wrong, for contacts of
    frequency ω Δt > 0.5; a warning above 5 %. A fluid without inertia lets nothing rebound, and nothing is estimated.

    A run shortens steps in impacts that take much of all energy, and the estimate is that of the shortened step, all
    bodies taken as alike. Two parts are added. In a step the fluid's response to an impulse is a viscous layer of
    thickness δ = √(ν Δt), which is as heavy as ρ δ S/m relative to the mass, added mass included, S being the surface
    of a ball of equal volume. And the weight acts for one step at a velocity that is the one before or after the
    impact: a Δt/v, with a = W/m.
    """
    frequency = np.sqrt(design.stiffness() * design.inverse_mass)
    struck = fluid.inertia & (design.speed > 0.0) & (frequency * step > ACCURATE)
    layer, fall = _layer_rate(design, fluid), _fall_rate(design)
    for row in design.worst(np.where(struck, layer * np.sqrt(step) + fall * step, -np.inf)):
        if struck[row]:
            yield _finding(design, row, _Rates(float(layer[row]), float(fall[row])), float(frequency[row]), step)


def _layer_rate(design: DesignContacts, fluid: FluidProblem) -> FloatArray:
    """ρ √ν Σ S/m² over Σ 1/m, both sums over the two bodies (m,) [time^-1/2]."""
    bodies = design.system.bodies
    surface = np.array([body.dimension * body.volume / equal_volume_radius(body) for body in bodies])
    drawn = pair_values(surface / design.system.loads.mass**2, design.contacts).sum(axis=0)
    shear = float(np.sqrt(fluid.density * fluid.material.dynamic_viscosity))
    return np.asarray(_LAYER_FACTOR * shear * drawn / design.inverse_mass)


def _fall_rate(design: DesignContacts) -> FloatArray:
    """The larger W/m of the two bodies over the speed of the impact, zero without speed (m,) [1/time]."""
    loads = design.system.loads
    fastest = pair_values(loads.weight / loads.mass, design.contacts).max(axis=0)
    rate: FloatArray = np.divide(fastest, design.speed, out=np.zeros(len(fastest)), where=design.speed > 0.0)
    return rate


def _finding(design: DesignContacts, row: int, rates: _Rates, frequency: float, step: float) -> Finding:
    bodies = int(np.sum(~design.system.prescribed))
    cut = rates.cut_step(step, bodies)
    error = min(rates.error(cut), 1.0)
    found = {
        "energy_error": error,
        "layer_error": rates.layer * float(np.sqrt(cut)),
        "fall_error": rates.fall * cut,
        "step_at_impact": cut,
        "turn_per_step": frequency * step,
        "impact_speed": float(design.speed[row]),
    }
    text = f"{' and '.join(design.names(row))}: a step of {figure(step)} does not resolve a contact of "
    text += f"{figure(np.pi / frequency)}; by steps of {figure(cut)} there about "
    text += f"{figure(100.0 * error)} % of the impact's energy may be lost"
    if error <= _ALLOWED:
        return Finding("note", QUESTION, design.names(row), text, found=found)
    enough = {"time_step": max(rates.longest_step(bodies), ACCURATE / frequency)}
    remedy = f"Set time.step to {round_down(enough['time_step'])} or less for {figure(100.0 * _ALLOWED)} %."
    return Finding("warning", QUESTION, design.names(row), text, remedy, found, enough)
