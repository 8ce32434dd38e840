"""Joints of bodies in the linear system of a step: their forces follow from the impulse responses of its own matrix."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.joint_forces import joint_forces
from rigidfluid.core.model.types import Links
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.system.coupled import CoupledSystem, Solution
from rigidfluid.taylor_hood.system.discretisation import Discretisation

_RESPONSE_TOLERANCE = 1e-6
"""Relative residual of the impulse responses [1]: each round leaves this share of the velocities' misfit."""

_FIT = 1e-9
"""Relative misfit of velocities allowed in links [1]; its square is one of power, which all units share."""

_MOST_ROUNDS = 4
_TOO_WRONG = 1e-4


def solve_linked(
    discretisation: Discretisation, system: CoupledSystem, links: Links, tolerance: float
) -> tuple[Solution, FloatArray]:
    """Solve for forces λ with C u + κ λ = r: (C W Cᵀ + κ) λ = r - C u₀, u₀ the twists without them.

    W are the twists by unit wrenches, from the step's matrix 𝓚. They are known to some digits, and so this is done
    again for what is still missing.

    Parameters
    ----------
    discretisation : Discretisation
        Solves without links.
    system : CoupledSystem
        The step's equations.
    links : Links
        C, r and κ.
    tolerance : float
        Relative residual of each solution [1].

    Returns
    -------
    Solution
        With the forces in it.
    (c,) array
        λ [force | force·length].

    Raises
    ------
    StepRejected
        If the links do not hold, or two of them hold the same.
    """
    if len(links.rate) == 0:
        return discretisation.solve(system, tolerance), np.zeros(0)
    responses = discretisation.twist_response(system.matrix, np.moveaxis(links.rows, 0, -1), _RESPONSE_TOLERANCE)
    compliance: FloatArray = np.tensordot(links.rows, responses, axes=2) + np.diag(links.compliance)
    force = joint_forces(compliance, links.rate)  # what a drive needs from rest, when there is no other load
    solution = discretisation.solve(_add_link_forces(system, links, force), tolerance)
    missing = _misfit(links, solution, force)
    scale = sum(_power(compliance, each) for each in (links.rate, missing)) + _power_of_motions(system, solution)
    for _ in range(_MOST_ROUNDS):
        if _power(compliance, missing) <= max(_FIT, tolerance) ** 2 * scale:
            break
        force = force + joint_forces(compliance, missing)
        velocity, pressure, twist = solution.velocity, solution.pressure, solution.twist
        nearer = replace(system, velocity=velocity, pressure=pressure, twist=twist, again=True)
        solution = discretisation.solve(_add_link_forces(nearer, links, force), tolerance)
        missing = _misfit(links, solution, force)
    if _power(compliance, missing) > _TOO_WRONG**2 * scale:
        raise StepRejected(
            "joints",
            f"velocities that miss by {np.abs(missing).max():.3g}",
            f"at most {_TOO_WRONG:g} of what joints change",
            "Shorten time.step, or lower fluid.tolerance.",
        )
    return solution, force


def _add_link_forces(system: CoupledSystem, links: Links, force: FloatArray) -> CoupledSystem:
    return replace(system, body_load=system.body_load + np.tensordot(force, links.rows, axes=1))


def _misfit(links: Links, solution: Solution, force: FloatArray) -> FloatArray:
    return np.asarray(links.rate - np.tensordot(links.rows, solution.twist, axes=2) - links.compliance * force)


def _power(compliance: FloatArray, missing: FloatArray) -> float:
    """Power of the forces that would mend a ``missing`` rate (c,) of the links [energy/time]."""
    return float(missing @ joint_forces(compliance, missing))


def _power_of_motions(system: CoupledSystem, solution: Solution) -> float:
    """Power of inertia and load on the free motions [energy/time]."""
    free = ~system.matrix.prescribed
    twist, load = solution.twist[free], system.body_load[free]
    inertia = float(np.einsum("ni,nij,nj->", twist, system.matrix.mass_matrix[free], twist))
    return inertia + float(np.sum(np.abs(load * twist)))
