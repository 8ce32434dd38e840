"""Newton's iteration for the flow of a generalised Newtonian fluid in one step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Links
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem, Solution
from rigidfluid.taylor_hood.system.discretisation import Discretisation
from rigidfluid.taylor_hood.system.driving import Driven, solve_driven
from rigidfluid.taylor_hood.system.linearised import linearised, relative_change

_SHARE = 0.1
"""Share of √tolerance at which changes end the iteration [1]: what is left is then about the square of the change."""

_MOST = 100
"""Greatest number of iterations."""

_EXCESS, _HALVINGS = 0.5, 8
"""A change is taken whole if the force against it is then at most this share of the one that drove it, else so often
halved as to be near where that force is zero."""


def solve_newton(
    discretisation: Discretisation, system: CoupledSystem, links: Links, time: float, tolerance: float
) -> tuple[CoupledMatrix, Driven]:
    """Solve a step whose viscosity is that of its solution, each linear system by `solve_driven`; gives its matrix too.

    Raises
    ------
    StepRejected
        If the iteration does not converge.
    """
    if isinstance(discretisation.problem.material, Newtonian):
        return system.matrix, solve_driven(discretisation, system, links, time, tolerance)
    points, change, latest = system.matrix.points, np.inf, system
    enough = _SHARE * tolerance**0.5
    for iteration in range(_MOST):
        latest = linearised_about(discretisation, replace(latest, load=system.load), latest.velocity)
        matrix = latest.matrix
        driven = solve_driven(discretisation, latest, links, time, tolerance)
        change = relative_change(discretisation, points, latest.velocity, driven.solution.velocity, matrix.local)
        if change <= enough:
            return matrix, driven
        share = 1.0 if iteration == 0 else _share_of_change(discretisation, latest, driven.solution)
        latest = _between(latest, driven.solution, share)
    raise StepRejected(
        "fluid.material",
        f"changes of the flow by {change:.1g} after {_MOST} iterations",
        f"at most {enough:.1g}",
        "Shorten time.step, or choose a material whose viscosity varies less, as with a smaller stress_growth.",
    )


def linearised_about(discretisation: Discretisation, system: CoupledSystem, velocity: FloatArray) -> CoupledSystem:
    """A ``system`` whose ``load`` is without stress, with that of a ``velocity`` (nodes, d) to first order."""
    stress = linearised(discretisation, system.matrix.points, velocity)
    return replace(system, matrix=replace(system.matrix, local=stress.local), load=system.load + stress.load)


def _share_of_change(discretisation: Discretisation, guess: CoupledSystem, solution: Solution) -> float:
    """Share s in (0, 1] of the change δ from a ``guess`` u to the ``solution`` of its linear system.

    The force along δ, g(s) = g(0) + s ρd₀(δ, δ) + [∫ ½ σ(u + s δ):(∇δ + ∇δᵀ)] from 0 to s, is negative at 0 and, where
    stresses grow with the shear rate, grows with s: a share with |g(s)| ≤ ½|g(0)| is taken.
    """
    matrix, ranks, material = guess.matrix, discretisation.surfaces.ranks, discretisation.problem.material
    change, twist = solution.velocity - guess.velocity, solution.twist - guess.twist
    strain, changed = (discretisation.strain_rates(matrix.points, each) for each in (guess.velocity, change))
    half = 0.5 * changed.tensor * changed.weight[:, None, None]

    def power(share: float) -> float:
        flow = replace(strain, tensor=strain.tensor + share * changed.tensor)
        viscosity = material.viscosity(flow.shear_rate)
        return float(ranks.sum(np.einsum("n,nac,nac", viscosity, flow.tensor, half)))

    local = matrix.local
    along = 0.5 * np.einsum("nac,nac->n", local.direction, changed.tensor)
    resisted = changed.weight * (local.relative * changed.shear_rate**2 + local.slope * along**2)
    inertia = matrix.inertia * np.sum(change * discretisation.mass_times(matrix.points, change))
    resistance, inert = ranks.sum(np.array([matrix.viscosity * resisted.sum(), inertia]))
    inert += float(np.einsum("ni,nij,nj", twist, matrix.mass_matrix, twist))
    driving, start = float(resistance + inert), power(0.0)
    low, high, share = 0.0, 1.0, 1.0
    for _ in range(_HALVINGS):
        force = -driving + share * inert + power(share) - start
        if abs(force) <= _EXCESS * driving or (force < 0.0 and share == 1.0):
            break
        low, high = (share, high) if force < 0.0 else (low, share)
        share = 0.5 * (low + high)
    return share


def _between(guess: CoupledSystem, solution: Solution, share: float) -> CoupledSystem:
    """The system with the guess a ``share`` of the way to the ``solution``."""
    rest = 1.0 - share
    return replace(
        guess,
        velocity=rest * guess.velocity + share * solution.velocity,
        pressure=rest * guess.pressure + share * solution.pressure,
        twist=rest * guess.twist + share * solution.twist,
        again=True,
    )
