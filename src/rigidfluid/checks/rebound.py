"""What would come back of the expected impact, and does the law give back more?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import Finding, figure
from rigidfluid.core.contact.stokes_number import Film
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.model.types import FluidProblem

QUESTION = "rebound"
REBOUND = 10.0
"""The Stokes number below which balls were not seen to rebound."""
BALLS = 35.0
"""β of balls in liquids: they come back with exp(-β/St) of the speed of a dry rebound."""


def in_a_film(met: DesignContacts, fluid: FluidProblem) -> Iterator[Finding]:
    """Say what a law without losses means at the Stokes number of the impact.

    Parameters
    ----------
    met : DesignContacts
        The bodies, with a wall or with each other.
    fluid : FluidProblem
        The fluid; without inertia it lets nothing rebound, and nothing is said.

    Yields
    ------
    Finding
        A note for each kind of pair that moves, where no law takes energy out.

    Notes
    -----
    Gondret, Lance and Petit, Phys. Fluids 14 (2002) 643, doi:10.1063/1.1427920; Joseph, Zenit, Hunt and Rosenwinkel,
    J. Fluid Mech. 433 (2001) 329, doi:10.1017/S0022112001003470; β: Legendre, Daniel and Guiraud, Phys. Fluids 17
    (2005) 097105, doi:10.1063/1.2010527.
    """
    if met.law.dissipative or not fluid.inertia:
        return
    radius = np.array([equal_volume_radius(body) for body in met.system.bodies])
    film = Film(fluid.dynamic_viscosity, radius, met.system.loads)
    struck = (met.speed > 0.0) & (met.inverse_mass > 0.0)
    stokes = np.where(struck, met.speed * film.stokes_number(met.contacts), np.inf)
    for row in met.worst(-stokes):
        if struck[row]:
            yield _finding(met, row, float(stokes[row]))


def _finding(met: DesignContacts, row: int, stokes: float) -> Finding:
    share = float(np.exp(-BALLS / stokes)) if stokes >= REBOUND else 0.0
    seen = f"come back with {figure(share)} of their speed" if share else "do not come back"
    field = next(one.field for one in met.interactions if one.law.conservative)
    text = f"{' and '.join(met.names(row))}: the impact's Stokes number is {figure(stokes)}, where balls in liquids "
    text += f"{seen}, and the law gives back all that reaches its range; "
    text += f"{field}.restitution and {field}.restitution_stokes = {BALLS:g} take some out"
    return Finding("note", QUESTION, met.names(row), text, found={"stokes_number": stokes, "rebound": share})
