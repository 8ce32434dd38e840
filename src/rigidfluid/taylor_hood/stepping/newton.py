"""Newton's iteration for the flow of a generalised Newtonian fluid in one step."""

from __future__ import annotations

from dataclasses import replace

from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.model.types import Links
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem
from rigidfluid.taylor_hood.system.discretisation import Discretisation
from rigidfluid.taylor_hood.system.driving import Driven, solve_driven
from rigidfluid.taylor_hood.system.linearised import linearised, relative_change

NEAR = 0.3
"""Relative change of the velocity [1] below which Newton's iteration is trusted; above, viscosities are just taken from
the flow before (Picard's iteration), which converges from farther away."""

_SHARE = 0.1
"""Share of √tolerance at which changes end the iteration [1]: what is left is then about the square of the change."""

_MOST = 60
"""Greatest number of iterations."""


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
    points, change, latest = system.matrix.points, 0.0, system
    enough = _SHARE * tolerance**0.5
    for _ in range(_MOST):
        stress = linearised(discretisation, points, latest.velocity, change < NEAR)
        matrix = replace(system.matrix, local=stress.local)
        latest = replace(latest, matrix=matrix, load=system.load + stress.load)
        driven = solve_driven(discretisation, latest, links, time, tolerance)
        found = driven.solution
        change = relative_change(discretisation, points, latest.velocity, found.velocity, stress.local)
        if change <= enough:
            return matrix, driven
        latest = replace(latest, velocity=found.velocity, pressure=found.pressure, twist=found.twist, again=True)
    raise StepRejected(
        "fluid.material",
        f"changes of the flow by {change:.1g} after {_MOST} iterations",
        f"at most {enough:.1g}",
        "Shorten time.step, or choose a material whose viscosity varies less, as with a smaller stress_growth.",
    )
